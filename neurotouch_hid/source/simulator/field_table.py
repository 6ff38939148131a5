"""A table of displacements that plays like a script: real fields drive the whole pipeline.

The dots of the table need not be those of the gel. Each dot of the gel moves as the dots of the
table around it do.
"""

import csv
import re
from io import StringIO
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.files.faults import SHOWN_COLUMNS
from neurotouch_hid.files.small_file import read_text
from neurotouch_hid.printable import make_printable
from neurotouch_hid.source.simulator.script import Grasp

COLUMNS: Final = ("time_us", "marker", "x_mm", "y_mm")
MAX_BYTES: Final = 32 << 20
"""Ten minutes of 100 dots at 25 Hz."""
_FEWEST_DOTS: Final = 10
_MOST_DOTS: Final = 1000
_WIDTH: Final = 0.6
"""Of a dot's influence, in distances of the dots: wider smooths, narrower makes steps."""
_LARGEST_MM: Final = 1000.0
_LONGEST_US: Final = 24 * 3_600_000_000
_INTEGER: Final = re.compile(r"[0-9]{1,12}")
_NUMBER: Final = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]{1,2})?")


class FieldTable:
    """Places of dots over time.

    It has no fingers, so nothing says which gesture it is: its truth is the dots alone.

    Args:
        name: for people.
        t_us: (k,) int64, ascending, the first is 0 and shows the gel at rest; at least two.
        places_mm: (k, m, 2) float64, columns x, y, in gel coordinates.

    Attributes:
        rest_mm: (m, 2) float64.
    """

    endless = False

    def __init__(self, name: str, t_us: NDArray[np.int64], places_mm: NDArray[np.float64]) -> None:
        self.name = name
        self.duration_us = int(t_us[-1])
        self.rest_mm = places_mm[0]
        self._t_us = t_us.astype(np.float64)
        self._moved_mm = places_mm - places_mm[0]
        self._slope_mm_us = np.gradient(self._moved_mm, self._t_us, axis=0)

    def find(self, t_us: int) -> tuple[Grasp, int] | None:  # noqa: ARG002  # no finger, ever
        """Returns None: there are no fingers."""
        return None

    def measure(self, t_us: int) -> NDArray[np.float64]:
        """Returns how far each dot of the table has moved, (m, 2) mm; smooth over time."""
        t = min(max(float(t_us), 0.0), self._t_us[-1])
        k = int(np.clip(np.searchsorted(self._t_us, t, "right") - 1, 0, len(self._t_us) - 2))
        step = self._t_us[k + 1] - self._t_us[k]
        u = (t - self._t_us[k]) / step
        a, b = self._moved_mm[k], self._moved_mm[k + 1]
        slope_a, slope_b = self._slope_mm_us[k], self._slope_mm_us[k + 1]
        moved: NDArray[np.float64] = (
            (2 * u**3 - 3 * u**2 + 1) * a
            + (u**3 - 2 * u**2 + u) * step * slope_a
            + (3 * u**2 - 2 * u**3) * b
            + (u**3 - u**2) * step * slope_b
        )
        return moved

    def spread(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the weights (n, m) of the table's dots for the motion of points (n, 2), mm.

        A plane is fitted to the dots around each point, by the squares of their errors, the nearer
        the heavier. Outside of the table's dots the motion fades within two of their distances.
        """
        pitch = _measure_pitch(self.rest_mm)
        weights = np.zeros((len(points_mm), len(self.rest_mm)))
        for i, point in enumerate(points_mm):
            off = self.rest_mm - point
            far = np.hypot(*off.T)
            near = np.exp(-((far / (_WIDTH * pitch)) ** 2)) + 1e-12
            plane = np.column_stack([np.ones(len(off)), off / pitch])
            normal = plane.T @ (plane * near[:, None]) + 1e-6 * np.eye(3)
            fade = np.exp(-(max(far.min() / pitch - 1.0, 0.0) ** 2) * 4.0)
            weights[i] = fade * np.linalg.solve(normal, plane.T * near)[0]
        return weights


def _measure_pitch(points_mm: NDArray[np.float64]) -> float:
    """Returns the usual distance from a dot to the next one, mm."""
    apart = np.linalg.norm(points_mm[:, None] - points_mm[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    return max(float(np.median(apart.min(axis=1))), 1e-3)


def read_field_table(path: Path) -> FieldTable:
    """Returns a table: CSV with the columns ``time_us``, ``marker``, ``x_mm``, ``y_mm``.

    Rows are in order of time. Each time has each marker once, numbered from 0; the first time shows
    the gel at rest.

    Raises:
        RecordingError: the file is missing or wrong; the message says where.
    """
    try:
        rows = list(csv.reader(StringIO(read_text(path, MAX_BYTES), newline=""), strict=True))
    except OSError as error:
        raise RecordingError(f"'{path}' cannot be read: {error.strerror}.") from error
    except csv.Error as error:
        raise RecordingError(
            f"'{path}' has a quotation mark too many, or one is missing.",
            hint="A table needs none: remove them.",
        ) from error
    if not rows or tuple(name.strip() for name in rows[0]) != COLUMNS:
        raise RecordingError(
            f"{path}:1: expected the columns {','.join(COLUMNS)}.", hint="Write them as first line."
        )
    times: list[int] = []
    places: list[list[tuple[float, float]]] = []
    for number, cells in enumerate(rows[1:], 2):
        if cells:
            _read_row(f"{path}:{number}", cells, times, places)
    n = len(places[0]) if places else 0
    if len(times) < 2 or not _FEWEST_DOTS <= n <= _MOST_DOTS:  # a begin and an end
        raise RecordingError(
            f"'{path}' has {len(times)} times of {n} markers.",
            hint=f"It needs two times or more, and {_FEWEST_DOTS} to {_MOST_DOTS} markers.",
        )
    if len(places[-1]) != n:
        raise RecordingError(f"'{path}' ends before marker {len(places[-1])} of its last time.")
    t_us = np.array(times, np.int64)
    return FieldTable(path.name, t_us - t_us[0], np.array(places, np.float64))


def _read_row(
    place: str, cells: list[str], times: list[int], places: list[list[tuple[float, float]]]
) -> None:
    if len(cells) != len(COLUMNS):
        raise RecordingError(f"{place}: expected {len(COLUMNS)} columns, found {len(cells)}.")
    t_us = _read_integer(place, "time_us", cells[0])
    marker = _read_integer(place, "marker", cells[1])
    if not times or t_us != times[-1]:
        if times and (t_us < times[-1] or t_us - times[0] > _LONGEST_US):
            raise RecordingError(f"{place}: column time_us: expected a time after {times[-1]}.")
        if len(places) > 1 and len(places[-1]) != len(places[0]):
            raise RecordingError(f"{place}: expected marker {len(places[-1])} of the time before.")
        times.append(t_us)
        places.append([])
    if marker != len(places[-1]) or (len(places) > 1 and marker >= len(places[0])):
        raise RecordingError(
            f"{place}: column marker: expected {len(places[-1])}, found {marker}.",
            hint="Give the markers of each time in order, from 0.",
        )
    places[-1].append((_read_mm(place, "x_mm", cells[2]), _read_mm(place, "y_mm", cells[3])))


def _read_integer(place: str, column: str, cell: str) -> int:
    if not _INTEGER.fullmatch(cell.strip()):
        raise _refuse(place, column, "a whole number, 0 or more", cell)
    return int(cell)


def _read_mm(place: str, column: str, cell: str) -> float:
    number = float(cell) if _NUMBER.fullmatch(cell.strip()) else np.inf
    if abs(number) > _LARGEST_MM:
        limit = f"{_LARGEST_MM:g}"
        raise _refuse(place, column, f"millimetres from -{limit} to {limit}", cell)
    return number


def _refuse(place: str, column: str, expected: str, cell: str) -> RecordingError:
    found = make_printable(cell.strip()[:SHOWN_COLUMNS])
    return RecordingError(f"{place}: column {column}: expected {expected}, found '{found}'.")
