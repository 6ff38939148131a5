"""What the first page does for a person beside the movements: values, keys, checks, the pause."""

import json

import pytest

from neurotouch_hid.page.profile_view import describe_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.profile.schema.keyboard_keys import KEYS
from tests.page.conftest import PROFILE
from tests.page.waiting import wait_for, wait_on
from tests.processes import View

VIEW = describe_profile(find_shipped_folder() / "default.yaml", edit=True)
GROUPS = [
    {"name": name, "outputs": [{"do": do, "label": do, "follows": False}]}
    for name, do in (("Buttons", "button a"), ("Keyboard", "key a"))
]


def test_own_values_are_chosen_by_label_and_act_at_once(view, folder, open_page):
    """Also by keyboard; each says what it means, and Undo takes back no calibration."""
    own = folder / "config/neurotouch/user.yaml"
    own.unlink(missing_ok=True)
    page = open_page(view.home)
    select = page.get_by_label("Tremor filter")
    page.wait_for_function("() => !document.getElementById('own-filter').disabled")
    assert select.input_value() == ""
    select.focus()
    page.keyboard.press("ArrowDown")
    wait_for(page, "own-said", "Saved. It applies now")
    assert select.input_value() == "none"
    about = page.locator("#own-filter-about")
    assert about.text_content() == "Nothing is smoothed, and nothing comes later."
    page.get_by_label("Hand between movements").select_option("resting")
    wait_on(page, lambda: "neutral: resting" in own.read_text())
    page.click("#own-undo")
    wait_for(page, "own-said", "These values are as before. It applies now")
    page.wait_for_function("() => document.getElementById('own-neutral').value === 'lifted'")
    wait_for(page, "range-undo-reason", "There is no measurement to undo.")
    assert 'filter: "none"' in own.read_text()
    own.unlink()


def test_broken_values_have_a_button_out(view, folder, open_page):
    own = folder / "config/neurotouch/user.yaml"
    own.write_text("version: 1\nfiltr: strong\n")
    page = open_page(view.home)
    wait_for(page, "notice", "Your own values cannot be read. Line 2, 'filtr': unknown key")
    assert "^" not in page.inner_text("#notice")
    options = page.locator("#profile-choice option")
    wait_on(page, lambda: options.count() > 3)  # which are there all the same
    page.click("#own-mend")
    wait_for(page, "own-said", "Your own values")
    page.wait_for_selector("#notice", state="hidden")
    assert page.evaluate("document.activeElement.id") == "own-undo"
    own.unlink(missing_ok=True)


def open_keys(play):
    page, driver = play("")
    driver.tell(about=VIEW, outputs=GROUPS)
    page.locator("[data-movement=push_down] .row button").click()
    page.click("#key-catch")
    return page, driver


@pytest.mark.parametrize(
    ("pressed", "bound"),
    [
        ("Quote", "apostrophe"),
        ("BracketLeft", "left_bracket"),
        ("Shift+Digit1", "shift+1"),
        ("CapsLock", "caps_lock"),
        ("Control+Shift+KeyZ", "ctrl+shift+z"),
        ("Numpad7", "keypad_7"),
        ("F12", "f12"),
        ("KeyP", "p"),
    ],
)
def test_a_key_is_named_by_its_place_and_does_nothing_else(play, pressed, bound):
    """P would pause, if the header heard it."""
    page, driver = open_keys(play)
    page.keyboard.press(pressed)
    request = driver.wait_for_request(page)
    assert (request["do"], request["do_this"]) == ("bind", f"key {bound}")
    assert driver.asked == []
    page.keyboard.press("KeyP")  # again as always
    assert driver.wait_for_request(page)["do"] == "pause"


def test_a_key_without_a_name_is_refused_in_a_sentence(play):
    page, driver = open_keys(play)
    page.evaluate(
        """() => document.getElementById('key-catch').dispatchEvent(new KeyboardEvent('keydown',
            {code: 'IntlBackslash', key: '<', bubbles: true, cancelable: true}))"""
    )
    wait_for(page, "key-said", "This key has no name in profiles. Take another one.")
    assert page.is_visible("#chooser")
    assert driver.asked == []


def test_every_key_that_can_be_caught_can_be_bound(play):
    page, _ = play("")
    codes = [f"Key{letter}" for letter in "AZ"] + ["Digit0", "F1", "F24", "Numpad0"]
    names = page.evaluate(
        """async (codes) => {
            const {KEYS, nameKey} = await import('/home/keys.js');
            return [...codes, ...Object.keys(KEYS)].map(nameKey);
        }""",
        codes,
    )
    assert set(names) <= set(KEYS)
    assert len(set(names)) == len(names)


