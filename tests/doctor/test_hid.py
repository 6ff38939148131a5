"""A HID pad that a file of choices asks for, on machines that can and cannot make it."""

import os

import pytest

from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.doctor.hid import check_hid
from neurotouch_hid.errors import ProfileError

ASKS = "version: 1\ndevice: hid\n"


@pytest.fixture
def look(tmp_path, monkeypatch):
    """The check on a machine made of files; what is not made is missing."""

    def look(choices=ASKS, *made, allows=""):
        (tmp_path / "service.yaml").write_text(choices)
        for name in made:
            (tmp_path / name).touch()
        program = tmp_path / "systemctl"
        program.write_text(f"#!/bin/sh\necho 'DeviceAllow=char-usb_device rw{allows}'\n")
        program.chmod(0o755)
        monkeypatch.setenv("PATH", str(tmp_path))
        parts = {name: tmp_path / name for name in ("node", "loaded", "package")}
        return check_hid((tmp_path / "absent.yaml", tmp_path / "service.yaml"), **parts)

    return look


def test_nobody_asks(look):
    finding = look("version: 1\n")
    assert finding.status is CheckStatus.SKIPPED
    assert "No HID pad is requested" in finding.sentence


def test_nobody_asks_but_it_would_work(look):
    finding = look("device: uinput\n", "node", "loaded")
    assert finding.status is CheckStatus.OK
    assert "--device hid" in finding.sentence


@pytest.mark.parametrize("made", [[], ["node"]])
def test_without_the_module(look, made):
    finding = look(ASKS, *made)
    assert finding.status is CheckStatus.FAILED
    assert "service.yaml requests a HID pad, but the kernel module uhid" in finding.sentence
    assert "sudo modprobe uhid" in finding.commands


def test_all_is_there(look):
    finding = look(ASKS, "node", "loaded")
    assert finding.status is CheckStatus.OK
    assert "you have the right to make one" in finding.sentence


def test_without_right(look, tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may everything
    (tmp_path / "node").touch(0o600)
    finding = look(ASKS, "loaded")
    assert finding.status is CheckStatus.FAILED
    assert "its mode is 0600" in finding.sentence
    assert any("70-neurotouch-hid.rules" in command for command in finding.commands)


def test_the_service_needs_a_right_of_its_own(look):
    finding = look(ASKS, "node", "loaded", "package")
    assert finding.status is CheckStatus.FAILED
    assert "the service has no right to /dev/uhid" in finding.sentence
    assert any("examples/hid.conf" in command for command in finding.commands)


def test_the_service_has_it(look):
    finding = look(ASKS, "node", "loaded", "package", allows=" /dev/uhid rw")
    assert finding.status is CheckStatus.OK
    assert "the service has the right to make one" in finding.sentence


def test_mistakes_in_the_file_are_shown(look):
    with pytest.raises(ProfileError, match="device"):
        look("device: hidden\n")
