"""Scripts of finger motion over time: the truth of a simulation, as plain records."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import GestureKind

FINGERTIP_RADIUS_MM = 6.5  # contact patch of a fingertip on soft gel; finite elements used 7
PRESS_US = 70_000  # touch-down time of a finger
SLIP_US = 45_000  # how long the finger slips when it releases
N_RIPPLES = 3  # sinusoids per tremor and drift


class Grasp(Protocol):
    """Fingers on the gel from touch to release."""

    @property
    def kind(self) -> GestureKind:
        """The gesture."""

    @property
    def fingers(self) -> "tuple[Finger, ...]":
        """The fingers, with their contacts at touch-down."""

    def move(self, t_us: int) -> NDArray[np.float64]:
        """Returns their places, (k, 4) float64: drag x, y in mm, turn in rad, press in mm."""


class Play(Protocol):
    """Motion on the gel: a script, or a hand that follows commands.

    ``find`` is called once for every knot of time, in order; a script also accepts earlier times.
    """

    @property
    def name(self) -> str:
        """The name, for people."""

    @property
    def duration_us(self) -> int:
        """Time until it ends or starts again."""

    @property
    def endless(self) -> bool:
        """True if it never ends."""

    def find(self, t_us: int) -> tuple[Grasp, int] | None:
        """Returns the grasp at work and the time within the play, or None at rest."""


@dataclass(frozen=True, slots=True)
class Finger:
    """One contact patch and its motion when the gesture is at its full size.

    The patch turns by ``turn_rad`` about ``pivot_mm`` and about itself, and moves by ``drag_mm``.

    Attributes:
        contact_mm: centre (x, y) of the patch on the undeformed gel.
        drag_mm: (x, y).
        turn_rad: clockwise for the user is positive.
        pivot_mm: centre (x, y) of the turn.
        press_mm: how deep it presses.
        radius_mm: radius of the patch.
        delay_us: how late it moves and releases.
        tremor_mm: amplitude of 8-12 Hz tremor.
        drift_mm: amplitude of slow wandering (0.2-0.7 Hz).
        seed: phases of tremor and drift.
        labelled: a person would label it; False for a part of the hand that only rests.
    """

    contact_mm: tuple[float, float]
    drag_mm: tuple[float, float] = (0.0, 0.0)
    turn_rad: float = 0.0
    pivot_mm: tuple[float, float] = (0.0, 0.0)
    press_mm: float = 1.5
    radius_mm: float = FINGERTIP_RADIUS_MM
    delay_us: int = 0
    tremor_mm: float = 0.0
    drift_mm: float = 0.0
    seed: int = 0
    labelled: bool = True


@dataclass(frozen=True, slots=True)
class Stroke:
    """One gesture: attack, hold, release.

    Attributes:
        kind: its label.
        fingers: one to three.
        start_us: when the first finger touches.
        attack_us, hold_us, release_us: length of each phase.
        slip: share of the motion lost at once when the finger releases.
        creep: share of the motion that returns slowly, as the gel relaxes.
        creep_us: time constant of that return.
    """

    kind: GestureKind
    fingers: tuple[Finger, ...]
    start_us: int = 0
    attack_us: int = 300_000
    hold_us: int = 600_000
    release_us: int = 300_000
    slip: float = 0.1
    creep: float = 0.1
    creep_us: int = 150_000

    @property
    def end_us(self) -> int:
        """The time at which the gel is back at rest."""
        late = max(finger.delay_us for finger in self.fingers)
        moving = PRESS_US + self.attack_us + self.hold_us + self.release_us
        return self.start_us + late + moving + 4 * self.creep_us

    def move(self, t_us: int) -> NDArray[np.float64]:
        """Returns the fingers' places, (k, 4) float64: drag x, y mm, turn rad, press mm."""
        return np.array([motion_at(self, finger, t_us) for finger in self.fingers])


