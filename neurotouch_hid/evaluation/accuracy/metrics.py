"""Computes the paper's figures from a tally, ready for JSON: fractions of 1, None if undefined."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.evaluation.accuracy.reliability import N_BINS, Reliability
from neurotouch_hid.evaluation.accuracy.tally import BIN_MM, Tally
from neurotouch_hid.evaluation.accuracy.type_timing import TypeTiming
from neurotouch_hid.messages import GestureKind

_LABELS = [kind.label for kind in GestureKind]


def summarise(tally: Tally) -> dict[str, Any]:
    """Returns every figure of [NT, "Metrics"] and [NT, "Results"] that a tally gives."""
    confusion = tally.confusion
    total = int(confusion.sum())
    performed = total - int(confusion[GestureKind.NONE].sum())
    found, missed, invented = (tally.rest[k] for k in ((True, True), (True, False), (False, True)))
    rest = _score(found, found + invented, found + missed)
    return {
        "gesture_accuracy": _ratio(int(np.trace(confusion)), total),
        "count_accuracy": _ratio(int(tally.right_counts.sum()), total),
        "distance_mm": _ratio(float(tally.distance_mm.sum()), int(tally.distances.sum())),
        "intensity_mae_mm": _ratio(float(tally.intensity_error_mm.sum()), performed),
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
        "gesture_accuracy_from_2.5_mm": _ratio(tally.firm_types, tally.firm),
        "by_gesture": {kind.label: _describe_gesture(tally, kind) for kind in GestureKind},
        **_summarise_timing(tally.timing),
        "reliability": _summarise_reliability(tally.reliability),
    }


def balance(confusion: NDArray[np.int64]) -> list[list[float | None]]:
    """Returns the mean of the row- and the column-normalised matrix [NT, confusion matrix].

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


def _describe_gesture(tally: Tally, kind: GestureKind) -> dict[str, float | None]:
    """Returns the figures that [NT] shows by labelled type.

    No contact and no intensity is labelled for none.
    """
    labelled = int(tally.confusion[kind].sum())
    performed = labelled if kind is not GestureKind.NONE else 0
    return {
        "count_accuracy": _ratio(int(tally.right_counts[kind]), labelled),
        "distance_mm": _ratio(float(tally.distance_mm[kind]), int(tally.distances[kind])),
        "intensity_mae_mm": _ratio(float(tally.intensity_error_mm[kind]), performed),
        "observations": labelled,
    }


def _summarise_timing(timing: TypeTiming) -> dict[str, Any]:
    """Summarises delays; a gesture whose type is never recognised counts as infinitely late."""
    late = [math.inf] * (timing.gestures - len(timing.times_ms))
    times_ms = sorted(timing.times_ms + late)
    return {
        "time_to_type_ms": {
            "median": _quantile(times_ms, 0.5),
            "p95": _quantile(times_ms, 0.95),
            "gestures": timing.gestures,
            "never": len(late),
        },
        "type_changes": _ratio(timing.changes, timing.gestures),
        "false_gestures_per_10_min": _ratio(600.0 * timing.false_gestures, timing.rest_s),
        "at_rest_s": round(timing.rest_s, 3),
    }


def _summarise_reliability(reliability: Reliability) -> dict[str, Any]:
    """Bins slices by confidence; ``error`` is the mean of |confidence - accuracy|."""
    seen, right = reliability.observations, reliability.right
    confidence = [_ratio(reliability.confidence.get(k, 0.0), seen[k]) for k in range(N_BINS)]
    gaps = [abs(reliability.confidence[k] - right[k]) for k in seen]
    return {
        "edges": [k / N_BINS for k in range(N_BINS + 1)],
        "confidence": confidence,
        "accuracy": [_ratio(right[k], seen[k]) for k in range(N_BINS)],
        "observations": [seen[k] for k in range(N_BINS)],
        "error": _ratio(sum(gaps), seen.total()),
    }


def _quantile(ascending: list[float], share: float) -> float | None:
    """Returns the smallest value that ``share`` of all values do not exceed.

    None if it is infinite.
    """
    if not ascending:
        return None
    value = ascending[math.ceil(share * len(ascending)) - 1]
    return value if math.isfinite(value) else None


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
