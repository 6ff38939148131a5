"""What keeps the gel from playing: each kind of situation, and what the page offers then."""

import asyncio

import pytest

from neurotouch_hid.errors import PageError
from neurotouch_hid.page import situation
from neurotouch_hid.page.programs import Programs
from neurotouch_hid.page.requests import Requests
from neurotouch_hid.page.situation import find_situation
from neurotouch_hid.source.davis import enumeration
from neurotouch_hid.source.davis.enumeration import CameraInfo


def make_camera(reason: str = "") -> CameraInfo:
    return CameraInfo(1, 4, "1-1", "00000001", "DAVIS346", 5000, 6, reason)


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A machine whose camera, service, gamepad and ways to ask for a password the test chooses."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("PATH", str(tmp_path))

    def make(*cameras: CameraInfo, service=False, pad=True, pkexec=False) -> None:
        monkeypatch.setattr(enumeration, "find_cameras", lambda: list(cameras))
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
