"""Conditions each gesture for the bindings.

orientation ─ unused ─ notch ─ filter ─ range ─ onset and latch ─ direction, zone, ...

The order is fixed: the person's orientation comes first, then the tremor filter (in real
millimetres), then the conversion to the reference hand, so that thresholds count in its mm.
"""

import math
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.messages import Gesture, GestureKind
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.notch import Notch, TremorWatch
from neurotouch_hid.profile.engine.one_euro import FILTERS, OneEuro
from neurotouch_hid.profile.engine.personal_range import make_conversion
from neurotouch_hid.profile.engine.regions import Vector, choose_direction, find_zone
from neurotouch_hid.profile.schema.conditions import Zone
from neurotouch_hid.profile.schema.targets import EightWay
from neurotouch_hid.profile.schema.timing import FilterName
from neurotouch_hid.profile.schema.user import UserSettings
from neurotouch_hid.vocabulary import Phase

MOST_MM: Final = 60.0
"""No displacement is larger than the gel; what claims to be is cut, so that sums stay finite."""

LATCH_MM: Final = 2.5
UNLATCH_MM: Final = 1.5
"""The type of a gesture is kept from where it is right in more than 90 % of cases [NT, "Results"]
until the gesture is nearly over."""

ONSET_US: Final = 70_000
"""How long a beginning gesture is watched where a push could still become something else: "a push
is often reported first, before a two-finger gesture has formed" [NT, "Results"]."""

PHASE_BEGIN_MM_S: Final = 20.0
PHASE_END_MM_S: Final = 8.0
"""From which speed on an intensity rises or falls, and below which it no longer does."""

_SPEED_TURN: Final = 2.0 * math.pi * 5.0  # of a low-pass of 5 Hz, per second
_PUSHES: Final = ("push_left", "push_right", "push_up", "push_down")
_MIRRORED: Final = {
    GestureKind.TWIST_CW: GestureKind.TWIST_CCW,
    GestureKind.TWIST_CCW: GestureKind.TWIST_CW,
}


@dataclass(slots=True)
class _Memory:
    """Memory of one gesture until it ends; the names are those of the conditioned gesture."""

    kind: GestureKind | None = None  # the latched one
    onset_us: int | None = None
    seen: bool = False
    four: EightWay | None = None
    eight: EightWay | None = None
    zone: Zone | None = None
    way: Vector | None = None  # of the push, while it looks like one
    mm: float = 0.0
    speed: float = 0.0
    top_speed: float = 0.0
    phase: Phase = "hold"


