"""What viewers are told of the line: counted in its thread, put in words in another."""

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from json.encoder import encode_basestring as quote
from statistics import median
from typing import Any, Final

from neurotouch_hid.messages import GamepadState, GestureKind, Step
from neurotouch_hid.monitor.summary import describe_turn
from neurotouch_hid.profile import MappingDecision
from neurotouch_hid.profile.engine.conditioned import ConditionedGesture
from neurotouch_hid.runtime import Session
from neurotouch_hid.snapshot import MarkerWriter, pack

SLOW_S: Final = 0.5
"""How often rates and times are worked out: nobody reads faster."""

Facts = Mapping[str, Callable[[], Any]]


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A step of the pipeline with what its mapping says, taken in the line's thread."""

    step: Step
    reading: ConditionedGesture
    decisions: tuple[MappingDecision, ...]
    state: str
    profile: str
    layer: str


@dataclass(slots=True)
class _Counts:
    """What has gone through since the start."""

    slices: int = 0
    events: int = 0
    frames: int = 0
    lost: int = 0
    rest_us: int | None = None
    late_s: float = 0.0


class StateEncoder:
    """Counts every turn, takes shots of some, and makes bytes of those.

    ``count`` and ``take`` belong to the line's thread and cost it microseconds; ``encode`` belongs
    to one other thread.

    Args:
        session: the running line.
        facts: what else is told, or told better, asked for again twice a second: ``source``,
            ``device``, ``file``.
    """

    def __init__(self, session: Session, facts: Facts) -> None:
        self._session, self._facts = session, facts
        self._counts = _Counts()
        self._earliest_s: float | None = None
        self._markers = MarkerWriter()
        self._n = 0
        self._window = (0.0, _Counts())
        self._slow = b"{}"
        self._told: tuple[MappingDecision, ...] = ()
        self._actions = b"[]"
        self._place: tuple[tuple[str, ...], bytes] = ((), b"")

    def count(self, step: Step) -> None:
        """Counts a step."""
        counts, packet = self._counts, step.packet
        counts.slices += 1
        counts.events += len(packet.events)
        counts.frames += len(packet.frames)
        counts.lost += packet.gap
        if step.rest is not None:
            counts.rest_us = step.rest.t_us
        # How much later than the promptest one a slice is done: what waits before the line.
        offset_s = time.monotonic() - 1e-6 * packet.t_end_us
        if self._earliest_s is None or offset_s < self._earliest_s:
            self._earliest_s = offset_s
        counts.late_s = offset_s - self._earliest_s

    def take(self, step: Step) -> Sample:
        """A shot of the turn that has just been done."""
        mapping = self._session.mapping
        return Sample(
            step,
            mapping.reading,
            mapping.decisions(),
            mapping.state,
            mapping.profile.name,
            mapping.layer,
        )

    def encode(self, shot: Sample) -> bytes:
        """The bytes of a shot, see ``snapshot``.

        The head holds ``n`` (counts up), ``t_us``, ``say`` (the sentence), ``state``, ``profile``,
        ``layer``, ``gesture``, ``pad``, ``actions`` (the latest decisions, oldest first) and
        ``slow`` (facts, rates and times, worked out twice a second).
        """
        now = time.monotonic()
        if now - self._window[0] >= SLOW_S:
            self._slow = _dump(self._measure(now, shot))
        if shot.decisions != self._told:
            self._told = shot.decisions
            self._actions = _dump([_write_decision(each) for each in shot.decisions])
        self._n += 1
        # By hand: the line's own thread waits for what is computed here, and json takes its time.
        head = b'{"n":%d,"t_us":%d,"say":%b,%b,"gesture":%b,"pad":%b,"actions":%b,"slow":%b}' % (
            self._n,
            shot.step.gesture.t_us,
            quote(describe_turn(shot.step, shot.state)).encode(),
            self._write_place(shot),
            _write_gesture(shot),
            _write_pad(shot.step.pad),
            self._actions,
            self._slow,
        )
        return pack(head, self._markers.write(shot.step.markers))

    def _write_place(self, shot: Sample) -> bytes:
        place = (shot.state, shot.profile, shot.layer)
        if place != self._place[0]:
            names = zip(("state", "profile", "layer"), place, strict=True)
            self._place = (place, _dump(dict(names))[1:-1])
        return self._place[1]

    def _measure(self, now: float, shot: Sample) -> dict[str, Any]:
        begun, before = self._window
        counts = _Counts(**{name: getattr(self._counts, name) for name in _Counts.__slots__})
        self._window = (now, counts)
        took_s = max(now - begun, 1e-3)
        step = shot.step
        rest_us = counts.rest_us
        return {
            "events_hz": round((counts.events - before.events) / took_s),
            "slices_hz": round((counts.slices - before.slices) / took_s),
            "frames_hz": round((counts.frames - before.frames) / took_s, 1),
            "lost": counts.lost,
            "backlog_ms": round(1e3 * counts.late_s, 1),
            "tracked": int(step.markers.valid.sum()),
            "rezero_s": None if rest_us is None else round(1e-6 * (step.gesture.t_us - rest_us), 1),
            "window_ms": 1e-3 * (step.packet.t_end_us - step.packet.t_begin_us),
            "stages": {
                name: _summarise(kept)
                for name, kept in self._session.timings.recent_ns().items()
                if kept
            },
            **{name: tell() for name, tell in self._facts.items()},
        }


