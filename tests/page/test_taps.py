"""A short press on the gel, by a key or before the flight, is a press."""

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
