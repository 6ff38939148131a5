"""A person labels a recording at the page, in time, and nothing is lost.

The recording is simulated, so the truth is known. The person sees it, as a person sees the picture,
and corrects types that differ in more than one picture, and contacts that are visibly off.
"""

import json
import re
import shutil
import signal
from functools import partial

import numpy as np
import pytest

from neurotouch_hid.evaluation.accuracy.label_track import pair_points
from neurotouch_hid.labelling.label_file import LabelFile
from neurotouch_hid.labelling.look_through import Pictures, look_through
from neurotouch_hid.recording import read_labels
from tests.labelling.recordings import write_recording
from tests.page.test_layout import check_rules
from tests.page.waiting import wait_for, wait_on
from tests.processes import Process

SECONDS = 20
KEY_S, THOUGHT_S, DRAG_S = 0.28, 1.35, 1.1 + 0.1 + 0.45 + 0.1
"""The keystroke-level model of Card, Moran and Newell (1980): one key, the thought before it, and
pointing, pressing, dragging, releasing. The same key again needs no new thought. A drag of 10 px to
a millimetre, 7 px wide, is as MacKenzie, Sellen and Buxton (1991) measured with a mouse."""


VISIBLE_MM = 1.5
"""Nobody sees better than this where under a fingertip the contact is."""
SHOWN = """() => document.getElementById('picture').alt.includes(
    `${document.getElementById('moment').textContent.split(' ')[0]} seconds`)"""


class Label(Process):
    """``neurotouch label``."""

    def __init__(self, folder, *arguments):
        command = ("label", str(folder / "play.aedat4"), "--port", "0", *arguments)
        super().__init__(folder, *command, ready="Each change is saved: ")
        self.link = re.search(r"Label here: (\S+)", self.said)[1]


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """A folder with a recording, what ``label`` makes of it, and its truth."""
    folder = tmp_path_factory.mktemp("label")
    write_recording(folder / "play.aedat4", SECONDS, 5)
    with Pictures() as pictures:
        moments = look_through(folder / "play.aedat4", pictures)
    truth = LabelFile(folder / "play.truth.labels.csv", moments).read()
    return folder, moments, truth


@pytest.fixture
def label(played, tmp_path):
    """The page's server, with labels of its own."""
    for path in played[0].glob("play.*"):
        shutil.copy(path, tmp_path)
    running = Label(tmp_path, "--as", "anna", "--beside", "truth")
    yield running
    running.end()


class Person:
    """Labels, and counts the time."""

    def __init__(self, page, moments, truth):
        self.page, self.truth, self.px_per_mm = page, truth, moments.px_per_mm
        self.labels = moments.proposals.part(0, len(moments) - 1)  # as the page shows them
        self.at, self.before, self.time_s = 0, "", 0.0

    def press(self, key):
        self.time_s += KEY_S + (THOUGHT_S if key != self.before else 0.0)
        self.before = key
        self.page.keyboard.press(key)

    def go(self, k):
        if len(self.truth.kind) - k < abs(k - self.at):
            self.press("End")
            self.at = len(self.truth.kind) - 1
        while self.at != k:
            way = "Right" if k > self.at else "Left"
            far = abs(k - self.at) >= 10
            self.press(f"Shift+Arrow{way}" if far else f"Arrow{way}")
            self.at += (1 if way == "Right" else -1) * (10 if far else 1)

    def change(self, act):
        """Does what changes something, and waits until it is saved."""
        self.page.evaluate("() => { document.getElementById('saved').textContent = ''; }")
        act()
        wait_for(self.page, "saved", "Saved")

    def correct_types(self):
        self.at = int(self.page.get_attribute("#time", "aria-valuenow"))
        for run in self.truth.runs():
            inside = slice(run.first, run.last + 1)
            wrong = run.first + np.flatnonzero(self.labels.kind[inside] != run.kind)
            for part in np.split(wrong, np.flatnonzero(np.diff(wrong) > 1) + 1):
                if len(part) > 1:  # one picture more or less: nobody sees that
                    self.go(int(part[0]))
                    self.press("[")
                    self.go(int(part[-1]))
                    self.press("]")
                    self.change(partial(self.press, str(run.kind)))

    def correct_gestures(self, t_us):
        """Goes from gesture to gesture, and drags their ends and contacts to their places."""
        before = None
        while True:
            self.press("g")
            if "No further gesture" in self.page.text_content("#why"):
                return
            k = int(self.page.get_attribute("#time", "aria-valuenow"))
            assert k != before
            before = k
            self.page.wait_for_function(SHOWN)
            self.correct_ends(k, t_us)
            true = self.truth.points(k)
            contacts = self.page.locator("#contacts button")
            places = np.array([self.read_place(button) for button in contacts.all()])
            for i, j in zip(*pair_points(places, true), strict=True):
                if np.linalg.norm(true[j] - places[i]) > VISIBLE_MM * self.px_per_mm:
                    self.change(partial(self.drag_contact, contacts.nth(i), true[j]))

    def correct_ends(self, k, t_us):
        """Drags the ends of a gesture along the time. They are where the label's type changes."""
        mine, true = self.labels.run_at(k), self.truth.run_at(k)
        wide_us = 12_000_000
        from_us = max(t_us[0], min(t_us[k] - wide_us / 2, t_us[-1] - wide_us))
        for at, to in ((mine.first, true.first), (mine.last + 1, true.last + 1)):
            if abs(to - at) > 1 and 0 < at < len(t_us) and 0 < to < len(t_us):
                box = self.page.locator("#near").bounding_box()
                x, to_x = (
                    box["x"] + (float(t_us[m]) - from_us) / wide_us * box["width"] for m in (at, to)
                )
                y = box["y"] + 68
                self.change(partial(self.drag, (x, y), (to_x, y)))
                self.labels.put(min(at, to), self.truth.part(min(at, to), max(at, to) - 1))

    def read_place(self, button):
        words = re.search(r", (-?\d+), (-?\d+) px", button.get_attribute("aria-label"))
        return [float(words[1]), float(words[2])]

    def drag_contact(self, button, place):
        box, stage = button.bounding_box(), self.page.locator("#stage").bounding_box()
        x, y = ((float(value) + 0.5) * stage["width"] / 346 for value in place)
        middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.drag(middle, (stage["x"] + x, stage["y"] + y))

    def drag(self, begin, end):
        self.time_s += DRAG_S
        self.before = ""
        self.page.mouse.move(*begin)
        self.page.mouse.down()
        self.page.mouse.move(*end, steps=3)
        self.page.mouse.up()


