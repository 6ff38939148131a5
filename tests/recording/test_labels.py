"""Labels are written and read without loss; wrong ones are named by line and column."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import GestureKind, Truth
from neurotouch_hid.recording import check_labelled, labels_path, read_labels, write_labels

HEADER = "timestamp_us,gesture,intensity_mm,contacts,x1_px,y1_px,x2_px,y2_px,x3_px,y3_px"
millimetres = st.integers(0, 40_000).map(lambda n: n / 1000)
pixels = st.integers(0, 259_000).map(lambda n: n / 1000)
contacts = st.lists(st.tuples(pixels, pixels), max_size=3).map(lambda p: np.reshape(p, (-1, 2)))
truths = st.lists(
    st.builds(
        Truth, st.integers(-(2**60), 2**60), st.sampled_from(GestureKind), contacts, millimetres
    ),
    min_size=1,
    max_size=20,
    unique_by=lambda truth: truth.t_us,
).map(lambda some: sorted(some, key=lambda truth: truth.t_us))


@given(truths)
def test_written_is_read_again(tmp_path_factory, some):
    path = tmp_path_factory.getbasetemp() / "a.labels.csv"
    write_labels(path, some)
    again = read_labels(path)
    assert len(again) == len(some)
    for one, other in zip(some, again, strict=True):
        assert (one.t_us, one.kind, one.intensity_mm) == (
            other.t_us,
            other.kind,
            other.intensity_mm,
        )
        assert np.array_equal(one.contacts_px, other.contacts_px)
        assert other.markers_px is None


def test_the_file_is_as_documented(tmp_path):
    path = labels_path(tmp_path / "take.1.aedat4")
    assert path.name == "take.1.labels.csv"
    write_labels(path, [Truth(5, GestureKind.TWIST_CW, np.array([[1.0, 2.5]]), 0.25)])
    assert path.read_text() == f"{HEADER}\n5,twist_cw,0.250,1,1.000,2.500,,,,\n"
    assert list(tmp_path.iterdir()) == [path]


def test_a_truth_that_cannot_be_said_leaves_nothing(tmp_path):
    with pytest.raises(RecordingError, match="at most 3 contacts"):
        write_labels(tmp_path / "a.csv", [Truth(5, GestureKind.PUSH, np.zeros((4, 2)), 0.0)])
    assert list(tmp_path.iterdir()) == []


def test_a_spreadsheet_may_have_saved_it(tmp_path):
    path = tmp_path / "a.labels.csv"
    text = f"\ufeff{HEADER}\n5, push ,1,1,10,20,,,,\n\n6,none,0,0,,,,,,\n"
    path.write_text(text.replace("\n", "\r\n"), encoding="utf-8", newline="")
    assert [truth.kind for truth in read_labels(path)] == [GestureKind.PUSH, GestureKind.NONE]


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("5,psuh,1,1,1,2,,,,", "2: column gesture: expected one of none push pinch zoom twist_cw "
         "twist_ccw (did you mean push?), found 'psuh'"),
        ("5,dance,1,1,1,2,,,,", "twist_ccw, found 'dance'"),
        ("5.5,push,1,1,1,2,,,,", "2: column timestamp_us: expected a whole number of microseconds"),
        ("5,push,,1,1,2,,,,", "expected a number of millimetres from 0 to 100, found nothing"),
        ("5,push,1e308,1,1,2,,,,", "millimetres from 0 to 100, found '1e308'"),
        ("5,push,1_0,1,1,2,,,,", "millimetres from 0 to 100, found '1_0'"),
        ("1_0,push,1,1,1,2,,,,", "whole number of microseconds, found '1_0'"),
        ("٣,push,1,1,1,2,,,,", "whole number of microseconds, found '٣'"),
        (f"1{'0' * 30},push,1,1,1,2,,,,", "whole number of microseconds, found '1000"),
        ("9000000000000000000,push,1,1,1,2,,,,", "a time that a recording can have"),
        ("5,push,nan,1,1,2,,,,", "found 'nan'"),
        ("5,push,-1,1,1,2,,,,", "found '-1'"),
        ("5,push,1,4,1,2,,,,", "column contacts: expected a whole number from 0 to 3, found '4'"),
        ("5,push,1,2,1,2,,,,", "column x2_px: expected a number of pixels, found nothing"),
        ("5,push,1,1,1,2,3,4,,", "column x2_px: expected nothing, since contacts is 1, found '3'"),
        ("5,push,1,1,1,9000,,,,", "column y1_px: expected a pixel in or near the picture"),
        ("5,push,1,1,1,inf,,,,", "column y1_px: expected a number of pixels, found 'inf'"),
        ("5,push,1,1,1,2", "2: expected 10 columns, found 6"),
        ("5,none,0,0,,,,,,\n5,none,0,0,,,,,,", "3: column timestamp_us: expected a time after the "
         "row before (5), found '5'"),
        ('5,none,0,0,,,,,,\n6,"push,1,1,1,2,,,,\n7,none,0,0,,,,,,', ":3: a quotation mark is"),
        ('5,"push"x,1,1,1,2,,,,', ":2: a quotation mark is missing, or one is too many."),
        ("", " has no labels"),
    ],
)  # fmt: skip
def test_wrong_rows(tmp_path, rows, words):
    path = tmp_path / "a.labels.csv"
    path.write_text(f"{HEADER}\n{rows}\n")
    with pytest.raises(RecordingError) as caught:
        read_labels(path)
    assert caught.value.message.lstrip("'").startswith(str(path))
    assert words in caught.value.message


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("", "1: column timestamp_us is missing"),
        (HEADER.replace("contacts,", ""), "1: column contacts is missing"),
        (HEADER.replace(",", ";"), "1: the columns are separated by semicolons, not by commas"),
        (HEADER.replace(",", "\t"), "1: the columns are separated by tabs, not by commas"),
        (HEADER + ",note", "1: unknown column 'note'"),
        (HEADER + ",", "1: column 11 has no name"),
        (HEADER.replace("gesture,intensity_mm", "intensity_mm,gesture"), "another order"),
    ],
)
def test_wrong_columns(tmp_path, header, words):
    (tmp_path / "a.labels.csv").write_text(header)
    with pytest.raises(RecordingError, match=words) as caught:
        read_labels(tmp_path / "a.labels.csv")
    assert HEADER in (caught.value.hint or "")


def test_missing_and_not_text(tmp_path):
    with pytest.raises(RecordingError, match="There is no file"):
        read_labels(tmp_path / "a.labels.csv")
    (tmp_path / "b.labels.csv").write_bytes(b"\xff\xfe\x00" * 10)
    with pytest.raises(RecordingError, match="is not UTF-8 text") as caught:
        read_labels(tmp_path / "b.labels.csv")
    assert caught.value.hint == "Save it again as CSV in UTF-8."


@pytest.mark.parametrize(
    ("names", "proposed"),
    [
        ((), "*.aedat4"),
        (("a.mkv", "b.mkv"), "*.mkv"),
        (("a.mp4", "b.aedat4"), "*.aedat4 {}/*.mp4"),
    ],
)
def test_of_a_folder_what_is_in_it_is_proposed(tmp_path, names, proposed):
    for name in names:
        (tmp_path / name).touch()
    with pytest.raises(RecordingError) as caught:
        check_labelled([tmp_path])
    assert caught.value.hint == f"Give its recordings: {tmp_path}/{proposed.format(tmp_path)}"
