"""``neurotouch devices`` with video cameras at the edge of Linux."""

import errno
import json
import sys

import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.devices import command
from tests.source.events.fake_library import Camera, Library
from tests.source.video.fake_camera import FakeCamera, FakeLinux


@pytest.fixture
def linux(monkeypatch):
    locked = FakeCamera("Locked", "usb-9")
    linux = FakeLinux(FakeCamera(), locked)
    honest = linux.open

    def open_node(node):
        if linux.cameras[int(node.name[5:])] is locked:
            raise OSError(errno.EACCES, "Permission denied")
        return honest(node)

    linux.open = open_node
    for module in ("capture", "enumeration"):
        monkeypatch.setattr(f"neurotouch_hid.source.video.{module}.Linux", lambda: linux)
    return linux


def test_video_cameras_are_listed_with_their_fastest_pictures(linux):
    said = CliRunner().invoke(command, []).output
    assert "OK video camera UVC Camera: /dev/video0" in said
    assert "  plugged in: usb-0000:00:14.0-2" in said
    assert "  fastest pictures: 320x240 YUYV at 125 pictures/s" in said
    assert "  use it: --source video:usb-0000:00:14.0-2" in said
    assert "WARNING video camera without a name: /dev/video1" in said
    assert "  not available: no right to read and write /dev/video1" in said
    assert "No camera is plugged in" not in said
    assert linux.cameras[0].n_open == 0


def test_the_same_as_json(linux):
    said = json.loads(CliRunner().invoke(command, ["--json"]).stdout)
    first, second = said["video_cameras"]
    assert first == {
        "node": "/dev/video0",
        "name": "UVC Camera",
        "bus_info": "usb-0000:00:14.0-2",
        "driver": "fake",
        "reason": None,
        "source": "video:usb-0000:00:14.0-2",
        "mode": "320x240 YUYV at 125 pictures/s",
    }
    assert second["reason"] == "no right to read and write /dev/video1"
    assert second["mode"] is None


def test_a_camera_that_another_program_uses_is_listed_all_the_same(linux):
    linux.cameras[0].in_use = True
    said = CliRunner().invoke(command, []).output
    assert "OK video camera UVC Camera: /dev/video0" in said


def test_event_cameras_of_other_makers_are_listed(linux, monkeypatch):
    fake = Library(Camera(), Camera("iniVation DVXplorer", serial="7", error="Rusb(Busy)"))
    monkeypatch.setattr("neurotouch_hid.source.events.library.load_library", lambda: fake)
    said = CliRunner().invoke(command, []).output
    assert "OK event camera 00ca0123: Prophesee EVK4\n  picture: 1280x720 pixels" in said
    assert "  use it: --source events:00ca0123" in said
    assert "WARNING event camera 7: iniVation DVXplorer" in said
    assert "  not available: in use by another program" in said
    first, second = json.loads(CliRunner().invoke(command, ["--json"]).stdout)["event_cameras"]
    assert (first["model"], first["width"], first["reason"]) == ("prophesee_evk4", 1280, None)
    assert second["source"] == "events:7"


def test_without_its_library_an_event_camera_is_named_with_the_command(linux, monkeypatch):
    monkeypatch.setitem(sys.modules, "neuromorphic_drivers", None)
    monkeypatch.setattr("neurotouch_hid.source.events.plugged.needs_library", lambda: True)
    said = CliRunner().invoke(command, []).output
    assert "An event camera needs another package: pip install 'neurotouch-hid[events]'" in said