class InputConditioner:
    """Conditions gestures; its memory ends with each of them.

    Args:
        user: the person's own values.
        filter_name: the tremor filter.
        bound: the kinds of gestures any binding waits for.
        latch: keep the kind until the gesture ends.

    Attributes:
        t_us: the moment of the gesture before.
    """

    def __init__(
        self,
        user: UserSettings,
        filter_name: FilterName,
        bound: frozenset[GestureKind],
        *,
        latch: bool,
    ) -> None:
        angle = math.radians(user.rotate_deg)
        self._cos, self._sin = math.cos(angle), math.sin(angle)
        self._mirror = user.mirror
        self._turned = user.rotate_deg != 0.0 or user.mirror
        self._convert = make_conversion(user.range)
        constants = FILTERS.get(filter_name)
        self._filters = [OneEuro(*constants) for _ in range(3)] if constants else []
        hz = user.tremor_hz
        self._notches = [Notch(hz) for _ in range(3)] if hz is not None else []
        self._watch = TremorWatch(hz) if hz is not None else None
        self._unused = frozenset(user.unused)
        self._made = frozenset(kind for kind in GestureKind if self._is_made(kind))
        self._bound = bound & self._made
        self._latch = latch
        self._watches_onset = GestureKind.PUSH in self._bound and len(self._bound) > 1
        self.t_us: int | None = None
        self._memory = _Memory()
        self._is_fresh = True

    @property
    def at_rest(self) -> bool:
        """True if no gesture is there, nor one that begins."""
        return self._memory.onset_us is None

    def forget(self) -> None:
        """Starts again, as if the hand had been lifted."""
        self._memory, self._is_fresh = _Memory(), True
        for smooth in self._filters:
            smooth.reset()
        for notch in self._notches:
            notch.reset()
        if self._watch is not None:
            self._watch.reset()

    def read(self, gesture: Gesture) -> ConditionedGesture:
        """Returns the conditioned gesture; at rest if a measurement is not a number."""
        step_us = 0 if self.t_us is None else gesture.t_us - self.t_us
        self.t_us = gesture.t_us
        kind, mm = gesture.kind, float(gesture.intensity_mm)
        if kind == GestureKind.NONE or not math.isfinite(mm):
            if not self._is_fresh:
                self.forget()
            return ConditionedGesture(gesture.t_us)
        self._is_fresh = False
        mm = min(max(mm, 0.0), MOST_MM)
        if self._mirror:
            kind = _MIRRORED.get(kind, kind)
        x, y = self._orient(gesture.translation_mm)
        if kind == GestureKind.PUSH and self._unused:
            mm, x, y = self._leave_out(mm, x, y)
        if self._watch is not None:
            mm, x, y = self._take_out(self._watch, (mm, x, y), step_us)
        if self._filters:
            of_mm, of_x, of_y = self._filters
            mm = of_mm.update(mm, step_us)
            x, y = of_x.update(x, step_us), of_y.update(y, step_us)
        seen, kind = kind, self._memory.kind or kind
        if kind not in self._made:
            return ConditionedGesture(gesture.t_us)
        if seen == GestureKind.PUSH:
            self._memory.way = _find_way(x, y)
        way = self._memory.way if kind == GestureKind.PUSH else None
        if self._convert is not None:
            mm = self._convert(kind, mm, way)
        self._measure_speed(mm, step_us)
        if not self._decide(kind, mm, gesture.t_us):
            return ConditionedGesture(gesture.t_us)
        return self._describe(gesture, kind, mm, way)

    def _orient(self, vector: Vector) -> Vector:
        """Returns a vector of the gel as the person sees it; (0, 0) if it is not a number."""
        x, y = vector
        if not (-MOST_MM <= x <= MOST_MM and -MOST_MM <= y <= MOST_MM):
            if not (math.isfinite(x) and math.isfinite(y)):
                return 0.0, 0.0
            x = min(max(x, -MOST_MM), MOST_MM)
            y = min(max(y, -MOST_MM), MOST_MM)
        if not self._turned:
            return x, y
        x, y = x * self._cos - y * self._sin, x * self._sin + y * self._cos
        return (-x if self._mirror else x), y

    def _take_out(
        self, watch: TremorWatch, values: tuple[float, float, float], step_us: int
    ) -> tuple[float, float, float]:
        """Returns the values without the person's own tremor."""
        hz = watch.update(values[0], step_us)
        if hz is not None:
            for notch in self._notches:
                notch.tune(hz)
        mm, x, y = (
            notch.update(value, step_us) for notch, value in zip(self._notches, values, strict=True)
        )
        return max(mm, 0.0), x, y

    def _is_made(self, kind: GestureKind) -> bool:
        """Returns False of a gesture the person does not make: it must be a mistake."""
        if kind == GestureKind.PUSH:
            return not self._unused.issuperset(_PUSHES)
        return kind.label not in self._unused

    def _leave_out(self, mm: float, x: float, y: float) -> tuple[float, float, float]:
        """Returns a push without its part in a direction that is not used."""
        left_x = 0.0 if ("push_left" if x < 0.0 else "push_right") in self._unused else x
        left_y = 0.0 if ("push_up" if y < 0.0 else "push_down") in self._unused else y
        length = math.hypot(x, y)
        share = math.hypot(left_x, left_y) / length if length > 0.0 else 1.0
        return mm * share, left_x, left_y

    def _measure_speed(self, mm: float, step_us: int) -> None:
        memory = self._memory
        step_s = min(max(step_us, 1_000), 50_000) * 1e-6
        turn = _SPEED_TURN * step_s
        speed = memory.speed + turn / (turn + 1.0) * ((mm - memory.mm) / step_s - memory.speed)
        memory.speed, memory.mm = speed, mm
        memory.top_speed = max(memory.top_speed, speed)
        if speed > PHASE_BEGIN_MM_S:
            memory.phase = "attack"
        elif speed < -PHASE_BEGIN_MM_S:
            memory.phase = "release"
        elif abs(speed) < PHASE_END_MM_S:
            memory.phase = "hold"

    def _decide(self, kind: GestureKind, mm: float, t_us: int) -> bool:
        """Returns True once it is clear what the gesture is.

        Latches it as far as the profile wants.
        """
        memory = self._memory
        if memory.onset_us is None:
            memory.onset_us = t_us
        if (
            self._watches_onset
            and not memory.seen
            and mm < LATCH_MM
            and t_us - memory.onset_us < ONSET_US
        ):
            return False
        memory.seen = True
        if self._latch and mm >= LATCH_MM and kind in self._bound:
            memory.kind = kind
        elif mm < UNLATCH_MM:
            memory.kind = None
        return True

    def _describe(
        self, gesture: Gesture, kind: GestureKind, mm: float, way: Vector | None
    ) -> ConditionedGesture:
        memory = self._memory
        memory.four = choose_direction(way, memory.four, 4)
        memory.eight = choose_direction(way, memory.eight, 8)
        position = self._find_position(gesture)
        if position is not None and memory.zone is None:
            x, y = self._orient(gesture.translation_mm)
            memory.zone = find_zone(position[0] - x, position[1] - y)
        return ConditionedGesture(
            gesture.t_us,
            kind,
            mm,
            way,
            memory.four,
            memory.eight,
            memory.zone,
            position,
            len(gesture.contacts_mm),
            memory.speed,
            memory.top_speed,
            memory.phase,
        )

    def _find_position(self, gesture: Gesture) -> Vector | None:
        """Returns the mean of the contacts."""
        points = gesture.contacts_mm.tolist()
        if not points:
            return None
        x, y, n = 0.0, 0.0, len(points)
        for x_mm, y_mm in points:
            x += x_mm
            y += y_mm
        if not math.isfinite(x + y):
            return None
        return self._orient((x / n, y / n))


def _find_way(x: float, y: float) -> Vector | None:
    length = math.hypot(x, y)
    return (x / length, y / length) if length > 0.0 else None