def test_a_minute_takes_at_most_four_and_agrees_with_the_truth(label, open_page, played):
    _, moments, truth = played
    page = open_page(label.link)
    wait_for(page, "progress", "0 %")
    assert page.text_content("#recording") == "SIMULATED: play.aedat4 → play.anna.labels.csv"
    person = Person(page, moments, truth)
    person.change(lambda: person.press("a"))
    person.correct_gestures(moments.t_us)
    person.correct_types()
    assert SECONDS + person.time_s < 4 * SECONDS  # watched once, then corrected

    found = json.loads(
        label.call(
            *("label", str(label.folder / "play.aedat4"), "--as", "anna", "--beside", "truth"),
            *("--agreement", "--json"),
        ).stdout
    )
    assert found["n_moments"] == len(moments)
    assert found["same_type"] >= 0.98
    assert found["kappa"] >= 0.97
    assert found["contact_mm"] <= 1.0


def test_nothing_is_lost_when_the_program_is_killed(label, open_page):
    page = open_page(label.link)
    wait_for(page, "progress", "0 %")
    page.keyboard.press("a")
    wait_for(page, "saved", "Saved")
    page.keyboard.press("4")
    wait_for(page, "what", "Clockwise twist, 1 contact, confirmed")
    wait_for(page, "saved", "Saved")
    page.goto("about:blank")
    label.process.send_signal(signal.SIGKILL)
    label.process.wait()
    labels = read_labels(label.folder / "play.anna.labels.csv")
    assert len(labels) >= 25 * SECONDS - 2
    assert labels[0].kind.label == "twist_cw"

    again = Label(label.folder, "--as", "anna")
    try:
        page = open_page(again.link)
        wait_for(page, "progress", "100 %")
        wait_for(page, "what", "Clockwise twist, 1 contact, confirmed")
        page.goto("about:blank")
    finally:
        again.end()


def test_doubts_differences_undo_and_the_mouse(label, open_page):
    page = open_page(label.link)
    wait_for(page, "progress", "0 %")
    check_rules(page, "at the begin")
    page.keyboard.press("d")
    wait_for(page, "why", "Doubt: ")
    assert "proposed" in page.text_content("#what")
    page.keyboard.press("Enter")
    wait_for(page, "what", "confirmed")
    page.click("#undo")
    wait_for(page, "what", "proposed")
    page.click("#redo")
    wait_for(page, "what", "confirmed")
    wait_for(page, "agreement", "same type")
    page.click("#types button:nth-child(3)")
    wait_for(page, "what", "Pinch")
    wait_for(page, "saved", "Saved")
    contact = page.locator("#contacts button").first
    before = contact.get_attribute("aria-label")
    box = contact.bounding_box()
    page.mouse.move(box["x"] + 10, box["y"] + 10)
    page.mouse.down()
    page.mouse.move(box["x"] + 60, box["y"] + 40, steps=4)
    page.mouse.up()
    wait_on(page, lambda: contact.get_attribute("aria-label") != before)
    wait_for(page, "saved", "Saved")
    n = int(re.search(r"(\d) contact", page.text_content("#what"))[1])
    contact.focus()
    page.keyboard.press("Delete")
    wait_for(page, "what", f"{n - 1} contact")
    page.locator("#stage").dblclick(position={"x": 60, "y": 60})
    wait_for(page, "what", f"{n} contacts")
    page.set_viewport_size({"width": 400, "height": 900})
    check_rules(page, "on a small screen")


def test_what_another_program_wrote_is_kept(label, open_page):
    page = open_page(label.link)
    wait_for(page, "progress", "0 %")
    file = label.folder / "play.anna.labels.csv"
    shutil.copy(label.folder / "play.truth.labels.csv", file)
    page.keyboard.press("a")
    wait_for(page, "notice", "Another program has changed")
    assert file.read_text() == (label.folder / "play.truth.labels.csv").read_text()
    assert page.text_content("#saved") != "Saved"
