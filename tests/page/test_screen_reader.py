"""What a screen reader gets of the dialogs: roles, names and states by Chromium's accessibility
tree, and what the live regions announce, in their order.

Pages close before their server ends, so a test names `open_page` after the server.
"""

import pytest

from tests.page.conftest import PROFILE
from tests.page.waiting import rest_hand, wait_for, wait_on

LISTEN = """() => {
    window.heard = [];
    const regions = '[role=status], [role=alert], [aria-live]';
    new MutationObserver((changes) => {
        for (const { target } of changes) {
            const element = target.nodeType === 1 ? target : target.parentElement;
            const region = element && element.closest(regions);
            const text = region && region.textContent.trim();
            if (text && region.checkVisibility() && text !== window.heard.at(-1)) {
                window.heard.push(text);
            }
        }
    }).observe(document, { childList: true, characterData: true, subtree: true });
}"""


class Reader:
    """Reads a page as a screen reader does: it sees no pixel and no class."""

    def __init__(self, page) -> None:
        self.page = page
        self._session = page.context.new_cdp_session(page)
        page.evaluate(LISTEN)

    def read(self) -> list[tuple[str, str]]:
        """Role and name of everything that is not hidden from it, in the order of the page."""
        nodes = self._session.send("Accessibility.getFullAXTree")["nodes"]
        return [
            (node["role"]["value"], node.get("name", {}).get("value", ""))
            for node in nodes
            if not node["ignored"]
        ]

    def find(self, role: str) -> list[str]:
        return [name for found, name in self.read() if found == role]

    def focus(self) -> tuple[str, str]:
        nodes = self._session.send("Accessibility.getFullAXTree")["nodes"]
        for node in reversed(nodes):
            states = {
                each["name"]: each["value"].get("value") for each in node.get("properties", ())
            }
            if states.get("focused"):
                return node["role"]["value"], node["name"]["value"]
        raise AssertionError("nothing has the focus")

    def wait_to_hear(self, words: str) -> None:
        wait_on(self.page, lambda: any(words in text for text in self.heard()))

    def heard(self) -> list[str]:
        return self.page.evaluate("() => window.heard")

    def forget(self) -> None:
        self.page.evaluate("() => { window.heard = []; }")


@pytest.fixture
def own(folder):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    path.write_text(PROFILE)
    yield path
    path.write_text(PROFILE)


def test_bind_by_doing_is_a_dialog_with_names_and_says_what_it_is_for(view, own, open_page):
    page = open_page(view.home)
    page.wait_for_selector("#by-doing:not([hidden])")
    reader = Reader(page)
    page.locator("#by-doing").press("Enter")
    reader.wait_to_hear("Make the movement on the gel, and lift your fingers.")
    reader.wait_to_hear("Paused: everything is released.")
    page.wait_for_selector("#chooser[open]")
    title = page.text_content("#chooser-title")
    reader.wait_to_hear(title.replace(" does …", ": choose what it does."))
    assert reader.find("dialog") == [title]
    boxes = reader.find("combobox")  # those of the page behind are hidden while it is open
    assert [name for name in boxes if name] == ["When", "In place of", "From the list"]
    assert "Make a movement to change it" not in reader.find("button")
    assert all(reader.find("button")), "a button has no name"
    assert {"A", "B", "X", "Y", "Cancel"} <= set(reader.find("button"))
    assert reader.focus()[0] in ("combobox", "dialog", "button")
    reader.forget()
    page.locator("#outputs button:text-is('Y')").press("Enter")
    reader.wait_to_hear("It applies now.")
    reader.wait_to_hear("Running.")
    assert reader.find("dialog") == []

    reader.forget()
    page.locator("#undo").press("Enter")
    reader.wait_to_hear("mine is as before that change.")
    assert own.read_text() == PROFILE
    assert reader.focus() == ("button", "Undo")


