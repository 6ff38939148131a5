"""A trembling or slow hand: what it presses twice, or for long, is one press."""

from neurotouch_hid.page.output_choices import list_outputs
from neurotouch_hid.page.profile_view import describe_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from tests.page.waiting import wait_for, wait_on

BUTTON = "#pause-resume"
TWICE_MS = 500


def hold_enter(page, selector: str) -> None:
    """Keeps Enter down on a control: the key repeats."""
    page.focus(selector)
    for _ in range(4):
        page.keyboard.down("Enter")
    page.keyboard.up("Enter")


def test_a_long_press_of_enter_presses_a_button_once(play):
    page, driver = play("live")
    hold_enter(page, BUTTON)
    wait_on(page, lambda: driver.asked)
    page.wait_for_timeout(200)
    assert [each["do"] for each in driver.asked] == ["pause"]


def test_a_long_press_on_press_a_key_now_takes_no_key(play):
    page, driver = play("")
    view = describe_profile(find_shipped_folder() / "default.yaml", edit=True)
    driver.tell(about=view, outputs=list_outputs())
    page.locator("[data-movement=pinch] .row button").click()
    hold_enter(page, "#key-catch")
    assert page.inner_text("#key-catch") == "Waiting for the key …"
    page.keyboard.press("Enter")  # the next one is the key
    assert driver.wait_for_request(page)["do_this"] == "key enter"


def test_a_second_press_of_remove_does_not_remove_the_next_binding(play):
    """Which has the key of the removed one then."""
    page, driver = play("")
    view = describe_profile(find_shipped_folder() / "default.yaml", edit=True)
    bindings = view["layers"][0]["bindings"]
    first, second = (
        next(each for each in bindings if each["key"] == key) for key in ("pinch", "pinch#2")
    )
    driver.tell(about=view, outputs=list_outputs())
    page.focus("[data-place^='pinch pinch remove']")
    page.keyboard.press("Enter")
    assert driver.wait_for_request(page) == {"do": "unbind", "key": "pinch"}
    bindings.remove(first)
    second["key"] = "pinch"
    driver.tell(about=view)
    wait_on(page, lambda: page.locator("[data-place^='pinch pinch#2']").count() == 0)
    assert page.evaluate("document.activeElement.dataset.place") == "pinch add"


def test_who_presses_pause_twice_is_paused(play):
    page, driver = play("live", clock=True)
    for press in (lambda: page.click(BUTTON), lambda: page.keyboard.press("p")):
        page.clock.run_for(TWICE_MS)
        press()
        wait_on(page, lambda: driver.asked)
        driver.answer(saved="")
        driver.show(state="paused")
        wait_for(page, "driver-state", "Paused")
        press()
        page.wait_for_timeout(200)
        assert driver.asked == []
        page.clock.run_for(TWICE_MS)
        press()
        wait_on(page, lambda: driver.asked)
        assert driver.answer(saved="")["do"] == "resume"
        driver.show()
        wait_for(page, "driver-state", "Running")
