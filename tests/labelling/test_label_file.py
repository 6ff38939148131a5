"""A person's labels on disk."""

from pathlib import Path

import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.labelling.label_file import LabelFile, find_label_file
from neurotouch_hid.messages import GestureKind, Truth
from neurotouch_hid.recording import read_labels, write_labels
from neurotouch_hid.source.view import View
from tests.labelling.made import make_moments

NOTHING = np.zeros((0, 2))
KINDS = [0, 1, 1, 2, 0]
CONTACTS = [[], [(10.0, 20.0)], [(11.0, 20.0)], [(1.0, 2.0), (3.0, 4.0)], []]


@pytest.fixture
def moments():
    return make_moments(KINDS, CONTACTS)


def test_the_names_of_the_files():
    assert find_label_file(Path("a/b.c.aedat4"), None) == Path("a/b.c.labels.csv")
    assert find_label_file(Path("a/b.mkv"), "anna") == Path("a/b.anna.labels.csv")


def test_what_is_written_is_read_again(tmp_path, moments):
    path = tmp_path / "a.labels.csv"
    LabelFile(path, moments).write(moments.proposals)
    again = LabelFile(path, moments).read()
    np.testing.assert_array_equal(again.kind, KINDS)
    np.testing.assert_allclose(again.contacts_px, moments.proposals.contacts_px, atol=1e-3)
    assert [truth.t_us for truth in read_labels(path)] == moments.t_us.tolist()


def test_labels_keep_their_stamps_and_strangers_stay(tmp_path, moments):
    """One is stamped with the begin of an exposure; one belongs to no moment."""
    path = tmp_path / "a.labels.csv"
    write_labels(
        path,
        [
            Truth(42_000, GestureKind.PUSH, np.array([[5.0, 5.0]]), 1.0),
            Truth(900_000, GestureKind.ZOOM, np.array([[6.0, 6.0]]), 3.0),
        ],
    )
    file = LabelFile(path, moments)
    track = file.read()
    assert track.kind.tolist() == [-1, 1, -1, -1, -1]
    track.set(3, GestureKind.NONE, 0.0, NOTHING)
    file.write(track)
    assert [(truth.t_us, truth.kind) for truth in read_labels(path)] == [
        (42_000, GestureKind.PUSH),
        (125_000, GestureKind.NONE),
        (900_000, GestureKind.ZOOM),
    ]


def test_labels_of_a_video_are_pixels_of_its_own_pictures(tmp_path):
    view = View(640, 480, (319.5, 239.5), 0.5, rotation_rad=0.3, mirrored=True)
    moments = make_moments(KINDS, CONTACTS, view=view)
    path = tmp_path / "a.labels.csv"
    LabelFile(path, moments).write(moments.proposals)
    truths = read_labels(path, (640, 480))
    np.testing.assert_allclose(view.to_canonical(truths[1].contacts_px), [[10.0, 20.0]], atol=0.01)
    again = LabelFile(path, moments).read()
    np.testing.assert_allclose(again.contacts_px, moments.proposals.contacts_px, atol=0.01)


def test_what_another_program_has_written_is_not_replaced(tmp_path, moments):
    path = tmp_path / "a.labels.csv"
    file = LabelFile(path, moments)
    file.write(moments.proposals)
    write_labels(path, [Truth(5_000, GestureKind.ZOOM, np.array([[6.0, 6.0]]), 3.0)])
    with pytest.raises(RecordingError, match="Another program has changed"):
        file.write(moments.proposals)
    assert len(read_labels(path)) == 1


def test_a_file_that_appears_is_not_replaced_either(tmp_path, moments):
    path = tmp_path / "a.labels.csv"
    file = LabelFile(path, moments)
    path.write_text("mine\n")
    with pytest.raises(RecordingError, match="Another program has changed"):
        file.write(moments.proposals)
    assert path.read_text() == "mine\n"