def test_pause_says_its_state_and_its_button_changes_its_name(view, own, open_page):
    page = open_page(view.home)
    wait_for(page, "driver-state", "Running")
    reader = Reader(page)
    page.locator("#pause-resume").focus()
    assert reader.focus() == ("button", "Pause")
    page.keyboard.press("Enter")
    reader.wait_to_hear("Paused: everything is released.")
    wait_on(page, lambda: reader.focus() == ("button", "Resume"))
    reader.forget()
    rest_hand(page)
    page.keyboard.press("p")
    reader.wait_to_hear("Running.")
    wait_on(page, lambda: reader.focus() == ("button", "Pause"))


def test_a_calibration_says_each_step_and_loses_no_focus(view, own, open_page):
    page = open_page(view.home)
    page.wait_for_selector("#by-doing:not([hidden])")
    page.wait_for_selector("#measure:not([disabled])")
    reader = Reader(page)
    page.locator("#measure").press("Enter")
    reader.wait_to_hear("1 of 10: Rest your hand")
    assert reader.focus() == ("button", "Next")
    answers = {"Next", "I cannot do this", "Back", "Begin again", "Stop, save nothing"}
    assert answers <= set(reader.find("button"))
    for step in range(2, 4):
        page.keyboard.press("Enter")
        reader.wait_to_hear(f"{step} of 10: ")
        assert reader.focus() == ("button", "Next")
    reader.wait_to_hear("3 of 10: Push to the left, as far as is comfortable")
    page.locator("[data-answer=q]").press("Enter")
    reader.wait_to_hear("Ended. Nothing was saved.")
    wait_on(page, lambda: reader.focus() == ("button", "Measure my range again"))
    reader.wait_to_hear("Running.")
    steps = [text for text in reader.heard() if " of 10: " in text]
    assert [text.split()[0] for text in steps] == ["1", "2", "3"]


def test_what_moves_all_the_time_is_no_live_region(view, own, open_page):
    """The sentence of the gel, the numbers and the marks change thirty times a second."""
    page = open_page(view.page("live"))
    wait_for(page, "driver-state", "Running")
    reader = Reader(page)
    page.select_option("#spoken", "none", force=True)
    reader.forget()
    page.wait_for_timeout(2000)
    assert reader.heard() == []


def test_the_gel_takes_the_keys_of_a_reader_and_is_no_end_of_the_page(bare, view, open_page):
    """Orca passes keys on only if the focused element is an application itself, and goes back to
    the top of the page behind an application in which nothing is shown."""
    page = open_page(bare.page("gel"))
    page.focus("#gel")
    role, name = Reader(page).focus()
    assert role == "application"
    assert name.startswith("The gel: press it with mouse or fingers, or with the arrow keys")
    for home in (bare.home, view.home):
        page = open_page(home)
        page.wait_for_selector("#cards:not([hidden])")
        assert Reader(page).find("application") == []


def test_a_list_that_is_told_again_keeps_its_options(view, own, open_page):
    """Orca takes new options for the person's choice: it says the list, and reads on from there."""
    page = open_page(view.home)
    page.wait_for_selector("#cards:not([hidden])")
    options = "[...document.querySelectorAll('#profile-choice option')]"
    page.wait_for_function(f"() => {options}.length > 1")
    page.evaluate(f"() => {{ window.before = {options}; }}")
    page.click("[aria-label^='Remove pinch']")
    wait_for(page, "saved", "It applies now.")
    page.wait_for_function("() => !document.querySelector('#undo[aria-disabled=true]')")
    page.select_option("#profile-choice", "racing")  # one message later, so the list has come too
    wait_for(page, "plays", "Below is what racing does")
    assert page.evaluate(f"() => window.before.every((each, i) => each === {options}[i])")


def test_no_old_sentence_is_left_to_be_read_again(view, own, open_page):
    """A reader reads live regions again when a dialog closes: 'Removed' after a mere look."""
    page = open_page(view.home)
    page.wait_for_selector("#cards:not([hidden])")
    reader = Reader(page)
    page.click("[aria-label^='Remove pinch']")
    reader.wait_to_hear("It applies now.")
    said = """() => [...document.querySelectorAll('[role=status], [role=alert], [aria-live]')]
        .filter((each) => each.checkVisibility() && each.ariaLive !== 'off')
        .map((each) => each.textContent).join('')"""
    wait_on(page, lambda: page.evaluate(said) == "")
    assert "It applies now." in page.text_content("#saved")
