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


SITUATION = {"kind": "no_right", "text": "Camera found but not readable.", "next": "", "mend": ""}


@pytest.mark.parametrize(
    ("kind", "mend", "words"),
    [
        ("no_right", "setup", "Give me the right"),
        ("no_pad", "setup", "Give me the right"),
        ("service_stopped", "service", "Start the service"),
    ],
)
def test_a_button_mends_what_can_be_mended(play, kind, mend, words):
    page, driver = play("")
    driver.tell(driver=False, situation={**SITUATION, "kind": kind, "mend": mend})
    page.wait_for_selector("#mend:not([hidden])")
    assert page.inner_text("#mend") == words
    assert page.inner_text("#advice") == (
        "This computer then asks for the password of an administrator."
    )
    assert page.is_visible("#start-mouse")
    assert page.is_hidden("#start-camera")
    page.click("#mend")
    assert driver.wait_for_request(page) == {"do": "start", "what": mend}
    line = "Error executing command as another user: Not authorized"
    driver.tell(program={"name": mend, "line": line})
    driver.tell(program={"name": mend, "code": 127})
    page.wait_for_function(
        "line => document.getElementById('start-lines').textContent === line", arg=line
    )
    driver.tell(situation={**SITUATION, "kind": kind})
    page.wait_for_selector("#mend", state="hidden")
    assert "neurotouch" in page.inner_text("#advice")  # what to type instead


def test_a_driver_that_waits_offers_the_mouse(play):
    """The camera was pulled: the driver still runs, and nothing comes from it."""
    page, driver = play("")
    page.wait_for_selector("#fly:not([hidden])")
    text = "No camera found. The driver waits for one."
    driver.tell(situation={**SITUATION, "kind": "no_camera", "text": text})
    page.wait_for_selector("#start-mouse:not([hidden])")
    assert page.inner_text("#situation") == text
    assert page.is_hidden("#fly")
    assert page.is_hidden("#start-camera")
    assert page.is_visible("#end")
    page.click("#start-mouse")
    assert driver.wait_for_request(page) == {"do": "start", "what": "mouse"}
    driver.tell(refused="A driver of yours runs already. Press 'End the driver' first.")
    page.wait_for_selector("#start-mouse:not([hidden])")
    assert page.inner_text("#start-lines") == ""
    driver.show()
    page.wait_for_selector("#fly:not([hidden])")
    assert page.is_hidden("#start-mouse")
