"""The header of every page: the state, one button, one key, and how much is spoken."""

import pytest

from tests.page.played import PlayedDriver
from tests.page.waiting import rest_hand, wait_for, wait_on
from tests.processes import View

NAMES = ["", "live", "gel", "game", "sheet"]
BUTTON = "#pause-resume"
REFUSED = "there is nothing to undo"


def wait_until_asked(page, driver, order: str) -> None:
    wait_on(page, lambda: driver.asked)
    assert [each["do"] for each in driver.asked] == [order]


@pytest.mark.parametrize("name", NAMES)
def test_pause_is_the_first_tab_stop_after_the_skip_link_of_every_page(play, name):
    page, _ = play(name)
    page.evaluate("document.activeElement.blur()")
    stops = []
    for _ in range(2):
        page.keyboard.press("Tab")
        stops.append(page.evaluate("[document.activeElement.className, document.activeElement.id]"))
    assert stops == [["skip", ""], ["", "pause-resume"]]


def test_nothing_is_said_to_play_when_no_driver_runs(play):
    page, driver = play()
    wait_for(page, "badges", "profile")
    driver.tell(driver=False)
    wait_for(page, "driver-state", "No driver is running")
    assert page.text_content("#badges") == ""
    driver.show()
    wait_for(page, "badges", "profile")


@pytest.mark.parametrize("name", NAMES)
def test_one_button_and_one_key_pause_and_resume(play, name):
    page, driver = play(name)
    button = page.get_by_role("button", name="Pause", exact=True)
    assert button.text_content() == "PauseP"
    button.click()
    wait_until_asked(page, driver, "pause")
    driver.answer(saved="")
    driver.show(state="paused")
    wait_for(page, "driver-state", "Paused: everything is released")
    assert button.count() == 0
    rest_hand(page)
    page.get_by_role("button", name="Resume", exact=True).click()
    wait_until_asked(page, driver, "resume")
    driver.answer(saved="")
    driver.show()
    wait_for(page, "driver-state", "Running")
    page.keyboard.press("p")
    wait_until_asked(page, driver, "pause")
    driver.answer(saved="")
    driver.show(state="panic")
    wait_for(page, "driver-state", "Stopped by panic")
    rest_hand(page)
    page.keyboard.press("p")
    wait_until_asked(page, driver, "resume")


def test_the_key_does_nothing_in_a_field_and_can_be_switched_off(play):
    page, driver = play("gel")
    page.click("#page-settings summary")
    page.focus("#spoken")
    page.keyboard.press("p")
    page.focus("#gel")  # which has keys of its own
    page.keyboard.press("Control+p")
    page.keyboard.press("p")
    wait_until_asked(page, driver, "pause")
    driver.answer(saved="")
    assert page.get_attribute(BUTTON, "aria-keyshortcuts") == "P"
    for _ in range(2):  # the choice is remembered
        page.set_checked("#pause-key", checked=False)
        assert page.inner_text(BUTTON) == "Pause"
        assert page.get_attribute(BUTTON, "aria-keyshortcuts") is None
        page.focus("#gel")
        page.keyboard.press("p")
        page.reload()
        driver.show()
        wait_for(page, "driver-state", "Running")
        assert not page.is_checked("#pause-key")
        page.click("#page-settings summary")
    assert driver.asked == []


def test_the_key_pauses_on_a_keyboard_of_other_letters_too(play):
    page, driver = play()
    for key in ("ö", "з"):  # a Latin layout that has P elsewhere, and a Russian one
        press = f"new KeyboardEvent('keydown', {{key: '{key}', code: 'KeyP', bubbles: true}})"
        page.evaluate(f"document.body.dispatchEvent({press})")
    wait_until_asked(page, driver, "pause")


def test_the_button_says_why_it_does_nothing(play, open_page, alone, tmp_path):
    page = open_page(alone.link)
    wait_for(page, "driver-state", "No driver is running")
    reason = "document.querySelector('#pause-resume').getAttribute('aria-describedby')"
    assert page.get_attribute(BUTTON, "aria-disabled") == "true"
    assert page.evaluate(reason).split() == ["pause-reason"]
    page, driver = play()
    assert page.get_attribute(BUTTON, "aria-disabled") == "false"
    driver.tell(driver=False)
    wait_for(page, "driver-state", "No driver is running")
    page.keyboard.press("p")
    page.locator(BUTTON).click(force=True)
    assert driver.asked == []
    looking = View(tmp_path)
    try:
        page = open_page("about:blank")
        driver = PlayedDriver(page, edit=False)
        page.goto(looking.link)
        wait_for(page, "driver-state", "Waiting")
        assert page.text_content("#pause-reason") == ""  # one reason at a time
        driver.show()
        wait_for(page, "pause-reason", "neurotouch view --edit")
        assert page.get_attribute(BUTTON, "aria-disabled") == "true"
        page.close()
    finally:
        looking.end()


