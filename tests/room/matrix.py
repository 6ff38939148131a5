"""The conditions of ``make room``: a scene and what disturbs it."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator import Script, Simulator, Stroke, sequence
from neurotouch_hid.source.simulator.nuisances import read_nuisances
from neurotouch_hid.source.simulator.simulated_people import draw_stroke, meet_person

REST_US = 1_100_000  # before the first gesture, and between them
BUSY_US = 450_000  # between the gestures of someone who plays on
BUSY_MM = 4.0  # the largest of these
LEAST_MM, MOST_MM = 2.6, 9.0  # of a gesture
SLICE_US = 10_000
PEOPLE = 40_000  # seeds of people whom no other measurement meets
SCENES: Final = {
    "base": (6, REST_US, MOST_MM),
    "busy": (12, BUSY_US, BUSY_MM),
    "taps": (16, 300_000, 5.0),
}
"""Number of gestures, the time between them, the largest."""


@dataclass(frozen=True, slots=True)
class Condition:
    """One row of the table.

    Attributes:
        chapter: what it is about.
        name: how it is called.
        scene: what is played.
        nuisances: as a person writes them.
    """

    chapter: str
    name: str
    scene: str
    nuisances: tuple[str, ...]


def simulate(condition: Condition, seed: int, gel: Gel = PAPER_GEL) -> Simulator:
    """Returns the simulation of a condition: people, gestures and set-up come from the seed."""
    person, config = meet_person(PEOPLE + seed)
    config = replace(config, gel=replace(config.gel, layout=gel, elasticity="solid"))
    n, gap_us, most_mm = SCENES[condition.scene]
    rng = np.random.default_rng((seed, 20))
    kinds = [GestureKind.PUSH, *list(GestureKind)[1:]]
    strokes = list[Stroke]()
    while len(strokes) < n:
        kind = kinds[len(strokes) % len(kinds)]
        stroke = draw_stroke(kind, rng, person)
        if LEAST_MM <= _size_mm(stroke) <= most_mm:
            strokes.append(replace(stroke, hold_us=min(max(stroke.hold_us, 200_000), 700_000)))
    order = rng.permutation(n)
    script: Script = sequence(
        condition.name, *(strokes[i] for i in order), rest_us=REST_US, gap_us=gap_us
    )
    nuisances = read_nuisances(condition.nuisances)
    return Simulator(script, config, nuisances=nuisances, seed=seed, slice_us=SLICE_US)


def _size_mm(stroke: Stroke) -> float:
    """Returns how far the strongest finger goes."""
    return max(
        float(np.hypot(*finger.drag_mm))
        + abs(finger.turn_rad) * float(np.hypot(*np.subtract(finger.contact_mm, finger.pivot_mm)))
        for finger in stroke.fingers
    )


def _rows(chapter: str, *names: str, scene: str = "base") -> Iterable[Condition]:
    """Returns a row for each text: nuisances joined by ``+``; ``busy:`` chooses that scene."""
    for text in names:
        chosen, colon, rest = text.rpartition(":")
        nuisances = tuple(rest.split("+")) if rest else ()
        yield Condition(chapter, text or scene, chosen if colon else scene, nuisances)


CONDITIONS: Final = (
    *_rows("base", "base:", "busy:"),
    *_rows("LEDs by PWM", "pwm=10", "pwm=30", "pwm=100", "pwm-fast=30", "pwm-leak=6"),
    *_rows(
        "mains", "mains=5", "mains=20", "mains=40", "mains=20+frames=4", "mains=40+frames=4",
        "mains-leak=6", "mains-leak=15",
    ),
    *_rows("lamp and sun", "lamp=30", "lamp-leak=15", "sun=30"),
    *_rows("a hand's shadow", "shadow=10", "shadow=40", "shadow=70"),
    *_rows("glints", "glints=6", "glints=12"),
    *_rows(
        "dots", "missing=3", "missing=10", "missing=25", "faint=10", "faint=30", "painted=0.3",
        "painted=0.6", "irregular=30", "irregular=60", "dome=100",
    ),
    *_rows(
        "dust and fibres", "dust=15", "dust=60", "gel-dust=15", "gel-dust=60", "fibres=3",
        "gel-fibres=8", "scratches=5", "edge=5", "edge=20",
    ),
    *_rows(
        "optics", "lens=-10", "lens=-20", "lens=10", "lens=20", "tilt=5", "tilt=10", "blur=1.5",
        "blur=2.5", "scale=1.6", "scale=2.1", "scale=2.8", "scale=3.5", "scale=4.3",
        "rotation=8", "rotation=20", "rotation=44", "rotation=90", "decentring=20",
        "decentring=65", "decentring=130",
    ),
    *_rows(
        "exposure", "pale=3", "uneven=150", "overexposed=3", "underexposed=8", "frame-noise=8",
        "frame-noise=20",
    ),
    *_rows(
        "sensor", "hot=20", "hot=200", "noise=5", "noise=15", "mismatch=0.08", "threshold=0.15",
        "threshold=0.4", "readout=1", "readout=10", "readout=80", "lost=5", "lost=20",
    ),
    *_rows("frames", "frames=10", "frames=5", "frames=4", "frames=0", "late=30", "black=20"),
    *_rows(
        "mount", "bump=1", "bump=3", "bump=5", "busy:bump=1", "busy:bump=2", "creep=1",
        "busy:creep=3", "turn=3",
    ),
    *_rows("a gel that does not come back", "residue=1", "residue=3", "residue=5"),
    *_rows(
        "hands", "hand-on=0.5", "tips=4", "tips=1.5", "gloves=3", "palm=2", "slow=2",
        "taps:taps=60", "taps:taps=120", "fan=0.05", "fan=0.2", "music=0.1",
    ),
    *_rows("time", "jump=20", "pause=2"),
    *_rows("everything", "mild", "severe"),
)  # fmt: skip
"""All rows, in the order of the table."""
