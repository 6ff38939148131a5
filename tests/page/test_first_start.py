"""From the desktop's icon to a profile that works, without a terminal; and the wrong turns.

What the icon starts is read from the desktop entry. The camera is a file of the test's, and behind
it is the simulator: what a real one does is tried in `tests/kernel`.
"""

import os
import re
import sys
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe

from neurotouch_hid.page.profile_view import describe_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from tests.page.played import REST
from tests.page.waiting import wait_for, wait_on
from tests.processes import Process

ENTRY = Path(__file__).parents[2] / "packaging/desktop/neurotouch-hid.desktop"
VIEW = describe_profile(find_shipped_folder() / "default.yaml", edit=True)
GROUPS = [
    {"name": "Buttons", "outputs": [{"do": "button y", "label": "Y", "follows": False}]},
    {"name": "Sticks", "outputs": [{"do": "stick left", "label": "left stick", "follows": True}]},
]
PROGRAM = """
import sys
from pathlib import Path
from neurotouch_hid.page import programs, situation
from neurotouch_hid.source.davis import enumeration
from neurotouch_hid.source.video import plugged

folder = Path(sys.argv.pop(1))
camera = enumeration.CameraInfo(1, 4, "1-1", "00000001", "DAVIS346", 5000, 6)
enumeration.find_cameras = lambda: [camera] if (folder / "plugged").exists() else []
plugged.list_webcams = lambda: ()
situation._PAD_NODE = folder
hand = ("--source", "sim:tour", "--device", "memory")
programs.COMMANDS["camera"] = (*programs.COMMANDS["camera"], *hand)
from neurotouch_hid.cli.main import main
main()
"""
PADS = """() => {
    window.pad = {index: 0, mapping: "standard", axes: [0, 0, 0, 0],
        buttons: Array.from({length: 17}, () => ({pressed: false}))};
    window.pads = [window.pad];
    navigator.getGamepads = () => window.pads;
}"""
"""A gamepad in place of the browser's: no program may make one here."""
PRESS = "([i, is]) => { window.pad.buttons[i] = {pressed: is}; }"
B, Y = 1, 3


class Icon(Process):
    """What a click on the icon starts; its browser is the test's."""

    def __init__(self, folder: Path) -> None:
        (folder / "bin").mkdir(parents=True)
        opener, part, link = (folder / name for name in ("bin/xdg-open", "part", "link"))
        opener.write_text(f'#!/bin/sh\necho "$1" > {part} && mv {part} {link}\n')
        opener.chmod(0o755)
        program, *arguments = re.search(r"(?m)^Exec=(.+)$", ENTRY.read_text())[1].split()
        assert program == "neurotouch"
        super().__init__(
            folder,
            *arguments,
            ready="Spacecraft: ",
            program=[sys.executable, "-c", PROGRAM, str(folder)],
            PATH=f"{folder}/bin:{os.environ['PATH']}",
            DISPLAY=":9",
        )
        self.wait(link.exists)
        self.link = link.read_text().strip()


@pytest.fixture
def icon(tmp_path):
    started = Icon(tmp_path / "home")
    yield started
    started.end()


def test_from_no_camera_to_a_profile_that_works_in_the_game(icon, open_page):
    page = open_page(icon.link)
    wait_for(page, "situation", "No camera found.")
    page.click("#start-mouse")  # the wait for the camera is not empty
    wait_for(page, "situation", "The mouse presses a simulated gel.")
    (icon.folder / "plugged").touch()
    wait_for(page, "start-camera", "Play with the camera instead")
    wait_for(page, "live", "A camera is plugged in.")
    page.click("#start-camera")
    wait_for(page, "situation", "A simulated hand plays.")  # behind the test's camera
    page.wait_for_function("() => document.activeElement.id === 'fly'")
    page.evaluate(PADS)
    page.click("#by-doing")
    page.wait_for_selector("#chooser[open]")  # the hand has made a movement
    wait_for(page, "press-now", "Press a button of a gamepad, or choose here.")
    assert Axe().run(page).response["violations"] == []
    page.evaluate(PRESS, [Y, True])
    wait_for(page, "saved", "It applies now.")
    wait_for(page, "trial", "It works.")  # the hand has made it again
    assert "button Y" in page.text_content("#trial")
    assert Axe().run(page).response["violations"] == []
    page.click("#fly-now")
    wait_for(page, "pilot", "the gel")
    saved = list((icon.folder / "config/neurotouch/profiles").glob("*.yaml"))
    assert [path for path in saved if 'button: "y"' in path.read_text()]


PINCH = {**REST["gesture"], "kind": "pinch", "movement": "pinch", "felt_mm": 5.0}


def make_pinch(page, driver) -> None:
    """Makes a pinch, which opens the dialog; the driver is paused meanwhile."""
    page.click("#by-doing")
    assert driver.wait_for_request(page)["do"] == "pause"
    driver.show(state="paused", gesture=PINCH)
    driver.show(state="paused")
    page.wait_for_selector("#chooser[open]")