SILENT = {
    "kind": "no_data",
    "text": "The camera sends nothing.",
    "next": "",
    "mend": "",
    "start": "",
}


def test_a_silent_server_does_not_mean_that_everything_is_released(play):
    page, driver = play(clock=True)
    page.clock.run_for(8_000)
    wait_for(page, "driver-state", "Nothing arrives here: the driver may still play")
    driver.tell(situation=SILENT)
    page.wait_for_timeout(200)
    page.clock.run_for(1_000)
    wait_for(page, "driver-state", "No data: everything is released")


def test_no_data_is_no_running(play):
    page, driver = play(clock=True)
    driver.tell(situation=SILENT)
    page.wait_for_timeout(200)
    page.clock.run_for(5_000)
    wait_for(page, "driver-state", "No data: everything is released")
    page.click(BUTTON)
    wait_until_asked(page, driver, "pause")
    driver.answer(saved="'pause' takes effect when data resumes.")
    wait_for(page, "notice", "'pause' takes effect when data resumes.")
    driver.show(state="paused")
    wait_for(page, "driver-state", "Paused")


def test_a_refusal_goes_when_the_next_request_is_answered(play):
    page, driver = play()
    driver.tell(refused=REFUSED)
    wait_for(page, "notice", REFUSED)
    page.click(BUTTON)
    wait_until_asked(page, driver, "pause")
    assert page.is_visible("#notice")
    driver.answer(saved="")
    page.wait_for_selector("#notice", state="hidden")


def test_the_flight_waits_while_the_driver_is_paused(play):
    page, driver = play("game")
    page.click("#fly")
    driver.show(state="paused")
    page.wait_for_selector("#pause-panel:not([hidden])")
    assert "The gel is paused" in page.inner_text("#pause-words")
    driver.show()
    page.wait_for_selector("#pause-panel", state="hidden")
    driver.show(state="paused")
    page.click("#go-on")
    wait_until_asked(page, driver, "resume")


def listen(page) -> None:
    """Keeps what the live regions of a page say from now on."""
    page.evaluate(
        """() => {
            window.spoken = [];
            const regions = document.querySelectorAll('[aria-live], [role=status], [role=alert]');
            for (const region of regions) new MutationObserver(() => {
                if (region.textContent) window.spoken.push(region.textContent.trim());
            }).observe(region, {childList: true, characterData: true, subtree: true});
        }"""
    )


def play_changes(page, driver) -> list[str]:
    """What is spoken of a gesture, a layer, a profile, a refusal and a pause."""

    def let_pass(changes: dict) -> None:
        for _ in range(3):  # there is data all the time
            driver.show(**changes)
            page.clock.fast_forward(1_000)

    listen(page)
    for changes in (
        {"say": "Push right 3.0 mm"},
        {"say": "Push right 4.0 mm"},
        {"layer": "menu"},
        {"profile": "other", "layer": "base"},
        {"profile": "other", "layer": "base", "state": "paused"},
    ):
        let_pass(changes)
    driver.tell(refused=REFUSED)
    wait_for(page, "notice", REFUSED)
    let_pass(changes)
    return page.evaluate("window.spoken")


IMPORTANT = ["Layer menu.", "Profile other.", "Paused: everything is released.", REFUSED]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", ["all", "important", "none"])
def test_what_is_spoken_is_chosen_and_remembered(play, name, level):
    page, driver = play(name, clock=True)
    page.click("#page-settings summary")
    page.select_option("#spoken", level)
    page.reload()
    driver.show()
    wait_for(page, "driver-state", "Running")
    assert page.input_value("#spoken") == level
    page.clock.fast_forward(2_000)  # "Running." is said
    spoken = play_changes(page, driver)
    if level == "none":
        assert spoken == []
    if level == "important":
        assert spoken == IMPORTANT
    if level == "all":
        assert [each for each in spoken if each in IMPORTANT] == IMPORTANT
    if level == "all" and name in ("live", "gel"):  # the game speaks of its rings
        assert "Push right 3.0 mm" in spoken
        assert "Push right 4.0 mm" not in spoken


@pytest.mark.parametrize(("name", "slider"), [("gel", "size"), ("game", "pace")])
def test_a_slider_says_its_value_itself_and_only_once(play, name, slider):
    page, _ = play(name)
    page.focus(f"#{slider}")
    page.keyboard.press("ArrowRight")
    words = page.inner_text(f"#{slider}-value")
    assert page.get_attribute(f"#{slider}", "aria-valuetext") == words
    assert page.get_attribute(f"#{slider}-value", "aria-live") == "off"
