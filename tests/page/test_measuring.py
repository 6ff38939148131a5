"""What the first page says at the end of a measurement, and where the gel is meanwhile."""

import pytest

from neurotouch_hid.page.profile_view import describe_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from tests.page.waiting import wait_for, wait_on

VIEW = describe_profile(find_shipped_folder() / "default.yaml", edit=True)
SCREEN = {"viewport": {"width": 1280, "height": 757}}
IN_VIEW = """ids => ids.every(id => {
    const {top, bottom} = document.getElementById(id).getBoundingClientRect();
    return top >= 0 && bottom <= innerHeight && bottom > top;
})"""


def test_the_question_is_there_once_and_the_end_says_saved(play):
    page, driver = play("")
    page.click("#measure")
    question = "Save this as your own, although it is simulated?"
    for line in (question, "  1. Save", "  2. Save nothing", "Number, 1 to 2:"):
        driver.tell(program={"name": "calibrate", "line": line})
    page.wait_for_selector("#choices button")
    assert page.inner_text("#request") == question
    assert page.inner_text("#answer") == ""
    page.click("#choices button >> nth=0")
    assert page.inner_text("#request") != question
    for line in ("OK      Saved /home/a/user.yaml", "It applies now.", "Resumed."):
        driver.tell(program={"name": "calibrate", "line": line})
    driver.tell(program={"name": "calibrate", "code": 0})
    wait_for(page, "request", "Saved. It applies now.")


@pytest.mark.parametrize(("button", "sentence"), [("measure", "request"), ("by-doing", "saved")])
def test_the_gel_and_what_to_do_on_it_are_in_view_together(play, button, sentence):
    page, driver = play("", **SCREEN)
    driver.tell(about=VIEW)
    page.click(f"#{button}")
    wait_on(page, lambda: page.evaluate(IN_VIEW, [sentence, "gel"]))
    if button == "by-doing":
        page.click("#by-doing")  # cancelled
        page.locator("#start-gel #gel").wait_for(state="attached")
