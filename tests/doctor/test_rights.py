"""Rules for /dev/uinput, in folders like those of udev."""

import pytest

from neurotouch_hid.doctor import rights
from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.resources import find_resources

OURS = (find_resources("udev") / "70-neurotouch-uinput.rules").read_text()
NO_STATIC = 'KERNEL=="uinput", SUBSYSTEM=="misc", TAG+="uaccess"\n'


@pytest.fixture
def folders(tmp_path):
    made = tuple(tmp_path / name for name in ("etc", "run", "lib"))
    for folder in made:
        folder.mkdir()
    return made


def test_ours_is_in_order(folders):
    (folders[2] / "70-neurotouch-uinput.rules").write_text(OURS)
    finding = rights.check_rule(folders)
    assert finding.status is CheckStatus.OK
    assert "70-neurotouch-uinput.rules" in finding.sentence


def test_a_rule_over_two_lines_is_read_as_one(folders):
    (folders[0] / "60-x.rules").write_text(
        'KERNEL=="uinput", TAG+="uaccess", \\\n OPTIONS+="static_node=uinput"\n'
    )
    assert rights.check_rule(folders).status is CheckStatus.OK


def test_one_that_comes_after_the_seats_is_too_late(folders):
    (folders[0] / "99-steam.rules").write_text(OURS)
    finding = rights.check_rule(folders)
    assert finding.status is CheckStatus.WARNING
    assert "99-steam.rules applies too late" in finding.sentence
    assert finding.commands


def test_one_without_a_static_node_holds_only_with_the_module(folders):
    (folders[0] / "60-x.rules").write_text(NO_STATIC)
    finding = rights.check_rule(folders)
    assert finding.status is CheckStatus.WARNING
    assert "static_node" in finding.sentence
    assert any("modules-load.d" in line for line in finding.commands)


@pytest.mark.parametrize("text", ["", "# " + OURS.replace("\n", "\n# "), 'KERNEL=="uhid"\n'])
def test_a_rule_that_is_hidden_or_says_nothing_is_none(folders, text):
    """A file in /etc hides the one of the same name in /usr/lib: that is how people switch off."""
    (folders[2] / "70-neurotouch-uinput.rules").write_text(OURS)
    (folders[0] / "70-neurotouch-uinput.rules").write_text(text)
    finding = rights.check_rule(folders)
    assert finding.status in (CheckStatus.WARNING, CheckStatus.SKIPPED)
    assert finding.sentence.startswith("No udev rule ")


@pytest.fixture
def packaged(tmp_path, monkeypatch):
    """The files of the package, and of a running systemd; none of them is there at first."""
    files = {name: tmp_path / name for name in ("SERVICE_RULE", "PACKAGED_MODULES", "SYSTEMD")}
    for name, path in files.items():
        monkeypatch.setattr(rights, name, path)
    monkeypatch.setattr(rights, "_NODE", tmp_path / "no-node")
    monkeypatch.setattr(rights, "_LOADED", tmp_path / "not-loaded")
    return files


def test_where_the_package_loads_the_module_at_every_start_it_is_not_told_again(packaged):
    assert len(rights.check_module().commands) == 2
    packaged["PACKAGED_MODULES"].touch()
    assert rights.check_module().commands == ("sudo modprobe uinput",)


def test_a_service_that_nothing_can_start_makes_no_pad(packaged, monkeypatch):
    monkeypatch.setattr(rights, "find_driver", lambda: None)
    packaged["SERVICE_RULE"].touch()
    assert rights.needs_no_right() == ""
    packaged["SYSTEMD"].touch()
    assert rights.needs_no_right().startswith("The service makes the pad")


def test_udev_is_asked_to_apply_a_rule_only_where_it_runs(packaged, tmp_path, monkeypatch):
    """As in a container, where the command would fail and end the doctor's script."""
    for there in (True, False):
        monkeypatch.setattr(rights, "UDEV", tmp_path if there else tmp_path / "no-udev")
        commands = rights.check_rule((tmp_path,)).commands
        assert any("70-neurotouch-uinput.rules" in line for line in commands)
        assert any("udevadm" in line for line in commands) is there
