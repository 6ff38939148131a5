"""The first page in a real browser: started, changed, measured, checked and shared, by buttons.

Pages close before their server ends, so a test names `open_page` after the server.
"""

import os
import shutil
import subprocess

import pytest

from neurotouch_hid.page.output_choices import list_outputs
from neurotouch_hid.page.profile_view import describe_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from tests.page.conftest import PROFILE
from tests.page.waiting import rest_hand, wait_for, wait_on
from tests.processes import LIMIT_S, Driver, View


def read(page, id_: str) -> str:
    return page.locator(f"#{id_}").text_content()


def test_from_nothing_to_the_mouse_gel_and_back_without_a_terminal(bare, open_page):
    page = open_page(bare.home)
    wait_for(page, "situation", "No camera found.")
    page.click("#start-mouse")  # the first click
    page.wait_for_selector("#fly:not([hidden])")
    wait_for(page, "situation", "The mouse presses a simulated gel.")
    assert "/game#k=" in page.get_attribute("#fly", "href")  # the second; the third is Fly
    page.focus("#end")
    page.keyboard.press("Enter")
    page.wait_for_function("() => document.activeElement.id === 'start-mouse'")
    wait_on(page, lambda: "No real controller" not in read(page, "start-lines"))


def test_what_the_page_started_ends_with_the_page(bare, open_page):
    page = open_page(bare.home)
    page.click("#start-mouse")
    page.wait_for_selector("#end:not([hidden])")
    pid = Driver.status(bare)["pid"]
    page.close()
    bare.end()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_profiles_can_be_prepared_before_anything_runs(bare, open_page):
    page = open_page(bare.home)
    page.select_option("#profile-choice", "push-only")
    page.click("#profile-copy")
    wait_for(page, "saved", "'mine' is your own copy of push-only.")
    wait_for(page, "saved", "it applies from the next start")
    page.wait_for_selector("[data-movement=push_left] li button")
    page.wait_for_function("() => document.getElementById('profile-choice').value === 'mine'")
    page.locator("[data-movement=pinch] .row button").click()
    page.click("#outputs button:text-is('X')")
    wait_for(page, "saved", "Saved in mine")
    assert "button: x" in (bare.folder / "config/neurotouch/profiles/mine.yaml").read_text()
    page.click("#start-mouse")  # the next start
    wait_for(page, "situation", "The mouse presses a simulated gel.")
    wait_for(page, "badges", "profile mine")


def test_a_movement_is_made_and_put_on_a_button(view, folder, open_page):
    """Bind by doing: nothing acts meanwhile, and the saved profile plays at once."""
    path = folder / "config/neurotouch/profiles/mine.yaml"
    path.write_text(PROFILE)
    page = open_page(view.home)
    page.click("#by-doing")
    wait_for(page, "driver-state", "Paused")
    page.wait_for_selector("#chooser[open]")
    movement = read(page, "chooser-title").removesuffix(" does …")
    page.select_option("#group-choice", "Buttons")
    page.click("#outputs button:text-is('Y')")
    wait_for(page, "saved", "It applies now.")
    assert 'button: "y"' in path.read_text()
    wait_for(page, "driver-state", "Running")
    page.wait_for_function(
        "([name]) => [...document.querySelectorAll('.movement')].some((card) =>"
        " card.querySelector('h3').textContent.includes(name) &&"
        " card.textContent.includes('button Y'))",
        arg=[movement],
    )
    page.click("#undo")
    wait_for(page, "saved", "mine is as before that change.")
    assert path.read_text() == PROFILE


def test_a_card_is_changed_by_keyboard_alone(view, folder, open_page):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    path.write_text(PROFILE)
    page = open_page(view.home)
    change = page.locator("[data-movement=pinch] li button").first
    change.wait_for()
    change.focus()
    page.keyboard.press("Enter")
    page.wait_for_selector("#chooser[open]")
    page.locator("#group-choice").focus()
    while page.input_value("#group-choice") != "Keyboard":
        page.keyboard.press("ArrowDown")
    page.locator("#outputs button:text-is('space')").wait_for()
    page.locator("#key-catch").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Control+KeyC")
    wait_for(page, "saved", "It applies now.")
    assert "key: ctrl+c" in path.read_text()
    assert "button: a" not in path.read_text()  # in place of it
    path.write_text(PROFILE)