def test_measuring_and_waiting_for_a_movement_exclude_each_other(play):
    page, driver = play("")
    driver.tell(about=VIEW, outputs=GROUPS)
    page.wait_for_selector("#by-doing:not([hidden])")
    driver.tell(program={"name": "calibrate", "line": "Step 1 of 10. Rest your hand."})
    wait_for(page, "request", "1 of 10")
    assert page.is_disabled("#by-doing")
    driver.tell(program={"name": "calibrate", "code": 0})
    page.wait_for_selector("#by-doing:not([disabled])")
    page.click("#by-doing")
    assert driver.wait_for_request(page) == {"do": "pause", "for": "movement"}
    assert page.is_disabled("#measure")
    page.click("#by-doing")
    assert driver.wait_for_request(page) == {"do": "resume", "for": "movement"}
    assert page.is_enabled("#measure")


@pytest.fixture
def waiting(driver, view, folder, open_page):
    """The live page, and one that has paused the driver and waits for a movement."""
    (folder / "config/neurotouch/profiles/mine.yaml").write_text(PROFILE)
    page = open_page(view.page("live"))
    wait_for(page, "driver-state", "Running")
    asking = open_page(view.home)
    asking.wait_for_selector("#by-doing:not([hidden])")
    asking.evaluate("document.getElementById('chooser').showModal = () => {}")  # it goes on waiting
    asking.click("#by-doing")
    wait_for(page, "driver-state", "Paused")
    return page, asking


def test_a_pause_for_a_movement_ends_with_the_page_that_asked(waiting):
    page, asking = waiting
    asking.close()
    wait_for(page, "driver-state", "Running")


@pytest.mark.parametrize("end", ["cancel", "close"])
def test_a_panic_while_a_movement_is_waited_for_stays(driver, view, waiting, open_page, end):
    page, asking = waiting
    driver.call("panic")
    wait_for(page, "driver-state", "Stopped by panic: everything is released")
    if end == "cancel":
        asking.click("#by-doing")
    asking.close()
    asking = open_page(view.home)
    asking.wait_for_selector("#by-doing:not([hidden])")
    assert driver.status()["state"] == "panic"
    driver.call("resume")


def test_the_doctor_s_commands_can_be_copied(play):
    page, driver = play("", permissions=["clipboard-read", "clipboard-write"])
    commands = [
        "echo uinput | sudo tee /etc/modules-load.d/neurotouch.conf",
        "sudo modprobe uinput",
    ]
    finding = {"check": "kernel module", "status": "FAILED", "sentence": "It is not loaded."}
    found = [
        {**finding, "fix": "Load it.", "commands": commands},
        {**finding, "check": "timer", "status": "WARNING", "fix": "Close others.", "commands": []},
        {**finding, "check": "camera", "status": "OK", "fix": None, "commands": []},
    ]
    driver.tell(program={"name": "check", "line": f"Checking …\n{json.dumps(found, indent=1)}"})
    driver.tell(program={"name": "check", "code": 1})
    wait_for(page, "check-state", "1 of 3 checks found a fault.")
    assert page.locator("#findings li").count() == 2
    assert page.inner_text("#findings pre") == "\n".join(commands)
    page.get_by_role("button", name="Copy the commands for kernel module").click()
    wait_for(page, "check-state", "Copied.")
    assert page.evaluate("navigator.clipboard.readText()") == "\n".join(commands)


def test_a_phone_says_before_that_what_it_starts_ends_with_its_right(play):
    page, driver = play("")
    assert page.is_hidden("#far")
    driver.tell(hello=True, edit=True, far=True)
    page.wait_for_selector("#far:not([hidden])")
    driver.tell(remote={"link": "http://192.0.2.1/", "code": "data:,", "minutes": 60})
    wait_for(page, "remote-state", "What was started from the phone ends then, too.")


def test_a_hint_of_a_refused_binding_has_no_file_in_it(view, folder, open_page):
    (folder / "config/neurotouch/profiles/mine.yaml").write_text(PROFILE)
    page = open_page(view.home)
    page.locator("[data-movement=zoom] .row button").click()
    page.select_option("#press-choice", "tap")
    page.select_option("#group-choice", "Sticks")
    page.click("#outputs button >> nth=0")
    wait_for(page, "saved", "Nothing was saved: ")
    assert "mine.yaml" not in page.inner_text("#saved")
    assert "^" not in page.inner_text("#saved")


def test_a_page_for_looking_offers_no_change_of_values(tmp_path, open_page):
    view = View(tmp_path)
    page = open_page(view.home)
    wait_for(page, "situation", "No camera found.")
    for button in ("#own-filter", "#own-undo", "#range-undo", "#measure"):
        assert page.is_disabled(button)
    page.close()
    view.end()