@dataclass(frozen=True, slots=True)
class Script:
    """Strokes one after another, ascending in time and never overlapping.

    Attributes:
        name: for people.
        strokes: the gestures.
        duration_us: length of the script.
        endless: starts again at its end, for ever.
    """

    name: str
    strokes: tuple[Stroke, ...]
    duration_us: int
    endless: bool = False

    def find(self, t_us: int) -> tuple[Stroke, int] | None:
        """Returns the active stroke at ``t_us`` and the time within the script; None at rest."""
        t_us = t_us % self.duration_us if self.endless else t_us
        for stroke in self.strokes:
            if stroke.start_us <= t_us < stroke.end_us:
                return stroke, t_us
        return None


def sequence(
    name: str,
    *strokes: Stroke,
    rest_us: int = 600_000,
    gap_us: int = 400_000,
    endless: bool = False,
) -> Script:
    """Returns a script: a rest of ``rest_us``, then the strokes with ``gap_us`` after each."""
    t_us, placed = rest_us, []
    for stroke in strokes:
        placed.append(replace(stroke, start_us=t_us))
        t_us = placed[-1].end_us + gap_us
    return Script(name, tuple(placed), t_us, endless)


def motion_at(stroke: Stroke, finger: Finger, t_us: int) -> tuple[float, float, float, float]:
    """Returns a finger's place at ``t_us``: drag x, y in mm, turn in rad, press depth in mm."""
    begin_us = stroke.start_us + PRESS_US + finger.delay_us
    let_go_us = begin_us + stroke.attack_us + stroke.hold_us
    size = rise(t_us - begin_us, stroke.attack_us)
    touch = rise(t_us - stroke.start_us, PRESS_US)
    if t_us > let_go_us:
        touch = 1.0 - rise(t_us - let_go_us, stroke.release_us)
        size = _return(stroke, t_us - let_go_us)
    turn = finger.turn_rad * size
    c, s = math.cos(turn), math.sin(turn)
    x, y = (finger.contact_mm[i] - finger.pivot_mm[i] for i in (0, 1))
    wander_x, wander_y = _wander(finger, t_us)
    return (
        c * x - s * y - x + finger.drag_mm[0] * size + wander_x * touch,
        s * x + c * y - y + finger.drag_mm[1] * size + wander_y * touch,
        turn,
        finger.press_mm * touch,
    )


def rise(t_us: float, length_us: float) -> float:
    """Returns a minimum-jerk rise from 0 to 1: how a hand moves between two places."""
    s = min(max(t_us / length_us, 0.0), 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s)


def _return(stroke: Stroke, t_us: float) -> float:
    """Returns the share of the motion that is left ``t_us`` after the finger's release."""
    slipped = stroke.slip * rise(t_us, min(SLIP_US, stroke.release_us))
    swift = (1.0 - stroke.slip - stroke.creep) * rise(t_us, stroke.release_us)
    tail_us = stroke.release_us + 4.0 * stroke.creep_us
    tail = math.exp(-t_us / stroke.creep_us) - math.exp(-tail_us / stroke.creep_us)
    slow = stroke.creep * (1.0 - max(tail, 0.0) / (1.0 - math.exp(-tail_us / stroke.creep_us)))
    return 1.0 - slipped - swift - slow


def _wander(finger: Finger, t_us: int) -> tuple[float, float]:
    """Returns tremor and drift of a finger, (x, y) in mm."""
    if finger.tremor_mm == 0.0 and finger.drift_mm == 0.0:
        return 0.0, 0.0
    x = y = 0.0
    for amplitude, low_hz, high_hz, salt in (
        (finger.tremor_mm, 8.0, 12.0, 1),
        (finger.drift_mm, 0.2, 0.7, 2),
    ):
        for hz, phase_x, phase_y in _ripples(finger.seed, salt):
            turn = 2e-6 * math.pi * (low_hz + hz * (high_hz - low_hz)) * t_us
            x += amplitude / N_RIPPLES * math.sin(turn + phase_x)
            y += amplitude / N_RIPPLES * math.sin(turn + phase_y)
    return x, y


@lru_cache(maxsize=64)
def _ripples(seed: int, salt: int) -> Sequence[tuple[float, float, float]]:
    rows = np.random.default_rng((seed, salt)).random((N_RIPPLES, 3))
    return [(float(a), 2.0 * math.pi * float(b), 2.0 * math.pi * float(c)) for a, b, c in rows]
