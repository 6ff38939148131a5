"""What is worth hearing in a step of the pipeline."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GestureKind, Step
from neurotouch_hid.profile import Mapping, MappingDecision, UserSettings
from neurotouch_hid.profile.schema.timing import resolve_times

ACCEPT_VOLUME: Final = 60
"""In percent, where the person has chosen none and has to wait for a gesture to act."""

_LOST: Final = GestureConfig().min_tracked
_FOUND: Final = _LOST + 30
"""More than are needed, so that a gel at the limit does not come and go with every slice."""


class CueKind(StrEnum):
    """The sounds there are."""

    PANIC = "panic"
    PAUSE = "pause"
    LOST = "lost"
    RESUME = "resume"
    LAYER = "layer"
    ACCEPT = "accept"
    STEP = "step"
    REJECT = "reject"
    PRESS = "press"


@dataclass(frozen=True, slots=True)
class Cue:
    """Something to hear.

    Attributes:
        kind: which sound.
        words: the same in words, for speech.
    """

    kind: CueKind
    words: str


class CueFinder:
    """Compares each turn with the one before.

    *Press* is a gesture that begins, *accept* a
    binding that acts, *reject* one that does not, as with slow and bounce keys. While nothing acts,
    gestures are not heard.

    Args:
        mapping: what carries out the profile at the start.
    """

    def __init__(self, mapping: Mapping) -> None:
        self._state = mapping.state
        self._place = mapping.profile.name, mapping.layer
        self._last: MappingDecision | None = None
        self._gesture = GestureKind.NONE
        self._tracked = False
        self._take_new(mapping.decisions())

    def find(self, step: Step, mapping: Mapping) -> list[Cue]:
        """What is to be heard of ``step``, carried out by ``mapping``; mostly nothing.

        Only one sound can be played at a time, so the most important stands first.
        """
        heard: list[Cue | None] = [self._hear_state(mapping), self._hear_tracker(step)]
        acting = self._hear_layer(mapping), self._hear_decisions(mapping), self._hear_begin(step)
        if mapping.state == "running":
            heard += acting
        return [cue for cue in heard if cue is not None]

    def _hear_state(self, mapping: Mapping) -> Cue | None:
        before, self._state = self._state, mapping.state
        if self._state == before:
            return None
        match self._state:
            case "panic":
                return Cue(CueKind.PANIC, "stopped")
            case "paused":
                return Cue(CueKind.PAUSE, "paused")
        return Cue(CueKind.RESUME, "resumed")

    def _hear_tracker(self, step: Step) -> Cue | None:
        n_valid = np.count_nonzero(step.markers.valid)
        before = self._tracked
        self._tracked = bool(n_valid >= (_LOST if before else _FOUND))
        return Cue(CueKind.LOST, "gel lost") if before and not self._tracked else None

    def _hear_layer(self, mapping: Mapping) -> Cue | None:
        before, self._place = self._place, (mapping.profile.name, mapping.layer)
        if self._place == before:
            return None
        profile, layer = self._place
        words = f"profile {profile}" if profile != before[0] else f"layer {layer}"
        return Cue(CueKind.LAYER, words.replace("-", " "))

    def _hear_decisions(self, mapping: Mapping) -> Cue | None:
        new = self._take_new(mapping.decisions())
        for decision in reversed(new):
            if decision.verdict == "pressed":
                return Cue(CueKind.ACCEPT, decision.what.rsplit(" -> ", 1)[-1])
        for decision in reversed(new):
            if decision.verdict == "step":
                return Cue(CueKind.STEP, decision.why)
        if any(decision.verdict == "ignored" for decision in new):
            return Cue(CueKind.REJECT, "not accepted")
        return None

    def _hear_begin(self, step: Step) -> Cue | None:
        before, self._gesture = self._gesture, step.gesture.kind
        if before != GestureKind.NONE or self._gesture == GestureKind.NONE:
            return None
        return Cue(CueKind.PRESS, self._gesture.label.split("_", 1)[0])

    def _take_new(self, decisions: tuple[MappingDecision, ...]) -> list[MappingDecision]:
        """The decisions made since the last call; equal ones are told apart by identity."""
        new = []
        for decision in reversed(decisions):
            if decision is self._last:
                break
            new.append(decision)
        self._last = decisions[-1] if decisions else None
        return new[::-1]


def choose_volume(kind: CueKind, user: UserSettings, mapping: Mapping) -> int:
    """How loud the person wants a cue to be, in percent."""
    volumes = user.feedback.volume
    match kind:
        case CueKind.STEP:
            return volumes.press if volumes.accept is None else volumes.accept
        case CueKind.ACCEPT if volumes.accept is None:
            waits = resolve_times(mapping.profile.timing, user.timing).accept_ms > 0
            return ACCEPT_VOLUME if waits else 0
        case CueKind.PANIC | CueKind.RESUME:
            return volumes.pause
    return int(getattr(volumes, kind))
