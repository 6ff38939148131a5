"""The labels beside a recording: one CSV row for each labelled moment."""

import csv
import difflib
import errno
import io
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.files.faults import SHOWN_COLUMNS
from neurotouch_hid.files.small_file import read_text, suggest_reading
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, GestureKind, Truth
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.printable import make_printable
from neurotouch_hid.recording.check import check_recording
from neurotouch_hid.vocabulary import RECORDING_ENDINGS

if TYPE_CHECKING:
    import _csv

MAX_LABELS_BYTES = 16 << 20
"""An hour of labels at 60 Hz."""
MAX_INTENSITY_MM = 100
"""Wider than the gel."""
MAX_STAMP_US = 1 << 62
"""Differences of smaller stamps fit 64 bits."""
MAX_CONTACTS = 3
POINT_COLUMNS = tuple(f"{axis}{i}_px" for i in range(1, MAX_CONTACTS + 1) for axis in "xy")
COLUMNS = ("timestamp_us", "gesture", "intensity_mm", "contacts", *POINT_COLUMNS)
_KINDS = {kind.label: kind for kind in GestureKind}
_INTEGER = re.compile(r"[-+]?[0-9]{1,19}")
_NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}
_DECIMALS = 3  # a thousandth of a pixel or millimetre


def labels_path(recording: Path | str) -> Path:
    """Returns the path of a recording's labels: ``NAME.labels.csv`` beside ``NAME.aedat4``."""
    return Path(recording).with_suffix(".labels.csv")