def test_the_picture_of_the_pad_is_a_choice_too(view, folder, open_page):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    path.write_text(PROFILE)
    page = open_page(view.home)
    page.locator("[data-movement=twist_ccw] .row button").click()
    page.locator("#pad-picture .choosable").nth(0).click()  # the left trigger
    wait_for(page, "saved", "It applies now.")
    assert "trigger: left" in path.read_text()
    page.locator("[data-movement=twist_ccw] li button").nth(1).click()  # removes it
    wait_for(page, "saved", "Removed")
    assert "trigger: left" not in path.read_text()
    path.write_text(PROFILE)


def test_what_cannot_be_bound_is_refused_and_nothing_is_saved(view, folder, open_page):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    path.write_text(PROFILE)
    page = open_page(view.home)
    page.locator("[data-movement=zoom] .row button").click()
    page.select_option("#press-choice", "tap")
    page.select_option("#group-choice", "Sticks")
    page.click("#outputs button >> nth=0")
    wait_for(page, "saved", "Nothing was saved")
    assert path.read_text() == PROFILE


@pytest.mark.parametrize("button", ["#profile-use", "#profile-copy"])
def test_a_profile_with_errors_is_refused_in_words_to_be_read_aloud(alone, open_page, button):
    path = alone.folder / "config/neurotouch/profiles/broken.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("version: 1\nname: broken\nbindings:\n  - {when: pusch, do: {stick: left}}\n")
    page = open_page(alone.home)
    page.wait_for_selector("#profile-choice option[value=broken]", state="attached")
    page.select_option("#profile-choice", "broken")
    page.click(button)
    wait_for(page, "saved", "The profile 'broken' cannot be used. Line 4, ")
    assert "^" not in read(page, "saved")
    path.unlink()


@pytest.mark.parametrize("end", ["cancelled", "Escape", "the driver ends"])
def test_what_is_asked_for_is_no_longer_said_when_it_is_over(play, end):
    page, driver = play("")
    view = describe_profile(find_shipped_folder() / "default.yaml", edit=True)
    driver.tell(about=view, outputs=list_outputs())
    driver.show(profile="default", layer=view["layers"][0]["name"])
    page.click("#by-doing")
    wait_for(page, "saved", "The gamepad is paused meanwhile.")
    driver.show(profile="default", layer=view["layers"][0]["name"], state="paused")
    if end == "cancelled":
        page.click("#by-doing")
    elif end == "Escape":
        page.keyboard.press("Escape")
    else:
        driver.tell(
            driver=False, situation={"kind": "none", "text": "No camera found.", "next": ""}
        )
    wait_for(page, "by-doing", "Make a movement to change it")
    assert read(page, "saved") == ""


def test_the_range_is_measured_with_the_words_of_the_terminal(view, folder, open_page):
    page = open_page(view.home)
    page.wait_for_selector("#by-doing:not([hidden])")
    page.click("#measure")
    wait_for(page, "request", "1 of 10: Rest your hand")
    wait_for(page, "driver-state", "Paused")
    page.click("[data-answer='']")
    wait_for(page, "request", "2 of 10")
    page.click("[data-answer='b']")
    wait_for(page, "request", "1 of 10")
    for _ in range(2):
        page.click("[data-answer='']")
    for step in range(3, 11):
        wait_for(page, "request", f"{step} of 10")
        page.click("[data-answer='s']")
    page.wait_for_selector("#measure:not([hidden])")
    wait_for(page, "driver-state", "Running")
    assert not (folder / "config/neurotouch/user.yaml").exists()


def test_a_measurement_continues_after_the_page_s_server_has_ended(driver, folder, open_page):
    """It is killed in the middle; the next one knows where it was, and so does the driver's end."""
    first = View(folder, "--edit")
    page = open_page(first.home)
    page.wait_for_selector("#by-doing:not([hidden])")
    page.click("#measure")
    for step in (1, 2):
        wait_for(page, "request", f"{step} of 10")
        page.click("[data-answer='']")
    wait_for(page, "request", "3 of 10")
    page.click("[data-answer='s']")
    wait_for(page, "request", "4 of 10")
    first.process.kill()
    first.process.wait()
    page.goto("about:blank")  # what it says while nobody answers is another test's
    second = View(folder, "--edit")
    try:
        page.goto(second.home)
        wait_for(page, "range-words", "A measurement is not finished: 3 of 10 steps are done")
        wait_for(page, "measure", "Continue measuring")
        wait_for(page, "driver-state", "Running")  # who is gone keeps nothing paused
        page.click("#measure")
        wait_for(page, "request", "4 of 10")
        page.click("[data-answer='r']")
        wait_for(page, "request", "1 of 10")
        page.click("[data-answer='q']")
        wait_for(page, "request", "Ended. Nothing was saved.")
        wait_for(page, "measure", "Measure my range again")
    finally:
        page.goto("about:blank")
        second.end()


