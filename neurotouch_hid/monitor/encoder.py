"""What viewers are told of the pipeline: a sample taken in its thread, put in words in another."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any, Final, cast

from neurotouch_hid.messages import GamepadState, GestureKind, Step
from neurotouch_hid.monitor.sentence import describe_step
from neurotouch_hid.profile import MappingDecision
from neurotouch_hid.profile.engine.conditioned import ConditionedGesture
from neurotouch_hid.profile.schema.timing import resolve_times
from neurotouch_hid.runtime import Session
from neurotouch_hid.snapshot import GestureState, Health, MarkerWriter, PadState, State, pack

SLOW_S: Final = 0.5
"""How often facts, rates and times are worked out: nobody reads faster."""

Facts = Mapping[str, Callable[[], Any]]


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A step of the pipeline with what its mapping says, taken in the pipeline's thread."""

    step: Step
    reading: ConditionedGesture
    decisions: tuple[MappingDecision, ...]
    state: str
    profile: str
    layer: str


class StateEncoder:
    """Takes samples of the pipeline, and makes bytes of them.

    ``take`` belongs to the pipeline's thread and costs it microseconds; ``encode`` belongs to one
    other thread.

    Args:
        session: the running pipeline.
        facts: what else is told, or told better, asked for again twice a second: ``source``,
            ``simulated``, ``device``, ``file``.
    """

    def __init__(self, session: Session, facts: Facts) -> None:
        self._session, self._facts = session, facts
        self._markers = MarkerWriter()
        self._n = 0
        self._health: Health | None = None
        self._health_s = 0.0

    def take(self, step: Step) -> Sample:
        """Returns a sample of the step that has just been finished."""
        mapping = self._session.mapping
        return Sample(
            step,
            mapping.reading,
            mapping.decisions(),
            mapping.state,
            mapping.profile.name,
            mapping.layer,
        )

    def encode(self, sample: Sample) -> bytes:
        """Returns the bytes of a sample, see ``snapshot``."""
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
            "gesture": _describe_gesture(sample),
            "pad": _describe_pad(sample.step.pad),
            "actions": [
                (each.t_us, each.verdict, each.what, each.why) for each in sample.decisions
            ],
            "slow": self._health,
        }
        return pack(state, self._markers.write(sample.step.markers))

    def _measure(self, step: Step) -> Health:
        meter, mapping = self._session.meter, self._session.mapping
        counts, rates = meter.counts, meter.rates
        rest_us, packet = counts.rest_us, step.packet
        health: dict[str, Any] = {
            "events_hz": round(rates.events_hz),
            "slices_hz": round(rates.slices_hz),
            "frames_hz": round(rates.frames_hz, 1),
            "lost": counts.lost,
            "backlog_ms": round(1e3 * counts.late_s, 1),
            "tracked": int(step.markers.valid.sum()),
            "rezero_s": None if rest_us is None else round(1e-6 * (step.gesture.t_us - rest_us), 1),
            "accept_ms": resolve_times(mapping.profile.timing, self._session.user.timing).accept_ms,
            "window_ms": 1e-3 * (packet.t_end_us - packet.t_begin_us),
            "stages": {
                name: _summarise(kept)
                for name, kept in self._session.timings.recent_ns().items()
                if kept
            },
            **{name: tell() for name, tell in self._facts.items()},
        }
        return cast(Health, health)


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
