"""The udev rules: right ids, right place in the order, no more rights than needed."""

import shutil
import subprocess
from pathlib import Path

import pytest

from neurotouch_hid.source.davis.registers import PRODUCT_ID, VENDOR_ID
from tests.processes import run_command

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "packaging/systemd/examples").glob("*.rules"))
"""Rules that an administrator puts in."""
RULES = [*sorted((ROOT / "udev").glob("*.rules")), *EXAMPLES]
OF_CAMERA = [path for path in RULES if "idVendor" in path.read_text() and path not in EXAMPLES]


def read_lines(path: Path) -> list[str]:
    lines = path.read_text().splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def ask_udev(*arguments: str) -> subprocess.CompletedProcess[str]:
    return run_command("udevadm", *arguments, code=None)


def test_there_are_rules():
    assert len(RULES) >= 3
    assert {path.stem for path in OF_CAMERA} == {"70-neurotouch-camera", "70-neurotouch-service"}


@pytest.mark.parametrize("path", RULES, ids=lambda path: path.name)
def test_they_come_before_access_control_lists_are_set(path):
    """By 73-seat-late.rules; what comes with systemd ends at 60."""
    assert 60 <= int(path.name.split("-")[0]) <= 72


@pytest.mark.parametrize("path", RULES, ids=lambda path: path.name)
def test_they_do_not_depend_on_the_kind_of_event(path):
    """Rules for ``add`` alone lose what they gave at the next ``change``."""
    assert 'ACTION=="add"' not in path.read_text()


@pytest.mark.parametrize("path", RULES, ids=lambda path: path.name)
def test_nothing_is_for_everybody_or_for_a_common_group(path):
    text = path.read_text()
    assert 'GROUP="input"' not in text
    assert 'GROUP="plugdev"' not in text
    for mode in ("0666", "0664", "0777"):
        assert mode not in text


@pytest.mark.parametrize("path", OF_CAMERA, ids=lambda path: path.name)
def test_they_are_about_the_camera_that_the_driver_opens(path):
    text = path.read_text()
    assert f'"{VENDOR_ID:04x}"' in text
    assert f'"{PRODUCT_ID:04x}"' in text
    assert text.count('ATTR{idVendor}"') == text.count('ATTR{idProduct}"')
    assert read_lines(path)[0].startswith('ACTION=="remove", GOTO=')


@pytest.mark.parametrize("path", RULES, ids=lambda path: path.name)
def test_every_jump_has_its_label_and_every_label_its_jump(path):
    words = " ".join(read_lines(path)).replace(",", " ").split()
    jumps = {word.partition("=")[2] for word in words if word.startswith("GOTO=")}
    labels = {word.partition("=")[2] for word in words if word.startswith("LABEL=")}
    assert jumps == labels


def test_a_group_stands_on_a_line_of_its_own():
    """From systemd 258 on, a line that names a missing group is dropped whole."""
    for path in RULES:
        for line in read_lines(path):
            assert not ("GROUP=" in line and "SYSTEMD_WANTS" in line)


def test_the_camera_wants_the_unit_that_is_shipped():
    rule = (ROOT / "udev/70-neurotouch-service.rules").read_text()
    wanted = rule.split('ENV{SYSTEMD_WANTS}+="')[1].split('"')[0]
    assert (ROOT / "packaging/systemd" / wanted).is_file()


def test_a_video_camera_goes_to_the_service_as_one_model_and_wants_the_same_unit():
    (path,) = (path for path in EXAMPLES if "video" in path.name)
    text = path.read_text()
    assert 'SUBSYSTEM!="video4linux", GOTO=' in text
    assert text.count('ATTRS{idVendor}!="') == text.count('ATTRS{idProduct}!="') == 1
    assert 'ENV{SYSTEMD_WANTS}+="neurotouch.service"' in text
    unit = path.with_name("video.conf").read_text()
    assert "DeviceAllow=char-video4linux rw\n" in unit


@pytest.mark.parametrize(
    "path", [ROOT / "udev/70-neurotouch-service.rules", *EXAMPLES], ids=lambda path: path.name
)
def test_the_group_is_the_one_that_is_made(path):
    group = path.read_text().split('GROUP="')[1].split('"')[0]
    users = read_lines(ROOT / "packaging/sysusers.d/neurotouch.conf")
    assert [line.split()[:2] for line in users] == [["u", group]]


@pytest.mark.parametrize("path", RULES, ids=lambda path: path.name)
def test_udev_finds_nothing_wrong(path):
    if not shutil.which("udevadm"):
        pytest.skip("udevadm is not installed")
    if "verify" not in ask_udev("--help").stdout:
        pytest.skip("udevadm has no 'verify' before systemd 254")
    done = ask_udev("verify", str(path))
    assert done.returncode == 0, done.stdout + done.stderr
