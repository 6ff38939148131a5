"""What is wrong with the gel, on the page: seen, drawn, beside the drawing in words, heard once."""

from dataclasses import replace

import pytest

from neurotouch_hid.gel_sentences import report_gel
from neurotouch_hid.messages import GelProblem, GelState
from tests.page.played import FOUND
from tests.page.test_screen_reader import Reader
from tests.page.waiting import wait_for

MISSING = GelState(
    problem=GelProblem.MISSING,
    n_seen=107,
    missing=(3, 40, 41, *range(60, 127)),
    px_per_mm=2.5,
)


NAMED = "row 1: 4; row 5: 3, 4; row 6: 10, 11, 12, 13, 14 and 62 more"


def show_blur(driver, blur_px: float, **changes) -> None:
    gel = GelState(problem=GelProblem.BLURRED, blur_px=blur_px, **changes)
    driver.show(gel=report_gel(gel))


@pytest.mark.parametrize("name", ["", "live", "gel", "game", "sheet"])
def test_every_page_says_what_is_wrong_and_what_to_do(play, name):
    page, driver = play(name)
    assert page.is_hidden("#gel-problem")
    show_blur(driver, 3.1)
    wait_for(page, "gel-problem", "out of focus: each dot is blurred by 3.1 px. Turn the lens")
    assert page.is_visible("#gel-problem")
    driver.show()
    page.wait_for_selector("#gel-problem", state="hidden")


def test_a_screen_reader_hears_the_reason_once_and_not_each_number(play):
    page, driver = play("live")
    reader = Reader(page)
    for blur_px in (3.1, 3.2, 3.3):
        show_blur(driver, blur_px)
        wait_for(page, "gel-problem", f"{blur_px}")
    reader.wait_to_hear("out of focus")
    driver.show()
    reader.wait_to_hear("The gel is found.")
    assert len([text for text in reader.heard() if "out of focus" in text]) == 1


def test_the_start_page_says_the_reason_and_the_fix(play):
    page, driver = play("")
    driver.show(gel=report_gel(GelState(problem=GelProblem.DARK)))
    wait_for(page, "situation", "The gel is not found.")
    wait_for(page, "advice", "Switch the LED ring on")


def test_dots_that_are_missing_are_drawn_and_named_beside_the_drawing(play):
    page, driver = play("live")
    wait_for(page, "gel-words", "The gel is found. Scale: 2.5 px/mm.")
    whole = page.locator("#disc").screenshot()
    driver.show(gel=report_gel(MISSING))
    wait_for(page, "gel-words", f"70 dots are not seen (a cross each): {NAMED}")
    assert page.locator("#disc").screenshot() != whole
    driver.show(gel=report_gel(FOUND))
    wait_for(page, "gel-words", "The gel is found.")
    assert page.locator("#disc").screenshot() == whole


def test_while_a_person_turns_the_lens_the_page_says_how_sharp_the_dots_are(play):
    page, driver = play("live")
    for blur_px in (1.2, 0.7, 0.3):
        driver.show(gel=report_gel(replace(FOUND, blur_px=blur_px)))
        wait_for(page, "gel-words", f"Blur of a dot: {blur_px} px.")
