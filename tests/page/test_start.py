"""The first page starts from any state: beside a driver that waits, beside a service, prepared."""

import os
import sys

import pytest

from tests.page.waiting import wait_for, wait_on
from tests.processes import Process, View, make_environment, run_neurotouch

WAITS = """
import sys
from neurotouch_hid.driver import Driver, DriverOptions
from neurotouch_hid.process.signals import stop_on_signals

options = DriverOptions(source="davis:", device="memory", copilot="", wait=True)
guests = (lambda: (int(sys.argv[1]),)) if sys.argv[1] else None  # a service has some
with Driver(options, guests=guests) as driver:
    print("It waits", flush=True)
    driver.run(stop=stop_on_signals())
"""
VIEW = """
import sys
from pathlib import Path
from neurotouch_hid import players

players.SERVICE_FOLDER = Path(sys.argv.pop(1))
from neurotouch_hid.cli.main import main
main()
"""


class WaitingDriver(Process):
    """A driver whose camera is not there."""

    def __init__(self, folder, *, is_service: bool = False) -> None:
        program = [sys.executable, "-c", WAITS, str(os.getuid()) if is_service else ""]
        super().__init__(folder, program=program, ready="It waits")


def test_beside_the_person_s_own_driver_that_waits_it_says_what_to_end(tmp_path, open_page):
    driver = WaitingDriver(tmp_path)
    view = View(tmp_path, "--edit")
    page = open_page(view.home)
    wait_for(page, "situation", "No camera found. The driver waits for one.")
    page.click("#start-mouse")
    wait_for(page, "start-lines", "A driver of yours runs already. Press 'End the driver' first.")
    page.click("#end")  # which works
    wait_on(page, lambda: driver.process.poll() == 0)
    wait_for(page, "driver-state", "No driver is running")
    page.click("#start-mouse")
    wait_for(page, "situation", "The mouse presses a simulated gel.")
    page.close()
    view.end()


@pytest.fixture
def session(tmp_path, monkeypatch):
    """The runtime folder of a person's session."""
    made = tmp_path / "session"
    made.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(made))
    return made


def test_the_mouse_gel_starts_beside_a_service_that_waits(tmp_path, session, open_page):
    service = WaitingDriver(tmp_path / "system", is_service=True)
    view = View(
        tmp_path,
        "--edit",
        program=[sys.executable, "-c", VIEW, str(service.folder / "run")],
        RUNTIME_DIRECTORY=None,
    )
    page = open_page(view.home)
    wait_for(page, "situation", "No camera found. The driver waits for one.")
    page.click("#start-mouse")
    wait_for(page, "situation", "The mouse presses a simulated gel.")
    assert (session / "neurotouch/control").exists()
    page.click("#end")  # the nearest driver, as for commands
    page.wait_for_selector("#start-mouse:not([hidden])")
    assert service.process.poll() is None
    page.close()
    view.end()
    service.end()


@pytest.mark.parametrize("chosen", [False, True])
def test_the_mouse_gel_plays_the_favourite_if_there_is_one(tmp_path, chosen):
    if chosen:
        own = tmp_path / "config/neurotouch/user.yaml"
        own.parent.mkdir(parents=True)
        own.write_text("version: 1\nslots: [push-only]\n")
    done = run_neurotouch(
        "demo", "--mouse", "--seconds", "0.5", "--show", "lines", env=make_environment(tmp_path)
    )
    assert ("push-only" if chosen else "spacecraft") in done.stderr + done.stdout


SITUATION = {
    "kind": "no_right",
    "text": "Camera found but not readable.",
    "next": "",
    "mend": "",
    "start": "",
}


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
    wait_on(page, lambda: driver.asked)
    refusal = "A driver of yours runs already. Press 'End the driver' first."
    request = driver.answer(refused=refusal)
    assert (request["do"], request["what"]) == ("start", "mouse")
    wait_for(page, "start-lines", refusal)
    page.wait_for_selector("#start-mouse:not([hidden])")
    driver.show()
    page.wait_for_selector("#fly:not([hidden])")
    assert page.is_hidden("#start-mouse")
