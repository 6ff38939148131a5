"""Improves proposals with hindsight: who labels knows how a gesture went on.

While a gesture begins, the recogniser does not know yet what it will be. It waits, or names another
type for some moments.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.labelling.track import Run, Track, is_gesture
from neurotouch_hid.messages import GestureKind

_BEGIN_US: Final = 200_000
"""A shorter part before a longer one of another type is how that one started."""
_GAP_US: Final = 100_000
"""A shorter rest between two parts of a gesture is none."""
VISIBLE_PX: Final = 1.0
"""Displacement of a dot that a person sees in the picture."""


def apply_hindsight(
    track: Track, t_us: NDArray[np.int64], peak_mm: NDArray[np.float32], px_per_mm: float
) -> None:
    """Corrects begin and end of all gestures of a track.

    Args:
        track: the proposals, which are changed.
        t_us: (n,) the moments.
        peak_mm: (n,) displacement of the dot that is displaced most.
        px_per_mm: scale of the picture.
    """
    for begin, gesture in _find_begins(track, t_us):
        _fill(track, begin, gesture.first, peak_mm)
    visible = peak_mm * px_per_mm >= VISIBLE_PX
    for run in [run for run in track.runs() if is_gesture(run.kind)]:
        first, last = run.first, run.last
        while first > 0 and track.kind[first - 1] == GestureKind.NONE and visible[first - 1]:
            first -= 1
        while (
            last + 1 < len(visible)
            and track.kind[last + 1] == GestureKind.NONE
            and visible[last + 1]
        ):
            last += 1
        _fill(track, range(first, run.first), run.first, peak_mm)
        _fill(track, range(run.last + 1, last + 1), run.last, peak_mm)


def _find_begins(track: Track, t_us: NDArray[np.int64]) -> list[tuple[range, Run]]:
    """Returns the moments in which the gesture after them started, with that gesture."""
    found = []
    runs = list(track.runs())
    for i, run in enumerate(runs):
        if not is_gesture(run.kind) or _measure(run, t_us) < _BEGIN_US:
            continue
        first = run.first
        for before in reversed(runs[:i]):
            if before.kind == GestureKind.NONE:
                is_part = _measure(before, t_us) < _GAP_US
            else:
                is_part = _measure(before, t_us) < _BEGIN_US
            if not is_part:
                break
            if is_gesture(before.kind):
                first = before.first
        if first < run.first:
            found.append((range(first, run.first), run))
    return found


def _measure(run: Run, t_us: NDArray[np.int64]) -> int:
    """Returns the duration of a run in µs."""
    return int(t_us[min(run.last + 1, len(t_us) - 1)] - t_us[run.first])


def _fill(track: Track, moments: range, like: int, peak_mm: NDArray[np.float32]) -> None:
    """Labels moments like another one; the intensity goes with the displacement."""
    for k in moments:
        share = min(float(peak_mm[k]) / max(float(peak_mm[like]), 1e-6), 1.0)
        intensity_mm = float(track.intensity_mm[like]) * share
        track.set(k, int(track.kind[like]), intensity_mm, track.points(like))
