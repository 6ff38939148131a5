"""An undo button does nothing while there is nothing to undo, and says so without being pressed."""

import pytest

from neurotouch_hid.page.edits import Changes
from neurotouch_hid.page.own_values import OwnValues, describe_own
from neurotouch_hid.page.profile_view import can_undo, describe_profile
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile.calibration import write_ranges
from neurotouch_hid.profile.editing import take_user
from neurotouch_hid.profile.schema.user import MovementRange
from tests.page.conftest import PROFILE
from tests.page.waiting import wait_for, wait_on
from tests.processes import View

WORDS = {
    "undo": "There is no change to undo.",
    "range-undo": "There is no measurement to undo.",
    "own-undo": "There is no choice to undo.",
}


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A person's profile; no driver runs."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    path = tmp_path / "neurotouch/profiles/mine.yaml"
    path.parent.mkdir(parents=True)
    path.write_text(PROFILE)
    return path


def read_button(page, id_: str) -> tuple[str, str]:
    """Whether a button is disabled, and its description, as a screen reader gets them."""
    described = page.get_attribute(f"#{id_}", "aria-describedby")
    return page.get_attribute(f"#{id_}", "aria-disabled"), page.text_content(f"#{described}")


def test_the_server_knows_whether_a_profile_has_a_change_to_undo(mine):
    changes = Changes(lambda: "now")
    assert not can_undo(mine)
    for value in (3.0, 2.5):
        changes.set(mine, "pinch", "off_mm", value)
    for _ in range(2):
        assert describe_profile(mine, edit=True)["can_undo"]
        assert not describe_profile(mine, edit=False)["can_undo"]
        changes.undo(mine)
    assert not can_undo(mine)


def test_a_change_with_a_text_editor_can_be_undone_too(mine):
    changes = Changes(lambda: "now")
    changes.set(mine, "pinch", "off_mm", 3.0)
    changes.undo(mine)
    mine.write_text(PROFILE.replace("4.0", "5.0"))
    assert can_undo(mine)
    changes.undo(mine)
    assert mine.read_text() == PROFILE


def test_choices_and_measurements_are_known_apart(mine):
    own = OwnValues(lambda: "now")
    assert describe_own()["can_undo"] == {"values": False, "ranges": False}
    own.set("filter", "strong")
    assert describe_own()["can_undo"] == {"values": True, "ranges": False}
    edited = take_user(lambda: "now_calibration")
    measured = {"push_left": MovementRange(rest=1.0, full=5.0)}
    edited.save(write_ranges(edited.text, measured, "2026-11-25"))
    assert describe_own()["can_undo"] == {"values": True, "ranges": True}
    own.undo_calibration()
    own.undo()
    assert describe_own()["can_undo"] == {"values": False, "ranges": False}
    find_user_file().write_text("version: 1\nfiltr: strong\n")
    assert set(describe_own()["can_undo"]) == {"values", "ranges"}  # it is told, not raised


def test_the_last_undo_leaves_the_focus_and_the_button_says_why_it_does_nothing(
    tmp_path, open_page
):
    profiles = tmp_path / "config/neurotouch/profiles"
    profiles.mkdir(parents=True)
    view = View(tmp_path, "--edit")
    page = open_page(view.home)
    wait_for(page, "plays", "The next start plays default.")
    for id_, words in WORDS.items():
        assert read_button(page, id_) == ("true", words)
        assert page.is_visible(f"#{id_}-reason")
    page.get_by_label("Tremor filter").select_option("strong")
    wait_for(page, "own-said", "Saved.")
    wait_on(page, lambda: read_button(page, "own-undo") == ("false", ""))
    assert read_button(page, "range-undo")[0] == "true"
    page.focus("#own-undo")
    page.keyboard.press("Enter")
    wait_for(page, "own-said", "These values are as before.")
    wait_on(page, lambda: read_button(page, "own-undo") == ("true", WORDS["own-undo"]))
    assert page.evaluate("document.activeElement.id") == "own-undo"
    page.keyboard.press("Enter")
    wait_for(page, "live", WORDS["own-undo"])
    assert "as before" in page.text_content("#own-said")  # nothing was asked for
    page.close()
    view.end()


def test_the_live_view_has_the_same_button(view, folder, open_page):
    (folder / "config/neurotouch/profiles/mine.yaml").write_text(PROFILE)
    page = open_page(view.link)
    page.wait_for_selector("#editor:not([hidden])")
    wait_on(page, lambda: read_button(page, "undo") == ("true", WORDS["undo"]))
    page.click("#mark-more")
    wait_on(page, lambda: read_button(page, "undo") == ("false", ""))
    page.click("#undo")
    wait_on(page, lambda: read_button(page, "undo") == ("true", WORDS["undo"]))


def test_a_hand_that_presses_twice_undoes_once(view, folder, open_page):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    path.write_text(PROFILE)
    page = open_page(view.link)
    page.wait_for_selector("#editor:not([hidden])")
    texts = [path.read_text()]
    for _ in range(2):
        page.click("#mark-more")
        wait_on(page, lambda: path.read_text() != texts[-1])
        texts.append(path.read_text())
    wait_on(page, lambda: read_button(page, "undo") == ("false", ""))
    page.dblclick("#undo")
    wait_for(page, "live", "Pressed twice at once: only one change is undone.")
    wait_on(page, lambda: path.read_text() == texts[1])
    page.wait_for_timeout(600)
    assert path.read_text() == texts[1]
    page.click("#undo")
    wait_on(page, lambda: path.read_text() == texts[0])
