"""What a person can do with labels, and that each change can be taken back."""

import numpy as np
import pytest

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.labelling.sheet import Sheet
from neurotouch_hid.labelling.track import UNLABELLED, Run
from neurotouch_hid.messages import GestureKind
from tests.labelling.made import make_moments

PUSH, PINCH = GestureKind.PUSH, GestureKind.PINCH


@pytest.fixture
def sheet():
    """Ten moments: rest, and a proposed push with one contact from the third to the seventh."""
    kinds = [0, 0, 1, 1, 1, 1, 1, 0, 0, 0]
    contacts = [[(100.0 + k, 50.0)] if kind else [] for k, kind in enumerate(kinds)]
    return Sheet(make_moments(kinds, contacts))


def test_confirmed_moments_are_as_proposed(sheet):
    sheet.accept(2, 6)
    assert sheet.labels.kind.tolist() == [-1, -1, 1, 1, 1, 1, 1, -1, -1, -1]
    assert sheet.labels.points(3).tolist() == [[103.0, 50.0]]
    assert sheet.labels.intensity_mm[3] == 2.0


def test_all_that_is_left_leaves_labels_alone(sheet):
    sheet.set_kind(2, 6, PINCH)
    sheet.accept_rest()
    assert sheet.labels.kind.tolist() == [0, 0, 2, 2, 2, 2, 2, 0, 0, 0]


def test_a_gesture_that_nobody_proposed_is_where_the_gel_moves_most(sheet):
    sheet.set_kind(8, 8, PUSH)
    assert sheet.labels.points(8).tolist() == [[10.0, 20.0]]
    assert sheet.labels.intensity_mm[8] == 0.5


def test_no_gesture_has_neither_contacts_nor_intensity(sheet):
    sheet.set_kind(3, 4, GestureKind.NONE)
    assert sheet.labels.counts[3:5].tolist() == [0, 0]
    assert sheet.labels.intensity_mm[3:5].tolist() == [0.0, 0.0]


def test_a_contact_takes_those_of_its_gesture_along(sheet):
    sheet.move_contact(4, 0, 114.0, 53.0)
    assert sheet.labels.kind.tolist() == [-1, -1, 1, 1, 1, 1, 1, -1, -1, -1]
    expected = [[112.0 + k, 53.0] for k in range(5)]
    assert sheet.labels.contacts_px[2:7, 0].tolist() == expected


def test_a_contact_in_its_place_stays_there(sheet):
    sheet.move_contact(2, 0, 112.0, 50.0)
    sheet.move_contact(6, 0, 106.0, 50.0)  # now 116, so 10 back
    shifts = sheet.labels.contacts_px[2:7, 0, 0] - [102, 103, 104, 105, 106]
    np.testing.assert_allclose(shifts, [10.0, 7.5, 5.0, 2.5, 0.0], atol=1e-4)


def test_contacts_that_change_places_are_followed():
    two = [[(10.0, 10.0), (90.0, 10.0)], [(90.0, 10.0), (11.0, 10.0)]]
    sheet = Sheet(make_moments([2, 2], two))
    sheet.move_contact(0, 0, 15.0, 10.0)
    assert sheet.labels.points(1).tolist() == [[90.0, 10.0], [16.0, 10.0]]


def test_contacts_come_and_go_in_the_whole_gesture(sheet):
    sheet.add_contact(4, 200.0, 60.0)
    assert sheet.labels.counts.tolist() == [0, 0, 2, 2, 2, 2, 2, 0, 0, 0]
    sheet.remove_contact(3, 0)
    assert sheet.labels.points(5).tolist() == [[200.0, 60.0]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda sheet: sheet.remove_contact(4, 0), "choose No gesture"),
        (lambda sheet: sheet.remove_contact(4, 1), "no such contact"),
        (lambda sheet: sheet.move_contact(4, -1, 0.0, 0.0), "no such contact"),
        (lambda sheet: sheet.move_contact(0, 0, 0.0, 0.0), "no such contact"),
        (lambda sheet: sheet.add_contact(0, 0.0, 0.0), "Choose its type first"),
        (lambda sheet: sheet.add_contact(10, 0.0, 0.0), "no such moment"),
        (lambda sheet: sheet.accept(3, 2), "no such moment"),
        (lambda sheet: sheet.set_kind(-1, 2, PUSH), "no such moment"),
        (lambda sheet: sheet.clear(0, 10), "no such moment"),
        (lambda sheet: sheet.undo(), "nothing to undo"),
        (lambda sheet: sheet.redo(), "nothing to redo"),
    ],
)
def test_what_cannot_be_done_changes_nothing(sheet, change, words):
    with pytest.raises(NeuroTouchError, match=words):
        change(sheet)
    assert (sheet.labels.kind == UNLABELLED).all()
    assert not sheet.can_undo


def test_a_gesture_has_at_most_three_contacts(sheet):
    sheet.add_contact(4, 1.0, 1.0)
    sheet.add_contact(4, 2.0, 2.0)
    with pytest.raises(NeuroTouchError, match="at most 3"):
        sheet.add_contact(4, 3.0, 3.0)


def test_every_change_is_undone_and_done_again(sheet):
    changes = [
        lambda: sheet.accept(0, 4),
        lambda: sheet.set_kind(3, 8, PINCH),
        lambda: sheet.move_contact(5, 0, 120.0, 60.0),
        lambda: sheet.add_contact(5, 20.0, 20.0),
        lambda: sheet.remove_contact(5, 0),
        lambda: sheet.clear(1, 5),
        sheet.accept_rest,
    ]
    states = [sheet.labels.part(0, 9)]
    for change in changes:
        change()
        states.append(sheet.labels.part(0, 9))
    for state in reversed(states[:-1]):
        sheet.undo()
        same(sheet.labels, state)
    for state in states[1:]:
        sheet.redo()
        same(sheet.labels, state)
    assert not sheet.can_redo


def same(labels, state) -> None:
    np.testing.assert_array_equal(labels.kind, state.kind)
    np.testing.assert_array_equal(labels.intensity_mm, state.intensity_mm)
    np.testing.assert_array_equal(labels.contacts_px, state.contacts_px)


def test_runs_cover_everything(sheet):
    assert list(sheet._moments.proposals.runs()) == [Run(0, 1, 0), Run(2, 6, 1), Run(7, 9, 0)]
