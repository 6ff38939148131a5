"""Finds the moments at which a person should look: where the recogniser is likely to be wrong."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from neurotouch_hid.labelling.look_through import Moments
from neurotouch_hid.labelling.track import Run, is_gesture

_SHORT_US: Final = 200_000
_UNSURE: Final = 0.6
"""Confidence below which a type is doubtful."""
_FAINT_MM: Final = 1.5
_MOVED_MM: Final = 0.8
"""The gel moves visibly, about two pixels, and nothing is recognised."""
_LEAST_SEEN: Final = 0.95


@dataclass(frozen=True, slots=True)
class Doubt:
    """A doubtful moment.

    Attributes:
        moment: the moment to look at.
        reason: why, as a sentence.
    """

    moment: int
    reason: str


def find_doubts(moments: Moments) -> list[Doubt]:
    """Returns the doubtful moments, in order of time; at most one for each run of a kind."""
    runs = list(moments.proposals.runs())
    found = []
    for i, run in enumerate(runs):
        before = runs[i - 1] if i else None
        reason = next(_doubt(moments, run, before), None)
        if reason is not None:
            found.append(Doubt(_middle(moments, run), reason))
    return found


def _doubt(moments: Moments, run: Run, before: Run | None) -> Iterator[str]:
    inside = slice(run.first, run.last + 1)
    last = min(run.last + 1, len(moments) - 1)
    duration_us = int(moments.t_us[last] - moments.t_us[run.first])
    if not is_gesture(run.kind):
        if moments.peak_mm[inside].max() > _MOVED_MM:
            yield "The gel moves, but no gesture is recognised."
        return
    if duration_us < _SHORT_US:
        yield f"Short: {duration_us // 1000} ms."
    if before is not None and is_gesture(before.kind):
        yield "The type changes without a rest between."
    if len(set(moments.proposals.counts[inside].tolist())) > 1:
        yield "The number of contacts changes."
    if moments.confidence[inside].mean() < _UNSURE:
        yield "The recogniser is not sure of the type."
    if moments.proposals.intensity_mm[inside].max() < _FAINT_MM:
        yield "Faint."
    if moments.is_seen[inside].mean() < _LEAST_SEEN:
        yield "Many dots cannot be seen."


def _middle(moments: Moments, run: Run) -> int:
    """Returns the moment of a run in which most is to be seen."""
    strength = moments.peak_mm[run.first : run.last + 1]
    return run.first + int(np.argmax(strength))