def write_labels(path: Path | str, truths: Iterable[Truth]) -> None:
    """Writes labels, complete or not at all.

    Args:
        path: the CSV file; an existing one is replaced.
        truths: one for each labelled moment, in order of time; marker positions are not written.

    Raises:
        RecordingError: the file cannot be written, or a truth cannot be said in a row.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(_row(truth) for truth in truths)
    try:
        write_whole(Path(path), text.getvalue().encode())
    except OSError as error:
        raise RecordingError.of_writing(Path(path), error) from error


def _row(truth: Truth) -> list[str]:
    points = np.asarray(truth.contacts_px, np.float64).reshape(-1)
    if len(points) > len(POINT_COLUMNS):
        raise RecordingError(
            f"A label has at most {MAX_CONTACTS} contacts, not {len(points) // 2}."
        )
    numbers = [f"{value:.{_DECIMALS}f}" for value in points]
    return [
        str(truth.t_us),
        truth.kind.label,
        f"{truth.intensity_mm:.{_DECIMALS}f}",
        str(len(points) // 2),
        *numbers,
        *[""] * (len(POINT_COLUMNS) - len(numbers)),
    ]


def check_labelled(recordings: Iterable[Path]) -> None:
    """Checks that each recording is there, with its labels beside it.

    Raises:
        RecordingError: one is missing, or is no recording.
    """
    for path in recordings:
        if path.is_dir():
            there = [each for each in RECORDING_ENDINGS if any(path.glob(f"*{each}"))]
            hint = " ".join(f"{path}/*{each}" for each in there or RECORDING_ENDINGS[:1])
            raise RecordingError(f"'{path}' is a folder.", hint=f"Give its recordings: {hint}")
        check_recording(path)
        if not labels_path(path).exists():
            raise _refuse_unlabelled(labels_path(path))


def _refuse_unlabelled(path: Path) -> RecordingError:
    return RecordingError(
        f"There is no file '{path}'.",
        hint="Labels belong beside their recording, as NAME.labels.csv. "
        "To make them: neurotouch label FILE",
    )


def read_labels(path: Path | str, size_px: tuple[int, int] | None = None) -> list[Truth]:
    """Returns the labels of a recording, ascending in time; ``markers_px`` is None.

    Args:
        path: the CSV file.
        size_px: width and height of the pictures whose pixels it names; None for 346 x 260.

    Raises:
        RecordingError: the file is missing or wrong; the message starts
            with ``file:line`` and names the column and what is expected there.
    """
    path = Path(path)
    try:
        text = read_text(path, MAX_LABELS_BYTES)
        reader = csv.reader(StringIO(text, newline=""), strict=True)
        truths = list(_parse(path, reader, size_px or (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX)))
    except FileNotFoundError as error:
        raise _refuse_unlabelled(path) from error
    except OSError as error:
        reason = f"'{path}' cannot be read: {error.strerror}."
        again = "Save it again as CSV in UTF-8." if error.errno == errno.EILSEQ else None
        raise RecordingError(reason, hint=suggest_reading(error, again)) from error
    if not truths:
        raise RecordingError(
            f"'{path}' has no labels.", hint="Write one row for each labelled moment."
        )
    return truths


@dataclass(frozen=True, slots=True)
class _Row:
    """One row and its place, so that every error can name it."""

    place: str
    values: dict[str, str]
    size_px: tuple[int, int]

    def error(self, column: str, expected: str) -> RecordingError:
        found = make_printable(self.values[column][:SHOWN_COLUMNS])
        return RecordingError(
            f"{self.place}: column {column}: expected {expected}, found "
            + (f"'{found}'" if found else "nothing")
        )

    def integer(self, column: str, expected: str) -> int:
        if not _INTEGER.fullmatch(self.values[column]):
            raise self.error(column, expected)
        return int(self.values[column])

    def number(self, column: str, expected: str) -> float:
        if not _NUMBER.fullmatch(self.values[column]):
            raise self.error(column, expected)
        return float(self.values[column])


def _read_rows(path: Path, reader: "_csv.Reader") -> Iterator[list[str]]:
    line = 1
    try:
        for cells in reader:
            yield cells
            line = reader.line_num + 1
    except csv.Error as error:
        raise RecordingError(
            f"{path}:{line}: a quotation mark is missing, or one is too many.",
            hint="Labels need no quotation marks: remove those of this row.",
        ) from error


def _parse(path: Path, reader: "_csv.Reader", size_px: tuple[int, int]) -> Iterator[Truth]:
    rows = _read_rows(path, reader)
    header = [name.strip() for name in next(rows, [])]
    if tuple(header) != COLUMNS:
        raise RecordingError(
            f"{path}:1: {_header_fault(header)}.", hint="The header is: " + ",".join(COLUMNS)
        )
    before_us: int | None = None
    for cells in rows:
        if not cells:
            continue
        place = f"{path}:{reader.line_num}"
        if len(cells) != len(COLUMNS):
            raise RecordingError(f"{place}: expected {len(COLUMNS)} columns, found {len(cells)}.")
        values = {name: cell.strip() for name, cell in zip(COLUMNS, cells, strict=True)}
        row = _Row(place, values, size_px)
        truth = _truth(row)
        if before_us is not None and truth.t_us <= before_us:
            raise row.error("timestamp_us", f"a time after the row before ({before_us})")
        before_us = truth.t_us
        yield truth


def _header_fault(header: list[str]) -> str:
    if len(header) == 1:  # a spreadsheet of a country that writes 1,5 saves it so
        for sign, name in _OTHER_SEPARATORS.items():
            if sign in header[0]:
                return f"the columns are separated by {name}, not by commas"
    missing = [name for name in COLUMNS if name not in header]
    unknown = [name for name in header if name not in COLUMNS]
    if missing:
        return f"column {missing[0]} is missing"
    if unknown == [""] * len(unknown) and unknown:
        return f"column {header.index('') + 1} has no name"
    if unknown:
        return f"unknown column '{make_printable(unknown[0][:SHOWN_COLUMNS])}'"
    return "the columns are in another order or appear twice"


def _truth(row: _Row) -> Truth:
    t_us = row.integer("timestamp_us", "a whole number of microseconds")
    if abs(t_us) > MAX_STAMP_US:
        raise row.error("timestamp_us", "a time that a recording can have")
    label = row.values["gesture"]
    if label not in _KINDS:
        close = difflib.get_close_matches(label[:SHOWN_COLUMNS].lower(), _KINDS, n=1)
        meant = f" (did you mean {close[0]}?)" if close else ""
        raise row.error("gesture", f"one of {' '.join(_KINDS)}{meant}")
    millimetres = f"a number of millimetres from 0 to {MAX_INTENSITY_MM}"
    intensity_mm = row.number("intensity_mm", millimetres)
    if not 0 <= intensity_mm <= MAX_INTENSITY_MM:
        raise row.error("intensity_mm", millimetres)
    n = row.integer("contacts", f"a whole number from 0 to {MAX_CONTACTS}")
    if not 0 <= n <= MAX_CONTACTS:
        raise row.error("contacts", f"a whole number from 0 to {MAX_CONTACTS}")
    for column in POINT_COLUMNS[2 * n :]:
        if row.values[column]:
            raise row.error(column, f"nothing, since contacts is {n}")
    points = [row.number(column, "a number of pixels") for column in POINT_COLUMNS[: 2 * n]]
    for column, value, limit in zip(POINT_COLUMNS, points, row.size_px * n, strict=False):
        if not -limit <= value <= 2 * limit:  # a contact may be beyond the picture's edge
            raise row.error(column, f"a pixel in or near the picture (0 to {limit - 1})")
    return Truth(t_us, _KINDS[label], np.array(points).reshape(-1, 2), intensity_mm)
