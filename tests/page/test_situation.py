"""What keeps the gel from playing: each kind of situation, and what the page offers then."""

import asyncio
from pathlib import Path

import pytest

from neurotouch_hid.errors import PageError
from neurotouch_hid.page import situation
from neurotouch_hid.page.programs import Programs
from neurotouch_hid.page.requests import Requests
from neurotouch_hid.page.situation import find_situation, find_start
from neurotouch_hid.source.davis import enumeration
from neurotouch_hid.source.davis.enumeration import CameraInfo
from neurotouch_hid.source.events import plugged as events
from neurotouch_hid.source.video import plugged as video


def make_camera(reason: str = "") -> CameraInfo:
    return CameraInfo(1, 4, "1-1", "00000001", "DAVIS346", 5000, 6, reason)


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A machine whose camera, service, gamepad and ways to ask for a password the test chooses."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("PATH", str(tmp_path))

    def make(
        *cameras: CameraInfo, service=False, pad=True, pkexec=False, webcam="", event=False
    ) -> None:
        monkeypatch.setattr(enumeration, "find_cameras", lambda: list(cameras))
        nodes = (tmp_path / webcam,) if webcam else ()
        (tmp_path / "readable").touch()
        monkeypatch.setattr(video, "list_webcams", lambda: nodes)
        monkeypatch.setattr(events, "needs_library", lambda: event)
        for path, is_there in {"unit": service, "uinput": pad, "pkexec": pkexec}.items():
            (tmp_path / path).unlink(missing_ok=True)
            if is_there:
                (tmp_path / path).write_text('#!/bin/sh\necho "$@"\n')
                (tmp_path / path).chmod(0o755)
        monkeypatch.setattr(situation, "SERVICE_UNIT", tmp_path / "unit")
        monkeypatch.setattr(situation, "_PAD_NODE", tmp_path / "uinput")

    return make


@pytest.mark.parametrize(
    ("cameras", "has", "waits", "kind", "mend"),
    [
        ([], {}, False, "no_camera", ""),
        ([], {"service": True}, True, "no_camera", ""),
        ([""], {}, True, "no_data", ""),
        ([""], {"service": True, "pad": False}, False, "service_stopped", "service"),
        (["no right to read and write /dev/bus/usb/001/004"], {}, False, "no_right", "setup"),
        (["in use by dv-gui (PID 7)"], {}, False, "unusable", ""),
        ([""], {"pad": False}, False, "no_pad", "setup"),
        ([""], {}, False, "ready", ""),
    ],
)
def test_each_kind_and_what_the_page_can_do(machine, cameras, has, waits, kind, mend):
    machine(*map(make_camera, cameras), **has)
    found = find_situation(waits=waits)
    assert (found.kind, found.mend) == (kind, "")  # nothing here can ask for a password
    assert found.text
    assert found.next
    machine(*map(make_camera, cameras), **has, pkexec=True)
    assert find_situation(waits=waits).mend == mend


@pytest.mark.parametrize(
    ("reasons", "has", "waits", "kind", "start"),
    [
        ([], {}, False, "no_camera", ""),
        ([], {"webcam": "readable"}, False, "ready", "webcam"),
        ([], {"webcam": "absent"}, False, "unusable", ""),
        ([], {"webcam": "readable", "event": True}, False, "ready", "events"),
        ([], {"webcam": "readable", "pad": False}, False, "no_pad", ""),
        ([], {"webcam": "readable"}, True, "no_data", "webcam"),
        ([], {"webcam": "readable", "pad": False}, True, "no_camera", ""),
        ([""], {"webcam": "readable"}, False, "ready", "camera"),
        ([""], {"webcam": "readable"}, True, "no_data", ""),
    ],
)
def test_a_camera_of_another_kind_can_be_started(machine, reasons, has, waits, kind, start):
    machine(*map(make_camera, reasons), **has)
    found = find_situation(waits=waits)
    assert (found.kind, found.start) == (kind, start)


def test_in_place_of_a_simulated_gel_only_a_camera_that_can_be_used_is_offered(machine):
    machine(make_camera("in use by PID 7"))
    assert find_start() == ""
    machine(make_camera("in use by PID 7"), webcam="readable")
    assert find_start() == "webcam"
    machine(make_camera(), webcam="readable")
    assert find_start() == "camera"
    machine(make_camera(), pad=False)
    assert find_start() == ""


def test_webcams_are_the_first_nodes_of_cameras_at_the_usb(tmp_path):
    places = {"video0": ("usb1/1-1", 0), "video1": ("usb1/1-1", 1), "video10": ("platform/isp", 0)}
    for name, (place, index) in places.items():
        folder = tmp_path / "class" / name
        folder.mkdir(parents=True)
        (tmp_path / "devices" / place).mkdir(parents=True, exist_ok=True)
        (folder / "index").write_text(f"{index}\n")
        (folder / "device").symlink_to(tmp_path / "devices" / place)
    assert video.list_webcams(tmp_path / "class") == (Path("/dev/video0"),)
    assert video.list_webcams(tmp_path / "nothing") == ()


def test_the_service_is_started_through_the_password(machine):
    machine(pkexec=True)
    heard = []

    async def start() -> None:
        programs = Programs(heard.append)
        await programs.start("service")
        while not any("code" in each for each in heard):
            await asyncio.sleep(0.01)
        await programs.close()

    asyncio.run(start())
    assert heard == [
        {"name": "service", "line": "systemctl start neurotouch"},
        {"name": "service", "code": 0},
    ]


def test_without_a_way_to_ask_it_is_refused(machine):
    machine()
    with pytest.raises(PageError, match="pkexec"):
        asyncio.run(Programs(print).start("service"))


@pytest.mark.parametrize("what", ["setup", "service"])
def test_a_phone_asks_for_no_password(machine, what, tmp_path):
    machine(pkexec=True)
    requests = Requests(edit=True, is_far=True, changes=None, own=None, tell_all=print)
    with pytest.raises(PageError, match="Only the machine itself"):
        asyncio.run(requests.carry_out({"do": "start", "what": what}, tmp_path))
