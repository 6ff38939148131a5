"""Measures how far the labels of two people agree."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.evaluation.accuracy.label_track import pair_points
from neurotouch_hid.labelling.track import UNLABELLED, Run, Track


@dataclass(frozen=True, slots=True)
class Agreement:
    """Two people's labels, at the moments that both have labelled.

    Attributes:
        n_moments: how many these are.
        kappa: Cohen's kappa of the types: 1 is full agreement, 0 what chance gives. None if both
            have used only one and the same type, of which kappa says nothing.
        same_type: share of moments with the same type.
        same_count: share with as many contacts, where both see a gesture.
        contact_mm: mean distance of their contacts, where both see a gesture; None without one.
        intensity_mm: mean difference of the intensity there.
    """

    n_moments: int
    kappa: float | None
    same_type: float
    same_count: float
    contact_mm: float | None
    intensity_mm: float | None


def measure_agreement(mine: Track, other: Track, px_per_mm: float) -> Agreement | None:
    """Returns how far two tracks of one recording agree; None if no moment is in both.

    Kappa is that of J. Cohen, A coefficient of agreement for nominal scales (1960).

    Args:
        mine: labels.
        other: another person's labels.
        px_per_mm: scale of the picture.
    """
    both = _find_both(mine, other)
    if not both.any():
        return None
    a, b = mine.kind[both].astype(int), other.kind[both].astype(int)
    same = float((a == b).mean())
    kinds = range(max(a.max(), b.max()) + 1)
    chance = sum(float((a == kind).mean() * (b == kind).mean()) for kind in kinds)
    kappa = (same - chance) / (1.0 - chance) if chance < 1.0 else None
    gestures = both & (mine.kind > 0) & (other.kind > 0)
    distances = [
        float(np.linalg.norm(first[rows] - second[columns], axis=1).mean())
        for k in np.flatnonzero(gestures)
        for first, second in [(mine.points(int(k)), other.points(int(k)))]
        for rows, columns in [pair_points(first, second)]
        if rows
    ]
    strengths = np.abs(mine.intensity_mm - other.intensity_mm)[gestures]
    return Agreement(
        int(both.sum()),
        kappa,
        same,
        float((mine.counts == other.counts)[gestures].mean()) if gestures.any() else 1.0,
        float(np.mean(distances)) / px_per_mm if distances else None,
        float(strengths.mean()) if len(strengths) else None,
    )


def find_differences(mine: Track, other: Track) -> list[Run]:
    """Returns where both have labelled and the type or the number of contacts differs.

    Args:
        mine: labels; the kind of a run is theirs.
        other: another person's labels.
    """
    differs = _find_both(mine, other) & (
        (mine.kind != other.kind) | ((mine.counts != other.counts) & (mine.kind > 0))
    )
    found = []
    for run in mine.runs():
        if run.kind == UNLABELLED:
            continue
        edges = np.flatnonzero(np.diff(differs[run.first : run.last + 1], prepend=0, append=0))
        found += [
            Run(run.first + int(begin), run.first + int(end) - 1, run.kind)
            for begin, end in edges.reshape(-1, 2)
        ]
    return found


def _find_both(mine: Track, other: Track) -> NDArray[np.bool_]:
    both: NDArray[np.bool_] = (mine.kind != UNLABELLED) & (other.kind != UNLABELLED)
    return both