def press(page, button: int, is_pressed: bool = True) -> None:
    """Presses a button of the gamepad, and lets the page look at it several times."""
    page.evaluate(PRESS, [button, is_pressed])
    page.evaluate(
        "() => new Promise((done) => { let n = 0;"
        " const look = () => (++n > 4 ? done() : requestAnimationFrame(look)); look(); })"
    )


@pytest.fixture
def started(play):
    """A page with a driver that the test plays, and with a gamepad."""
    page, driver = play("")
    driver.tell(about=VIEW, outputs=GROUPS)
    page.evaluate(PADS)
    page.wait_for_selector("#by-doing:not([hidden])")
    return page, driver


def test_a_new_press_of_a_gamepad_is_bound_and_tried(started):
    page, driver = started
    page.evaluate(PRESS, [B, True])  # is held already
    driver.show(layer="base")
    make_pinch(page, driver)
    press(page, B)
    press(page, B, is_pressed=False)
    assert driver.asked == []
    press(page, Y)
    wait_on(page, lambda: len(driver.asked) == 2)
    request = driver.answer(saved="Saved. It applies now.")
    assert (request["movement"], request["do_this"]) == ("pinch", "button y")
    assert driver.wait_for_request(page)["do"] == "resume"
    wait_for(page, "trial", "Now try it: pinch.")
    pressed = {**REST["pad"], "buttons": ["y"]}
    driver.show(pad=pressed)  # not by a pinch
    driver.show(gesture=PINCH)
    assert page.text_content("#trial") == "Now try it: pinch."
    assert page.is_hidden("#fly-now")
    driver.show(gesture=PINCH, pad=pressed)
    wait_for(page, "trial", "It works. Pinch: button Y.")
    assert page.is_visible("#fly-now")
    page.click("#by-doing")  # the next one
    wait_on(page, lambda: page.text_content("#trial") == "")


def test_while_the_driver_plays_no_gamepad_is_heard(started):
    """Its own gamepad is one of those that a browser sees."""
    page, driver = started
    page.locator("[data-movement=push_down] .row button").click()
    assert page.text_content("#press-now") == ""
    press(page, Y)
    assert page.is_visible("#chooser")
    assert driver.asked == []


def test_a_movement_that_ends_before_the_pause_chooses_nothing(started):
    page, driver = started
    page.click("#by-doing")
    assert driver.wait_for_request(page)["do"] == "pause"
    driver.show(gesture=PINCH)
    driver.show()
    driver.show(state="paused")
    assert page.is_hidden("#chooser")
    driver.show(state="paused", gesture=PINCH)
    driver.show(state="paused")
    wait_for(page, "press-now", "Press a button of a gamepad, or choose here.")


def test_a_push_in_all_directions_takes_the_whole_stick(started):
    page, driver = started
    driver.show(state="paused")
    page.locator("[data-movement=push] .row button").click()
    page.evaluate("() => { window.pad.axes[2] = -0.9; }")
    assert driver.wait_for_request(page)["do_this"] == "stick right"


def test_a_gamepad_of_unknown_layout_leads_to_the_list(started):
    page, driver = started
    page.evaluate("() => { window.pad.mapping = ''; }")
    make_pinch(page, driver)
    press(page, Y)
    wait_for(page, "key-said", "This gamepad does not say which button that is. Choose it here.")
    assert page.is_visible("#chooser")
    page.click("#chooser button[value=cancel]")
    # Nothing is bound.
    assert driver.wait_for_request(page) == {"do": "resume", "for": "movement"}


NO_CAMERA = {"kind": "no_camera", "text": "No camera found.", "next": "", "mend": "", "start": ""}


def test_cameras_that_come_and_go_are_said_and_the_focus_stays_on_the_page(started):
    page, driver = started
    driver.tell(driver=False, situation=NO_CAMERA)
    wait_for(page, "situation", "No camera found.")
    ready = {**NO_CAMERA, "kind": "ready"}
    driver.tell(situation={**ready, "text": "Ready.", "start": "camera"})
    wait_for(page, "live", "The camera is ready.")
    page.focus("#start-camera")
    assert page.text_content("#start-camera") == "Start with the camera"
    driver.tell(situation=NO_CAMERA)
    page.wait_for_function("() => document.activeElement.id === 'start-mouse'")
    driver.tell(situation={**ready, "text": "Webcam found.", "start": "webcam"})
    wait_for(page, "advice", "If it looks at a gel, start with it.")
    page.click("#start-camera")
    assert driver.wait_for_request(page) == {"do": "start", "what": "webcam"}
    line = "Error: No video camera shows a gel."
    driver.tell(program={"name": "webcam", "line": line})
    driver.tell(program={"name": "webcam", "code": 3})
    wait_for(page, "start-lines", line)
    page.wait_for_selector("#start-mouse:not([hidden])")
