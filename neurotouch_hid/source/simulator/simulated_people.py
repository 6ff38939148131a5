"""Simulated people: each does the same gestures differently, with a set-up of their own."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator.config import (
    CameraConfig,
    GelConfig,
    LightConfig,
    SensorConfig,
    SimulatorConfig,
)
from neurotouch_hid.source.simulator.script import Finger, Stroke
from neurotouch_hid.source.simulator.strokes import (
    Fingertips,
    StrokeTiming,
    pinch,
    push,
    twist,
    zoom,
)

PEAK_SPEED = 1.875  # of a minimum-jerk motion, times its mean speed
TOP_SPEED_MM_S = 210.0  # [NT, "Dataset"]
REACH_MM = 22.0  # no gesture is made on the paper's rim [NT, figure of the contact points]
TWO_FINGER_PUSH = 0.07  # share of pushes with two fingers
MOST_TURN_RAD = 0.9  # how far a wrist turns with its fingers on something
THREE_FINGERS = 0.3  # share of the other gestures with three

# Mean and largest displacement of the contacts at full size, mm. Frames of attack and release pull
# the mean of all frames down to about three quarters [NT, figures of the intensity].
SIZES_MM = {
    GestureKind.PUSH: (8.5, 17.3),
    GestureKind.PINCH: (7.0, 14.0),
    GestureKind.ZOOM: (4.2, 9.0),
    GestureKind.TWIST_CW: (5.2, 13.0),
    GestureKind.TWIST_CCW: (5.2, 13.0),
}


@dataclass(frozen=True, slots=True)
class SimulatedPerson:
    """The traits of one simulated user.

    Attributes:
        weakest: strength of the weakest finger as a share of the strongest.
        delay_us: largest delay of the last finger.
        tremor_mm, drift_mm: see ``Finger``.
        radius_mm: of the fingertips' contact patches.
        press_mm: how deep the fingers press.
        haste: speed relative to others.
        reach_mm: no gesture is made farther from the middle of the gel.
        bias_mm: where the hand rests, (x, y); most are right-handed and rest right of the middle.
    """

    weakest: float = 0.7
    delay_us: int = 40_000
    tremor_mm: float = 0.12
    drift_mm: float = 0.25
    radius_mm: float = 6.5
    press_mm: float = 1.5
    haste: float = 1.0
    reach_mm: float = REACH_MM
    bias_mm: tuple[float, float] = (1.5, 0.0)


def meet_person(seed: int) -> tuple[SimulatedPerson, SimulatorConfig]:
    """Returns a person and the set-up this person uses; both differ from seed to seed."""
    rng = np.random.default_rng((seed, 11))
    person = SimulatedPerson(
        weakest=rng.uniform(0.45, 0.85),
        delay_us=int(rng.uniform(15_000, 80_000)),
        tremor_mm=rng.uniform(0.04, 0.25),
        drift_mm=rng.uniform(0.1, 0.5),
        radius_mm=rng.uniform(5.5, 7.5),
        press_mm=rng.uniform(0.6, 2.5),
        haste=rng.uniform(0.75, 1.3),
        bias_mm=(rng.normal(1.5, 0.7), rng.normal(0.0, 0.7)),
    )
    centre = (172.5 + rng.normal(0.0, 4.0), 129.5 + rng.normal(0.0, 4.0))
    rig = Rig(centre, rng.uniform(2.35, 2.65), rng.normal(0.0, math.radians(2.0)))
    config = SimulatorConfig(
        GelConfig(rng.uniform(0.03, 0.15), int(rng.uniform(50_000, 300_000))),
        CameraConfig(rig, rng.uniform(75.0, 120.0), rng.uniform(12.0, 17.0)),
        SensorConfig(
            contrast=rng.uniform(0.17, 0.25),
            cutoff_hz=rng.uniform(200.0, 500.0),
            shot_hz=float(10 ** rng.uniform(-1.0, 0.4)),
            n_hot=int(rng.integers(0, 15)),
            blur_px=rng.uniform(0.5, 0.8),
        ),
        LightConfig(
            white_dn=rng.uniform(140.0, 230.0),
            black_dn=rng.uniform(8.0, 24.0),
            uneven=rng.uniform(0.0, 0.6),
            uneven_rad=rng.uniform(-math.pi, math.pi),
            n_spots=int(rng.integers(0, 9)),
            seed=seed,
        ),
    )
    return person, config


def draw_stroke(
    kind: GestureKind, rng: np.random.Generator, person: SimulatedPerson | None = None
) -> Stroke:
    """Returns one gesture with the traits of ``person`` and random variation."""
    person = person or SimulatedPerson()
    mean_mm, most_mm = SIZES_MM[kind]
    size_mm = min(max(rng.gamma(3.0, mean_mm / 3.0), 0.8), most_mm)
    timing = StrokeTiming(
        _length_us(size_mm, person, rng),
        int(rng.gamma(3.0, 200_000)),
        _length_us(size_mm, person, rng),
    )
    middle = (
        float(rng.normal(person.bias_mm[0], 7.0)),
        float(rng.normal(person.bias_mm[1], 7.0)),
    )
    if kind == GestureKind.PUSH:
        stroke = _draw_push(size_mm, middle, timing, rng, person.reach_mm)
    else:
        stroke = _draw_hand(kind, size_mm, middle, timing, rng, person)
    strengths = rng.permutation([1.0, person.weakest, rng.uniform(person.weakest, 1.0)])
    if len(stroke.fingers) == 1:
        strengths[0] = 1.0
    fingers = tuple(
        _personal(finger, float(strength), rng, person)
        for finger, strength in zip(stroke.fingers, strengths, strict=False)
    )
    return replace(
        stroke,
        fingers=fingers,
        slip=float(rng.uniform(0.0, min(0.3, 3.0 / size_mm))),
        creep=float(rng.uniform(0.05, 0.2)),
        creep_us=int(rng.uniform(50_000, 300_000)),
    )


def _length_us(size_mm: float, person: SimulatedPerson, rng: np.random.Generator) -> int:
    """Returns an attack's or release's length; its top speed is Gaussian, as in the paper."""
    top = min(20.0 + abs(rng.normal(0.0, 65.0)) * person.haste, 0.97 * TOP_SPEED_MM_S)
    return int(min(max(PEAK_SPEED * size_mm / top, 0.1), 1.2) * 1e6)


def _draw_push(
    size_mm: float,
    at_mm: tuple[float, float],
    timing: StrokeTiming,
    rng: np.random.Generator,
    reach_mm: float,
) -> Stroke:
    direction = rng.uniform(-math.pi, math.pi)
    way = np.array([math.cos(direction), math.sin(direction)])
    at = _keep_inside(np.array(at_mm), 18.0)
    # A long push starts on the near side and ends before the rim.
    end = _keep_inside(at + size_mm * way, reach_mm)
    at = _keep_inside(end - size_mm * way, reach_mm)
    stroke = push(direction, size_mm, (float(at[0]), float(at[1])), timing)
    if rng.random() < TWO_FINGER_PUSH:
        side = 14.0 * np.array([-way[1], way[0]])
        if np.hypot(*(at + side)) > np.hypot(*(at - side)):
            side = -side
        second_mm = (float(at[0] + side[0]), float(at[1] + side[1]))
        second = replace(stroke.fingers[0], contact_mm=second_mm)
        stroke = replace(stroke, fingers=(*stroke.fingers, second))
    return stroke


def _draw_hand(
    kind: GestureKind,
    size_mm: float,
    middle_mm: tuple[float, float],
    timing: StrokeTiming,
    rng: np.random.Generator,
    person: SimulatedPerson,
) -> Stroke:
    n_fingers = 3 if rng.random() < THREE_FINGERS else 2
    closest = person.radius_mm * (1.05 if n_fingers == 2 else 1.2)  # fingertips do not overlap
    spread = closest + rng.uniform(0.0, 6.0)
    if kind == GestureKind.PINCH:
        spread = max(spread, closest - 1.0 + size_mm)
    elif kind == GestureKind.ZOOM:
        spread = closest + rng.uniform(0.0, 2.5)
    else:
        spread = max(spread, size_mm / MOST_TURN_RAD)
    spread = min(spread, 18.0)
    widest = spread + size_mm if kind == GestureKind.ZOOM else spread
    middle = _keep_inside(np.array(middle_mm), max(person.reach_mm - widest, 0.0))
    hand = Fingertips(
        (float(middle[0]), float(middle[1])), n_fingers, spread, rng.uniform(-math.pi, math.pi)
    )
    if kind == GestureKind.PINCH:
        return pinch(size_mm, hand, timing)
    if kind == GestureKind.ZOOM:
        return zoom(size_mm, hand, timing)
    sign = 1.0 if kind == GestureKind.TWIST_CW else -1.0
    return twist(sign * size_mm / spread, hand, timing)


def _personal(
    finger: Finger, strength: float, rng: np.random.Generator, person: SimulatedPerson
) -> Finger:
    return replace(
        finger,
        drag_mm=(finger.drag_mm[0] * strength, finger.drag_mm[1] * strength),
        turn_rad=finger.turn_rad * strength,
        press_mm=person.press_mm * rng.uniform(0.6, 1.4),
        radius_mm=person.radius_mm * rng.uniform(0.92, 1.08),
        delay_us=int(rng.uniform(0, person.delay_us)),
        tremor_mm=person.tremor_mm,
        drift_mm=person.drift_mm,
        seed=int(rng.integers(1 << 31)),
    )


def _keep_inside(point: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    r = float(np.hypot(*point))
    return point if r <= radius else point * (radius / r)
