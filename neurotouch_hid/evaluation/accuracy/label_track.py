"""Interpolates the labels of a recording between the first and the last of them."""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import GestureKind, Truth


class LabelTrack:
    """Labels in order of time, with the paper's rule for the moments between them.

    Args:
        labels: at least one, ascending in time.

    Raises:
        RecordingError: there is no label.
    """

    def __init__(self, labels: Sequence[Truth]) -> None:
        if not labels:
            raise RecordingError(
                "The recording has no labels.", hint="Evaluation compares with labels; add some."
            )
        self._labels = labels
        self._times = [label.t_us for label in labels]
        self._active = [label.t_us for label in labels if label.kind is not GestureKind.NONE]
        self._going = -1, np.empty((0, 2))  # a label, and how far its points go to the next one

    def at(self, t_us: int) -> Truth | None:
        """Returns the truth at a moment, or None before the first and after the last label.

        [NT, "Creation of the Gesture Detection Dataset"]: the most recent labelled type; contact
        points and intensity linearly between the preceding and the following label.
        Open in the paper: what happens to the points where their number changes. Here the number is
        the most recent one, like the type. Points are paired so that the sum of distances is least.
        A point that ends stays at its place; a new point appears at its own label.
        """
        k = bisect_right(self._times, t_us) - 1
        if k < 0 or t_us > self._times[-1]:
            return None
        before = self._labels[k]
        if t_us == before.t_us or k + 1 == len(self._labels):
            return before
        after = self._labels[k + 1]
        share = (t_us - before.t_us) / (after.t_us - before.t_us)
        if self._going[0] != k:
            self._going = k, find_way(before.contacts_px, after.contacts_px)
        points = before.contacts_px
        if len(points):  # there are none at rest, which is most of the time
            points = points + share * self._going[1]
        intensity = before.intensity_mm + share * (after.intensity_mm - before.intensity_mm)
        return Truth(t_us, before.kind, points, intensity)

    def nearest(self, t_us: int) -> Truth | None:
        """Returns the label nearest in time, or None before the first and after the last label.

        A frame's own label may be stamped with the begin, the middle or the end of its exposure.
        """
        k = bisect_right(self._times, t_us)
        around = self._labels[max(k - 1, 0) : k + 1]
        nearest = min(around, key=lambda label: abs(label.t_us - t_us))
        return nearest if self._covers(t_us) else None

    def is_rest(self, t_us: int, margin_us: int) -> bool:
        """Returns True where no gesture is labelled within ``margin_us`` before and after."""
        first_after = bisect_left(self._active, t_us - margin_us)
        return first_after == bisect_right(self._active, t_us + margin_us)

    def _covers(self, t_us: int) -> bool:
        """Returns True within the labels, extended by half a usual label distance at both ends."""
        span = self._times[-1] - self._times[0]
        margin = span / max(len(self._times) - 1, 1) / 2
        return self._times[0] - margin <= t_us <= self._times[-1] + margin


def find_way(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns how far each point of ``first``, (n, 2), goes to its partner in ``second``, (m, 2).

    It is 0 for a point without one.
    """
    way = np.zeros_like(first)
    rows, columns = pair_points(first, second)
    if rows:
        way[rows] = second[columns] - first[rows]
    return way


def pair_points(
    first: NDArray[np.float64], second: NDArray[np.float64]
) -> tuple[list[int], list[int]]:
    """Returns the pairing of two small sets of points with the least sum of distances.

    Args:
        first: (n, 2).
        second: (m, 2).

    Returns:
        min(n, m) indices into ``first``, ascending, and their partners in ``second``.
    """
    if not len(first) or not len(second):  # most of the time: at rest
        return [], []
    if len(first) > len(second):
        partners, chosen = pair_points(second, first)
        order = sorted(range(len(chosen)), key=lambda k: chosen[k])
        return [chosen[k] for k in order], [partners[k] for k in order]
    distance = np.linalg.norm(first[:, None] - second[None], axis=2)
    rows = list(range(len(first)))
    best = min(permutations(range(len(second)), len(first)), key=lambda p: distance[rows, p].sum())
    return rows, list(best)
