"""A first meeting with an event camera of another maker: simulated packets, a doubled library."""

import json
import zipfile

import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.hello import command
from neurotouch_hid.doctor.hello.rig_settings import load_rig
from neurotouch_hid.runtime.worker import InlineRest
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import sequence
from neurotouch_hid.source.simulator.strokes import push, twist
from tests.doctor.attendant import Attendant
from tests.source.events.fake_library import Camera, Library, magnify

_GAP_US = 1_300_000


class Person(Attendant):
    """Presses Enter at a time of the camera for each prompt; None: leaves it out."""

    times_us = ()

    def answer(self, session):
        time_us = self.times_us[len(session.spans)]
        if time_us is None:
            return "s"
        return "" if session.end_us >= time_us else None


def test_whole_hello_of_a_camera_without_frames(tmp_path, monkeypatch):
    show, asked, turn = push(1.0, 7.0), push(0.0, 7.0), twist(0.5)
    script = sequence("hello", show, asked, turn, rest_us=6_600_000, gap_us=_GAP_US)
    camera = Camera("CenturyArks VGA")
    for packet in Simulator(script, seed=3):
        camera.show(packet.t_end_us, magnify(packet.events, camera.view))
    library = Library(camera)
    for module in ("source", "library"):
        monkeypatch.setattr(f"neurotouch_hid.source.events.{module}.load_library", lambda: library)
    # All packets come at once, so none is old, silence is no fault, and no thread may be late.
    monkeypatch.setattr("neurotouch_hid.source.opening.MAX_DELAY_US", 600_000_000)
    monkeypatch.setattr("neurotouch_hid.source.events.source.SILENCE_S", 600.0)
    monkeypatch.setattr(
        "neurotouch_hid.runtime.pipeline.ThreadedRest", lambda detector, _: InlineRest(detector)
    )
    pushed_us, turned_us = (each.end_us + _GAP_US - 100_000 for each in script.strokes[1:])
    times_us = (500_000, 6_500_000, pushed_us, None, None, None, turned_us, None, None)
    Person(monkeypatch).times_us = times_us
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(command, ["desk", "--source", "events:"])
    assert result.exit_code == 0, (result.output, result.exception)
    assert "To go on all the same" not in result.output
    path = tmp_path / "desk.hello.zip"
    with zipfile.ZipFile(path) as archive:
        assert "recording.aedat4" in archive.namelist()
        content = archive.read("hello.json").decode()
    report = json.loads(content)
    assert camera.serial not in content
    assert report["camera"]["name"] == "CenturyArks VGA"
    assert report["camera"]["overflows"] == 0
    answers = {each["point"]: (each["word"], each["sentence"]) for each in report["answers"]}
    assert answers["play"] == ("yes", "2 of 2 movements were recognised as asked for.")
    assert answers["mirrored"][0] == "no"
    assert answers["variant"][0] == "yes"
    assert answers["settings"] == ("not in this run", "There were no frames to judge.")
    told = {each["name"]: each["sentence"] for each in report["differences"]}
    assert "as simulated" in told["noise_hz_per_px"]
    assert "as simulated" in told["hot_pixels"]
    assert "this run does not show it" in told["blur_px"]
    settings = load_rig(path).settings
    assert settings.camera == "events-only"
    assert settings.list_nuisances() == {"frames": 0.0}
    assert settings.px_per_mm == pytest.approx(2.5, rel=0.02)
    assert settings.centre_x_px == pytest.approx(172.5, abs=0.5)
    assert settings.turn_deg == pytest.approx(0.0, abs=0.3)
    assert settings.shot_hz == pytest.approx(1.0, rel=0.07)
