"""Encodes the pipeline's state for viewers: one thread samples it, another encodes the sample."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Final

from neurotouch_hid.driver_state import (
    Facts,
    GestureState,
    Health,
    MarkerWriter,
    PadState,
    SourceFacts,
    State,
    pack,
)
from neurotouch_hid.gel_sentences import report_gel
from neurotouch_hid.messages import GamepadState, GelState, GestureKind, Step
from neurotouch_hid.monitor.sentence import describe_step
from neurotouch_hid.profile import MappingDecision
from neurotouch_hid.profile.engine import ConditionedGesture
from neurotouch_hid.profile.schema import resolve_times
from neurotouch_hid.runtime import PipelineControl
from neurotouch_hid.status import GelFacts
from neurotouch_hid.vocabulary import PipelineState

SLOW_S: Final = 0.5
"""Interval at which facts, rates and times are updated: people do not read faster."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A step of the pipeline with the state of its mapping, taken in the pipeline's thread."""

    step: Step
    reading: ConditionedGesture
    decisions: tuple[MappingDecision, ...]
    state: PipelineState
    profile: str
    layer: str


class StateEncoder:
    """Takes samples of the pipeline, and encodes them.

    ``take`` belongs to the pipeline's thread and costs it microseconds; ``encode`` belongs to one
    other thread.

    Args:
        control: the running pipeline.
        tell_facts: returns the facts about what surrounds it; called twice a second.
        tell_source: returns the facts that only some sources know; called as often.
    """

    def __init__(
        self,
        control: PipelineControl,
        tell_facts: Callable[[], Facts],
        tell_source: Callable[[], SourceFacts] = SourceFacts,
    ) -> None:
        self._control = control
        self._tell_facts, self._tell_source = tell_facts, tell_source
        self._markers = MarkerWriter()
        self._n = 0
        self._gel: tuple[GelState, GelFacts] | None = None
        self._health: Health | None = None
        self._health_s = 0.0

    def take(self, step: Step) -> Sample:
        """Returns a sample of the step that has just finished."""
        mapping = self._control.mapping
        return Sample(
            step,
            mapping.reading,
            mapping.decisions(),
            mapping.state,
            mapping.profile.name,
            mapping.layer,
        )

    def encode(self, sample: Sample) -> bytes:
        """Returns the bytes of a sample, see ``driver_state``."""
        now = time.monotonic()
        if self._health is None or now - self._health_s >= SLOW_S:
            self._health, self._health_s = self._measure(sample.step), now
        self._n += 1
        state: State = {
            "n": self._n,
            "t_us": sample.step.gesture.t_us,
            "say": describe_step(sample.step, sample.state),
            "state": sample.state,
            "profile": sample.profile,
            "layer": sample.layer,
            "gel": self._report_gel(sample.step.gel),
            "gesture": _describe_gesture(sample),
            "pad": _describe_pad(sample.step.pad),
            "actions": [
                (each.t_us, each.verdict, each.what, each.why) for each in sample.decisions
            ],
            "slow": self._health,
        }
        return pack(state, self._markers.write(sample.step.markers))

    def _report_gel(self, gel: GelState) -> GelFacts:
        """Returns the facts about the gel, which change seldom."""
        if self._gel is None or self._gel[0] is not gel:
            self._gel = gel, report_gel(gel)
        return self._gel[1]

    def _measure(self, step: Step) -> Health:
        meter, mapping = self._control.meter, self._control.mapping
        counts, rates = meter.counts, meter.rates
        rest_us, packet = counts.rest_us, step.packet
        return {
            "events_hz": round(rates.events_hz),
            "slices_hz": round(rates.slices_hz),
            "frames_hz": round(rates.frames_hz, 1),
            "lost": counts.lost,
            "backlog_ms": round(1e3 * counts.late_s, 1),
            "tracked": int(step.markers.valid.sum()),
            "rezero_s": None if rest_us is None else round(1e-6 * (step.gesture.t_us - rest_us), 1),
            "accept_ms": resolve_times(mapping.profile.timing, self._control.user.timing).accept_ms,
            "window_ms": 1e-3 * (packet.t_end_us - packet.t_begin_us),
            "stages": {
                name: _summarise(kept)
                for name, kept in self._control.timings.recent_ns().items()
                if kept
            },
            **self._tell_facts(),
            **self._tell_source(),
        }


def _describe_gesture(sample: Sample) -> GestureState:
    gesture, reading = sample.step.gesture, sample.reading
    movement = reading.kind.label
    if reading.kind == GestureKind.PUSH:
        movement = f"push_{reading.four}" if reading.four else "none"
    x_mm, y_mm = gesture.translation_mm
    return {
        "kind": gesture.kind.label,
        "mm": round(gesture.intensity_mm, 2),
        "movement": movement,
        "felt_mm": round(reading.mm, 2),
        "phase": reading.phase,
        "contacts": [[round(x, 1), round(y, 1)] for x, y in gesture.contacts_mm.tolist()],
        "confidence": round(gesture.confidence, 2),
        "moved_mm": [round(x_mm, 2), round(y_mm, 2)],
        "turned_rad": round(gesture.rotation_rad, 3),
        "scale": round(gesture.scale, 3),
    }


def _describe_pad(pad: GamepadState) -> PadState:
    return {
        "axes": {axis.value: round(value, 3) for axis, value in pad.axes.items() if value},
        "buttons": sorted(pad.buttons),
        "keys": sorted(pad.keys),
        "mouse": sorted(pad.mouse_buttons),
        "pointer": [round(speed) for speed in pad.pointer],
        "wheel": round(pad.wheel, 2),
    }


def _summarise(kept_ns: list[int]) -> list[float]:
    """Returns median and 95 % in ms."""
    kept_ns.sort()
    most = kept_ns[min(int(0.95 * len(kept_ns)), len(kept_ns) - 1)]
    return [round(1e-6 * median(kept_ns), 3), round(1e-6 * most, 3)]
