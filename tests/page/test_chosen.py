"""What the first page and the sheet say of the profile that plays, and of one that is chosen."""

import pytest

from neurotouch_hid.page.profile_view import describe_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from tests.page.waiting import wait_for, wait_on
from tests.processes import View

BROKEN = "version: 1\nname: broken\nbindings:\n  - {when: punch, do: {button: a}}\n"
RESUMES = "pauses everything; the same again resumes"


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The page's server on a machine where nothing runs, with a broken profile."""
    made = tmp_path_factory.mktemp("chosen")
    profiles = made / "config/neurotouch/profiles"
    profiles.mkdir(parents=True)
    (profiles / "broken.yaml").write_text(BROKEN)
    view = View(made, "--edit")
    yield view
    view.end()


def read(page, id_: str) -> str:
    return page.locator(f"#{id_}").text_content()


@pytest.mark.parametrize(
    ("name", "when", "movements"),
    [
        ("default", "pinch from 10 mm, held for 3 s", ["pinch"]),
        ("push-only", "push up left from 5 mm, held for 3 s", ["push_left", "push_up"]),
    ],
)
def test_a_profile_names_the_movement_that_stops_everything(name, when, movements):
    view = describe_profile(find_shipped_folder() / f"{name}.yaml", edit=True)
    assert view["stops"] == [{"when": when, "does": RESUMES, "movements": movements}]


def test_a_movement_is_named_as_a_screen_reader_can_say_it():
    view = describe_profile(find_shipped_folder() / "keyboard-arrows.yaml", edit=True)
    names = {binding["when"] for layer in view["layers"] for binding in layer["bindings"]}
    assert {"twist clockwise", "twist counter-clockwise"} <= {
        name.split(" from")[0] for name in names
    }
    assert not any("cw" in name.split() for name in names)


def test_any_movement_may_stop_everything():
    (stop,) = describe_profile(find_shipped_folder() / "menu-switch.yaml", edit=True)["stops"]
    assert stop["when"] == "any movement from 2.5 mm, held for 4 s"
    assert len(stop["movements"]) == 8


def test_another_profile_is_only_looked_at_and_its_sheet_is_printed(alone, open_page):
    page = open_page(alone.home)
    wait_for(page, "plays", "The next start plays default.")
    pinch = page.locator("[data-movement=pinch]")
    wait_on(page, lambda: f"pinch from 10 mm, held for 3 s: {RESUMES}" in pinch.inner_text())
    page.locator("#cards button").first.wait_for()
    page.select_option("#profile-choice", "push-only")
    wait_for(page, "plays", "Below is what push-only does, to look at.")
    push = page.locator("[data-movement=push_left]")
    wait_on(page, lambda: "push up left from 5 mm, held for 3 s" in push.inner_text())
    assert page.locator("#cards button:visible").count() == 0
    assert not page.locator("#undo").is_visible()
    page.click("#sheet")
    wait_for(page, "title", "What each movement does: push-only")
    wait_for(page, "stops", "The gel: push up left from 5 mm, held for 3 s")
    wait_for(page, "stop-keys", "hold Backspace + Escape + Space")
    wait_for(page, "stop-keys", "stops everything; Resume on the page goes on")
    page.reload()
    wait_for(page, "title", "What each movement does: push-only")
    page.goto(alone.page("sheet"))
    page.reload()
    wait_for(page, "title", "What each movement does: default")


def test_a_refusal_is_beside_its_button_until_the_next_action(alone, open_page):
    """Also that of a broken profile, which says what is wrong with it."""
    page = open_page(alone.home)
    wait_for(page, "plays", "default")
    page.select_option("#profile-choice", "broken")
    wait_for(page, "profile-about", "It has an error. Line 4, 'bindings[0].when': ")
    page.click("#profile-use")
    wait_for(page, "saved", "punch")
    page.select_option("#own-filter", "light")
    wait_for(page, "own-said", "Saved.")
    assert read(page, "saved") == ""
    assert page.locator(".refused").count() == 0
    assert not page.locator("#notice").is_visible()


def test_what_plays_is_told_whoever_has_changed_it(play):
    page, driver = play("")
    rows = [
        {"name": name, "own": False, "first": name == "mine", "about": "", "broken": False}
        for name in ("mine", "other")
    ]
    driver.tell(profiles=rows)
    wait_for(page, "plays", "mine plays now.")
    page.select_option("#profile-choice", "other")
    wait_for(page, "plays", "Below is what other does, to look at. mine plays now.")
    page.click("#profile-use")
    wait_on(page, lambda: driver.asked)
    assert driver.answer(saved="")["profile"] == "other"
    driver.show(profile="other")
    page.wait_for_function(
        "() => document.getElementById('plays').textContent === 'other plays now.'"
    )
    driver.show(profile="mine")  # from elsewhere
    page.wait_for_function(
        "() => document.getElementById('plays').textContent === 'mine plays now.'"
    )
    assert read(page, "saved") == ""