def _write_gesture(shot: Sample) -> bytes:
    """The gesture as it is seen, and as the bindings are asked about it."""
    gesture, reading = shot.step.gesture, shot.reading
    movement = reading.kind.label
    if reading.kind == GestureKind.PUSH:
        movement = f"push_{reading.four}" if reading.four else "none"
    contacts = ",".join([f"[{x:.1f},{y:.1f}]" for x, y in gesture.contacts_mm.tolist()])
    return (
        f'{{"kind":"{gesture.kind.label}","mm":{gesture.intensity_mm:.2f},'
        f'"movement":"{movement}","felt_mm":{reading.mm:.2f},"phase":"{reading.phase}",'
        f'"contacts":[{contacts}],"confidence":{gesture.confidence:.2f},'
        f'"moved_mm":[{gesture.translation_mm[0]:.2f},{gesture.translation_mm[1]:.2f}],'
        f'"turned_rad":{gesture.rotation_rad:.3f},"scale":{gesture.scale:.3f}}}'
    ).encode()


def _summarise(kept_ns: list[int]) -> list[float]:
    """Median and 95 % in ms."""
    kept_ns.sort()
    most = kept_ns[min(int(0.95 * len(kept_ns)), len(kept_ns) - 1)]
    return [round(1e-6 * median(kept_ns), 3), round(1e-6 * most, 3)]


def _write_decision(decision: MappingDecision) -> list[Any]:
    return [decision.t_us, decision.verdict, decision.what, decision.why]


def _write_pad(pad: GamepadState) -> bytes:
    """All outputs; axes at rest are left out. Every name is a plain word."""
    axes = ",".join([f'"{axis.value}":{value:.3f}' for axis, value in pad.axes.items() if value])
    buttons, keys, mouse = (
        '","'.join(sorted(names)) for names in (pad.buttons, pad.keys, pad.mouse_buttons)
    )
    return (
        (
            f'{{"axes":{{{axes}}},"buttons":["{buttons}"],"keys":["{keys}"],"mouse":["{mouse}"],'
            f'"pointer":[{pad.pointer[0]:.0f},{pad.pointer[1]:.0f}],"wheel":{pad.wheel:.2f}}}'
        )
        .replace('[""]', "[]")
        .encode()
    )


def _dump(value: Any) -> bytes:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False).encode()
