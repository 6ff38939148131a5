"""A short press on the gel, by a key or before the flight, is a press."""

import pytest

from tests.page.waiting import wait_on


def test_a_tap_of_a_key_is_a_whole_movement(play):
    page, driver = play("gel")
    page.focus("#gel")
    page.keyboard.press("-", delay=20)
    wait_on(page, lambda: any(hand["spread_mm"] == -6 for hand in driver.hands))
    wait_on(page, lambda: not driver.hands[-1]["down"])


def test_another_key_ends_a_tap_that_still_acts(play):
    page, driver = play("gel")
    page.focus("#gel")
    page.keyboard.press("ArrowLeft", delay=20)
    page.keyboard.down("ArrowRight")
    wait_on(page, lambda: driver.hands and driver.hands[-1]["push_x_mm"] == 6)
    page.keyboard.up("ArrowRight")


def test_a_press_on_the_gel_begins_the_flight(play):
    page, _ = play("game")
    page.wait_for_selector("#gel-panel:not([hidden])")
    assert "press the gel" in page.inner_text("#no-gel")
    page.hover("#gel")
    page.mouse.down()
    page.wait_for_function("() => document.body.dataset.mode === 'flying'")
    page.mouse.up()


def wait_in_the_game(page, ms: int) -> None:
    """Lets the game's time pass without its pictures, each of which costs real time."""
    page.evaluate(
        "Object.defineProperty(document, 'hidden', {get: () => true, configurable: true})"
    )
    page.clock.run_for(ms)


def watch(page, by: str) -> None:
    """Lets the attract mode begin: by its button, or because nobody is there."""
    if by == "button":
        page.click("#watch")
    else:
        wait_in_the_game(page, 46_000)
    page.wait_for_function("() => document.body.dataset.mode === 'watching'")


@pytest.mark.parametrize(
    ("by", "key"),
    [
        *(("button", key) for key in ("Enter", "Space", "ArrowLeft", "x", "click", "gel")),
        ("nobody", "Enter"),
        ("nobody", "click"),
    ],
)
def test_a_key_or_a_press_in_the_attract_mode_begins_the_flight(play, by, key):
    page, driver = play("game", clock=True)
    watch(page, by)
    wait_in_the_game(page, 500)
    assert "press a key or the screen" in page.inner_text("#advice")
    if key == "click":
        page.mouse.click(300, 500)
    elif key == "gel":
        driver.show()
        page.hover("#gel")
        page.mouse.down()
    else:
        page.keyboard.press(key)
    wait_in_the_game(page, 500)
    assert page.get_attribute("body", "data-mode") == "flying"


@pytest.mark.parametrize("key", ["Tab", "Shift", "Control+c", "F2"])
def test_other_keys_leave_the_attract_mode_as_it_is(play, key):
    page, _ = play("game", clock=True)
    watch(page, "button")
    page.keyboard.press(key)
    wait_in_the_game(page, 500)
    assert page.get_attribute("body", "data-mode") == "watching"


def test_the_attract_mode_can_be_paused_and_the_driver_too(play):
    page, driver = play("game", clock=True)
    watch(page, "button")
    page.keyboard.press("p")
    wait_on(page, lambda: driver.asked)
    assert page.get_attribute("body", "data-mode") == "watching"
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")  # Pause the flight
    assert page.get_attribute("body", "data-mode") == "paused"


@pytest.mark.parametrize("touch", ["Tab", "mouse"])
def test_nobody_who_is_there_is_hurried_by_the_attract_mode(play, touch):
    page, _ = play("game", clock=True)
    if touch == "mouse":
        page.mouse.move(200, 200)
    else:
        page.keyboard.press(touch)
    wait_in_the_game(page, 60_000)
    assert page.get_attribute("body", "data-mode") == "start"


def test_a_long_press_of_enter_is_one_press(play):
    page, _ = play("game")
    page.focus("#fly")
    for _ in range(3):
        page.keyboard.down("Enter")  # a key that is kept down repeats
    assert page.get_attribute("body", "data-mode") == "flying"
    page.keyboard.up("Enter")


def test_the_keys_of_a_russian_keyboard_turn_the_gel_too(play):
    page, driver = play("gel")
    press = "new KeyboardEvent('keydown', {key: 'у', code: 'KeyE'})"  # where others have E
    page.evaluate(f"document.getElementById('gel').dispatchEvent({press})")
    wait_on(page, lambda: any(hand["twist_rad"] > 0 for hand in driver.hands))
