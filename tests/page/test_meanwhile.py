"""What is chosen while the connection is lost, or while the profile changes elsewhere."""

import pytest

from neurotouch_hid.page.output_choices import list_outputs
from neurotouch_hid.page.profile_view import describe_profile
from tests.page.waiting import refuse_connections, wait_for, wait_on

PROFILE = """\
version: 1
name: {name}
bindings:
  - when: {{gesture: pinch, on_mm: 2.0}}
    do: {{button: a}}
  - when: {{gesture: pinch, on_mm: 9.0}}
    do: {{button: b}}
  - when: zoom
    do: {{button: x}}
"""
VALUES = {"filter": "light", "timing": "", "neutral": "lifted", "fatigue": "none"}
NOT_SENT = "Not connected, so nothing was changed."
CHANGED = "The profile has changed meanwhile, so nothing was saved."


@pytest.fixture
def describe(tmp_path, monkeypatch):
    """Describes a person's profile, without some of its lines."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    folder = tmp_path / "neurotouch/profiles"
    folder.mkdir(parents=True)

    def describe_one(name: str = "mine", without: tuple[int, int] = (0, 0)) -> dict:
        lines = PROFILE.format(name=name).splitlines(keepends=True)
        path = folder / f"{name}.yaml"
        path.write_text("".join(lines[: without[0]] + lines[without[1] :]))
        return describe_profile(path, edit=True)

    return describe_one


FAULT = {"fault": "Line 3: the list does not end.", "can_undo": False}


def test_a_playing_profile_that_an_editor_breaks_is_not_shown_as_empty(play, describe):
    page, driver = play("")
    driver.tell(about=describe(), outputs=list_outputs())
    page.wait_for_selector("#cards:not([hidden])")
    driver.tell(about=FAULT)
    wait_for(page, "notice", "The profile cannot be shown: Line 3")
    assert page.is_hidden("#cards")  # each movement would do 'nothing' there
    driver.tell(about=describe())
    page.wait_for_selector("#cards:not([hidden])")
    assert page.is_hidden("#notice")


def lose_connection(page, driver) -> None:
    refuse_connections(page)
    driver.drop()
    wait_for(page, "driver-state", "Not connected")


def test_a_choice_without_a_connection_goes_back_and_says_so(play):
    page, driver = play("")
    driver.tell(own={"values": {**VALUES, "feedback.sound": "none"}})
    choice = page.get_by_label("Tremor filter")
    wait_on(page, lambda: choice.input_value() == "light")
    lose_connection(page, driver)
    wait_for(page, "situation", "Not connected.")
    choice.select_option("strong")
    wait_for(page, "own-said", NOT_SENT)
    assert choice.input_value() == "light"


def test_a_choice_whose_answer_is_lost_says_so(play):
    page, driver = play("")
    driver.tell(own={"values": {**VALUES, "feedback.sound": "none"}})
    page.get_by_label("Tremor filter").select_option("strong")
    wait_on(page, lambda: driver.asked)
    driver.drop()
    wait_for(page, "own-said", "The connection was lost before the answer.")


def test_a_mark_without_a_connection_goes_back_and_says_so(play, describe):
    page, driver = play("live")
    driver.tell(about=describe())
    page.wait_for_selector("#editor:not([hidden])")
    before = page.text_content("#mark-value")
    lose_connection(page, driver)
    page.click("#mark-more")
    wait_for(page, "notice", NOT_SENT)
    page.wait_for_timeout(2_500)  # more attempts to connect
    assert NOT_SENT in page.text_content("#notice")
    assert page.text_content("#mark-value") == before


def open_second_pinch(play, describe):
    page, driver = play("")
    driver.tell(about=describe(), outputs=list_outputs())
    page.click("[data-place='pinch pinch#2']")
    assert page.input_value("#instead-choice") == "pinch#2"
    return page, driver


def test_a_binding_keeps_its_place_while_another_page_removes_one_before_it(play, describe):
    page, driver = open_second_pinch(play, describe)
    driver.tell(about=describe(without=(3, 5)))
    wait_on(page, lambda: page.locator("#instead-choice option").count() == 2)
    page.click("#outputs button:text-is('Y')")
    assert driver.wait_for_request(page)["instead"] == "pinch"  # its key now


@pytest.mark.parametrize("changed", [{"without": (5, 7)}, {"name": "other"}])
def test_nothing_is_bound_if_the_binding_or_the_profile_is_another_one(play, describe, changed):
    page, driver = open_second_pinch(play, describe)
    driver.tell(about=describe(**changed))
    page.wait_for_selector("#chooser:not([open])", state="attached")
    wait_for(page, "saved", CHANGED)
    assert driver.asked == []


def test_a_mark_of_one_profile_changes_no_other(play, describe):
    page, driver = play("live", clock=True)
    driver.tell(about=describe())
    page.wait_for_selector("#editor:not([hidden])")
    page.clock.run_for(200)  # the state is drawn
    page.locator(".bars .mark.draggable").first.press("ArrowRight")
    driver.tell(about=describe(name="other"))
    page.wait_for_timeout(300)
    page.clock.run_for(1_000)
    wait_for(page, "saved", "Another profile plays now, so nothing was saved.")
    assert driver.asked == []
