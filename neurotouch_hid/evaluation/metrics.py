"""From a tally to the paper's figures, ready for JSON: fractions of 1, None where undefined."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.evaluation.tally import BIN_MM, Tally
from neurotouch_hid.messages import GestureKind

_LABELS = [kind.label for kind in GestureKind]


def summarise(tally: Tally) -> dict[str, Any]:
    """Every figure of [NT, "Metrics"] and [NT, "Results"] that a tally holds."""
    confusion = tally.confusion
    total = int(confusion.sum())
    performed = total - int(confusion[GestureKind.NONE].sum())
    found, missed, invented = (tally.rest[k] for k in ((True, True), (True, False), (False, True)))
    rest = _score(found, found + invented, found + missed)
    return {
        "gesture_accuracy": _ratio(int(np.trace(confusion)), total),
        "count_accuracy": _ratio(tally.right_counts, total),
        "distance_mm": _ratio(tally.distance_mm, tally.distances),
        "intensity_mae_mm": _ratio(tally.intensity_error_mm, performed),
        **{f"rest_{name}": rest[name] for name in ("f1", "precision", "recall")},
        "per_gesture": {
            kind.label: _score(
                int(confusion[kind, kind]),
                int(confusion[:, kind].sum()),
                int(confusion[kind].sum()),
            )
            for kind in GestureKind
        },
        "confusion": {"labels": _LABELS, "balanced": balance(confusion)},
        "by_intensity": _bin(tally),
        "observations": total,
        "frames": tally.frames,
        "events": tally.events,
        "realtime_factor": _ratio(tally.sensor_s, tally.host_s),
    }


def balance(confusion: NDArray[np.int64]) -> list[list[float | None]]:
    """The mean of the row-normalised and the column-normalised matrix [NT, confusion matrix].

    A type that is never labelled has no row and one that is never predicted has no column; such a
    cell keeps the other half alone, and is None if it has neither.
    """
    rows, columns = confusion.sum(axis=1), confusion.sum(axis=0)
    return [
        [
            _mean([_ratio(int(confusion[i, j]), int(n)) for n in (rows[i], columns[j])])
            for j in range(len(columns))
        ]
        for i in range(len(rows))
    ]


def _bin(tally: Tally) -> dict[str, list[float | None]]:
    n = max(tally.binned, default=-1) + 1
    return {
        "edges_mm": [round(k * BIN_MM, 3) for k in range(n + 1)],
        "gesture_accuracy": [_ratio(tally.binned_types[k], tally.binned[k]) for k in range(n)],
        "count_accuracy": [_ratio(tally.binned_counts[k], tally.binned[k]) for k in range(n)],
        "observations": [tally.binned[k] for k in range(n)],
    }


def _score(right: int, predicted: int, labelled: int) -> dict[str, float | None]:
    return {
        "precision": _ratio(right, predicted),
        "recall": _ratio(right, labelled),
        "f1": _ratio(2 * right, predicted + labelled),
    }


def _ratio(part: float, whole: float) -> float | None:
    return part / whole if whole else None


def _mean(values: list[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known else None
