"""Chooses sound cues from the pipeline's steps."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Final

import numpy as np

from neurotouch_hid.gel_sentences import explain_gel
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GelProblem, GelState, GestureKind, Step
from neurotouch_hid.profile.decision_log import MappingDecision
from neurotouch_hid.profile.schema import Volumes

if TYPE_CHECKING:
    from neurotouch_hid.profile import Mapping

ACCEPT_VOLUME: Final = 60
"""Volume in percent for a person who has chosen none and whose gestures act only after a while."""

_LOST: Final = GestureConfig().min_tracked
_FOUND: Final = _LOST + 0.17
"""Above the other limit, so that a gel near the limit does not switch with every slice."""


class CueKind(StrEnum):
    """The kinds of sounds."""

    PANIC = "panic"
    PAUSE = "pause"
    LOST = "lost"
    FOUND = "found"
    RESUME = "resume"
    LAYER = "layer"
    ACCEPT = "accept"
    STEP = "step"
    REJECT = "reject"
    PRESS = "press"


@dataclass(frozen=True, slots=True)
class Cue:
    """One sound to play.

    Attributes:
        kind: the kind of sound.
        words: the same in words, for speech.
    """

    kind: CueKind
    words: str


@dataclass(frozen=True, slots=True)
class CueFacts:
    """The facts that decide about cues, taken from a step or from a published state.

    Attributes:
        state: ``running``, ``paused`` or ``panic``.
        profile: the active profile.
        layer: its active layer.
        gel: whether the gel is found, and its problem.
        explain: gives the same in words; asked only when they are said.
        tracked: share of the markers that are measured.
        gesture: the type of the gesture, ``none`` at rest.
        decisions: the latest ones, oldest first.
    """

    state: str
    profile: str
    layer: str
    gel: tuple[bool, str]
    explain: Callable[[], str]
    tracked: float
    gesture: str
    decisions: tuple[MappingDecision, ...]


def take_facts(step: Step | None, mapping: "Mapping") -> CueFacts:
    """Returns the facts of a step that ``mapping`` has carried out; None: before the first."""
    gel = GelState() if step is None else step.gel
    return CueFacts(
        mapping.state,
        mapping.profile.name,
        mapping.layer,
        (gel.is_found, gel.problem),
        lambda: explain_gel(gel).text,
        0.0 if step is None else np.count_nonzero(step.markers.valid) / len(step.markers.valid),
        GestureKind.NONE.label if step is None else step.gesture.kind.label,
        mapping.decisions(),
    )


class CueFinder:
    """Compares the facts of each step with those of the step before.

    *Press* is a gesture that begins, *accept* a binding that acts, *reject* one that does not, as
    with slow and bounce keys. While nothing acts, gestures are not heard.

    Args:
        first: the facts at the start.
    """

    def __init__(self, first: CueFacts) -> None:
        self._state = first.state
        self._place = first.profile, first.layer
        self._last: MappingDecision | None = None
        self._gesture = first.gesture
        self._tracked = first.tracked >= _FOUND
        self._gel = first.gel
        self._take_new(first.decisions)

    def find(self, now: CueFacts) -> list[Cue]:
        """Returns the cues of a step; mostly none.

        Only one sound can be played at a time, so the most important comes first.
        """
        heard = [self._hear_state(now), self._hear_gel(now), self._hear_tracker(now)]
        acting = self._hear_layer(now), self._hear_decisions(now), self._hear_begin(now)
        if now.state == "running":
            heard += acting
        return [cue for cue in heard if cue is not None]

    def _hear_state(self, now: CueFacts) -> Cue | None:
        before, self._state = self._state, now.state
        if self._state == before:
            return None
        match self._state:
            case "panic":
                return Cue(CueKind.PANIC, "stopped")
            case "paused":
                return Cue(CueKind.PAUSE, "paused")
        return Cue(CueKind.RESUME, "resumed")

    def _hear_gel(self, now: CueFacts) -> Cue | None:
        before, self._gel = self._gel, now.gel
        if self._gel == before:
            return None
        if now.gel[1]:
            return Cue(CueKind.LOST, f"gel {now.explain()}")
        if before[0] or before[1] == GelProblem.WAITING:
            return None  # it is fine from the start, or again
        return Cue(CueKind.FOUND, "gel found")

    def _hear_tracker(self, now: CueFacts) -> Cue | None:
        before = self._tracked
        self._tracked = now.tracked >= (_LOST if before else _FOUND)
        gone = before and not self._tracked and now.gel[0]  # else the reason is known, and said
        return Cue(CueKind.LOST, "gel lost") if gone else None

    def _hear_layer(self, now: CueFacts) -> Cue | None:
        before, self._place = self._place, (now.profile, now.layer)
        if self._place == before:
            return None
        profile, layer = self._place
        words = f"profile {profile}" if profile != before[0] else f"layer {layer}"
        return Cue(CueKind.LAYER, words.replace("-", " "))

    def _hear_decisions(self, now: CueFacts) -> Cue | None:
        new = self._take_new(now.decisions)
        for decision in reversed(new):
            if decision.verdict == "pressed":
                return Cue(CueKind.ACCEPT, decision.what.rsplit(" -> ", 1)[-1])
        for decision in reversed(new):
            if decision.verdict == "step":
                return Cue(CueKind.STEP, decision.why)
        if any(decision.verdict == "ignored" for decision in new):
            return Cue(CueKind.REJECT, "not accepted")
        return None

    def _hear_begin(self, now: CueFacts) -> Cue | None:
        rest = GestureKind.NONE.label
        before, self._gesture = self._gesture, now.gesture
        if before != rest or self._gesture == rest:
            return None
        return Cue(CueKind.PRESS, self._gesture.split("_", 1)[0])

    def _take_new(self, decisions: tuple[MappingDecision, ...]) -> list[MappingDecision]:
        """Returns the decisions made since the last call."""
        new = []
        for decision in reversed(decisions):
            if decision == self._last:
                break
            new.append(decision)
        self._last = decisions[-1] if decisions else None
        return new[::-1]


def choose_volume(kind: CueKind, volumes: Volumes, *, waits: bool) -> int:
    """Returns the volume that the person wants for a cue, in percent.

    Args:
        kind: the sound.
        volumes: the person's.
        waits: gestures act only after a while, so the moment of acting deserves a sound.
    """
    match kind:
        case CueKind.STEP:
            return volumes.press if volumes.accept is None else volumes.accept
        case CueKind.ACCEPT if volumes.accept is None:
            return ACCEPT_VOLUME if waits else 0
        case CueKind.PANIC | CueKind.RESUME:
            return volumes.pause
        case CueKind.FOUND:
            return volumes.lost
    return int(getattr(volumes, kind))
