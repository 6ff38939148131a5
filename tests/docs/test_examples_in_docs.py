"""Every profile and every settings file in the documents can be loaded."""

import re
from pathlib import Path

import pytest

from neurotouch_hid.driver.camera_settings import CameraSettings
from neurotouch_hid.driver.gel_file import choose_gel
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.profile import check_content
from neurotouch_hid.profile.reading.load import load_settings
from neurotouch_hid.recording.labels import read_labels
from neurotouch_hid.source.rig_file import load_rig_file
from tests.docs.prose import ROOT


def find_yaml(page: str) -> list[str]:
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)


EXAMPLES = find_yaml("profiles.md")


@pytest.mark.parametrize("text", EXAMPLES)
def test_an_example_has_no_mistake(text):
    checked = check_content(text.encode(), "example.yaml")
    assert checked.whole is not None, checked.format()
    assert checked.format() == ""


def test_there_are_examples_and_a_wrong_one_is_found():
    assert len(EXAMPLES) >= 3
    wrong = EXAMPLES[0].replace("button: a", "buttons: a")
    assert check_content(wrong.encode(), "example.yaml").whole is None


@pytest.mark.parametrize("spoil", [False, True])
def test_camera_settings_can_be_loaded(tmp_path: Path, spoil: bool):
    text, events, video = find_yaml("hardware.md")
    path = tmp_path / "camera.yaml"
    path.write_text(video)
    assert load_settings(path, CameraSettings).config.video.format == "MJPG"
    path.write_text(events)
    config = load_settings(path, CameraSettings).config.events
    assert config.biases == {"prophesee_evk4": {"diff_on": 20, "diff_off": 20}}
    path.write_text(text.replace("exposure_us", "exposure") if spoil else text)
    if spoil:
        with pytest.raises(NeuroTouchError):
            load_settings(path, CameraSettings)
    else:
        assert load_settings(path, CameraSettings).config.davis.hot_pixels == ((17, 203),)


def test_gels_can_be_loaded(tmp_path: Path):
    path = tmp_path / "gel.yaml"
    for text, n in zip(find_yaml("gel-format.md"), (151, 80), strict=True):
        path.write_text(text)
        assert choose_gel(str(path)).gel.n_markers == n


def test_rig_file_can_be_loaded(tmp_path: Path):
    (text,) = find_yaml("research/formats.md")
    path = tmp_path / "a.rig.yaml"
    path.write_text(text)
    assert load_rig_file(path).rig is not None


def test_labels_can_be_read(tmp_path: Path):
    page = (ROOT / "docs" / "research" / "formats.md").read_text(encoding="utf-8")
    blocks = re.findall(r"(?:^    .*\n)+", page, re.MULTILINE)
    (text,) = [block for block in blocks if "pinch" in block and "timestamp_us" in block]
    path = tmp_path / "a.labels.csv"
    path.write_text(re.sub(r"(?m)^    ", "", text))
    assert [len(truth.contacts_px) for truth in read_labels(path)] == [0, 1, 2]