def test_a_measurement_continues_after_the_driver_has_ended(bare, open_page):
    page = open_page(bare.home)
    page.click("#start-mouse")
    wait_for(page, "situation", "The mouse presses a simulated gel.")
    page.click("#measure")
    page.locator("#measuring #gel").wait_for()  # beside the question
    for step in (1, 2, 3):
        wait_for(page, "request", f"{step} of 10")
        page.click("[data-answer='']")
    wait_for(page, "answer", "0 of 2 so far.")
    assert "Enter" not in read(page, "answer")  # the page has a button for it
    page.click("[data-answer='s']")
    wait_for(page, "request", "4 of 10")
    Driver.call(bare, "stop")
    wait_for(page, "request", "Ended. What you did is kept.")
    page.locator("#start-gel #gel").wait_for(state="attached")
    page.click("#start-mouse")
    wait_for(page, "measure", "Continue measuring")
    page.click("#measure")
    wait_for(page, "request", "4 of 10")
    page.click("[data-answer='q']")
    wait_for(page, "request", "Ended. Nothing was saved.")


def test_the_camera_s_picture_and_the_sheet(view, folder, open_page):
    (folder / "config/neurotouch/profiles/mine.yaml").write_text(PROFILE)
    page = open_page(view.home)
    page.click("#look")
    page.wait_for_selector("#picture:not([hidden])")
    page.wait_for_function("() => document.getElementById('picture').naturalWidth === 346")
    sheet = open_page(view.page("sheet"))
    wait_for(sheet, "layers", "button A")
    assert "left stick, all directions" in read(sheet, "layers")
    sheet.emulate_media(media="print")
    assert not sheet.locator("header").is_visible()


def test_the_machine_is_checked_from_the_page(bare, open_page):
    page = open_page(bare.home)
    page.click("#check")
    page.wait_for_function(
        "() => /checks: everything|found a fault/.test("
        "document.getElementById('check-state').textContent)"
    )
    assert page.locator("#findings li").count() >= 1  # no camera, no right to make a pad


def test_a_phone_is_let_in_and_out(view, open_page):
    page = open_page(view.home)
    page.click("#remote")
    page.wait_for_function(
        "() => document.getElementById('remote-link').textContent"
        " || document.querySelector('#remote-state.refused')"
    )
    link = read(page, "remote-link")
    if not link:
        assert "not connected to a network" in read(page, "remote-state")
        return
    phone = open_page(link, viewport={"width": 390, "height": 844}, has_touch=True)
    phone.locator("#pause-resume").tap()
    wait_for(page, "driver-state", "Paused")
    rest_hand(phone)
    phone.locator("#pause-resume").tap()
    wait_for(page, "driver-state", "Running")
    phone.locator("#remote").tap()
    wait_for(phone, "remote-state", "Only the machine itself")
    phone.close()
    page.click("#remote-end")
    wait_for(page, "remote-state", "No phone")
    late = subprocess.run(
        [shutil.which("curl") or "curl", "-sS", "--max-time", "5", link.split("#")[0]],
        capture_output=True,
        check=False,
        timeout=LIMIT_S,
    )
    assert late.returncode == 7  # nobody listens


def test_a_page_that_only_shows_changes_and_starts_nothing(open_page, tmp_path):
    view = View(tmp_path)
    try:
        page = open_page(view.home)
        wait_for(page, "situation", "No camera found.")
        page.click("#start-mouse")
        wait_for(page, "start-lines", "read-only")
        wait_on(page, lambda: page.locator("#start-mouse").is_visible())
        page.close()
    finally:
        view.end()


def test_a_lost_connection_ends_the_questions_and_says_what_is_kept(play):
    """Buttons that reach nobody would lose what a person does next."""
    page, driver = play("")
    page.wait_for_selector("#measure:not([disabled])")
    page.click("#measure")
    driver.tell(program={"name": "calibrate", "line": "Step 4 of 10. Push to the right."})
    wait_for(page, "request", "4 of 10: Push to the right.")
    driver.drop()
    wait_for(page, "request", "The connection is lost. What you did is kept.")
    assert not page.locator("#answers").is_visible()
    wait_for(page, "driver-state", "Waiting for the driver")  # it has connected again
    values = {"filter": "strong", "timing": "slow", "neutral": "resting", "fatigue": "auto"}
    values["feedback.sound"] = "speech"
    unfinished = {"hand": "", "simulated": "3 of 10 steps"}
    driver.tell(own={"values": values, "unfinished": unfinished})
    driver.show()
    wait_for(page, "measure", "Continue measuring")
