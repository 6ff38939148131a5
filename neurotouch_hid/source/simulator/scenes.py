"""Named scripts for the demo, for tests and for trying things out: ``sim:NAME``.

The names are checked before the simulator is loaded, so nothing compiled is imported at the top.
"""

import difflib
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from neurotouch_hid.errors import SourceError
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.script import Script, Stroke, sequence
from neurotouch_hid.source.simulator.strokes import (
    Fingertips,
    StrokeTiming,
    pinch,
    press,
    push,
    twist,
    zoom,
)

FIELD_ENDING = ".csv"
"""A name with this ending is the file of a table of displacements."""

LEFT, RIGHT, UP, DOWN = math.pi, 0.0, -math.pi / 2, math.pi / 2

THREE = Fingertips(n_fingers=3, spread_mm=12.0)
CLOSE = Fingertips(n_fingers=3, spread_mm=8.5)


def scene_names() -> tuple[str, ...]:
    """Returns all names, in the order of the documentation."""
    return tuple(_SCENES)


def check_scene(name: str) -> None:
    """Checks that there is a scene of this name, or a file of a table.

    Raises:
        SourceError: there is none.
    """
    if name in _SCENES:
        return
    if name.endswith(FIELD_ENDING):
        if not Path(name).is_file():
            raise SourceError(
                f"There is no file '{name}'.",
                hint="Check the name. A table of displacements is a CSV file.",
            )
        return
    close = difflib.get_close_matches(name.lower(), _SCENES, 1)
    hint = f"Did you mean sim:{close[0]}?" if close else f"Scenes: {', '.join(_SCENES)}."
    if name == "mouse":  # as status calls it
        raise SourceError(
            "The mouse gel is a driver of its own, not a scene.",
            hint="Start it: neurotouch demo --mouse. What it sees is the source driver:.",
        )
    if not name:
        raise SourceError("'sim:' needs the name of a scene, for example sim:tour.", hint=hint)
    raise SourceError(f"There is no simulated scene called '{name}'.", hint=hint)


def read_simulation(text: str) -> tuple[str, dict[str, float]]:
    """Returns scene and nuisances of ``NAME[,NUISANCE[=STRENGTH]]...``.

    Raises:
        SourceError: there is no such scene or nuisance.
    """
    name, *nuisances = text.split(",")
    check_scene(name)
    if not nuisances:
        return name, {}
    # Few use them; all others start without.
    from neurotouch_hid.source.simulator.nuisances import read_nuisances  # noqa: PLC0415

    return name, read_nuisances(nuisances)


def find_scene(name: str) -> Script:
    """Returns the script called ``name``.

    Raises:
        SourceError: there is none of that name.
    """
    check_scene(name)
    return replace(_SCENES[name](), name=name)


def scene_config(name: str) -> SimulatorConfig:
    """Returns the set-up of a scene: the default one, but ``noise`` has a noisy sensor."""
    config = SimulatorConfig()
    if name == "noise":
        sensor = replace(config.sensor, shot_hz=5.0, n_hot=20, contrast_spread=0.05)
        return replace(config, sensor=sensor)
    return config


def _rest() -> Script:
    return Script("rest", (), 5_000_000, endless=True)


def _tour() -> Script:
    strokes = (
        push(UP, 7.0), push(RIGHT, 7.0), push(DOWN, 7.0), push(LEFT, 7.0),
        pinch(6.0), zoom(5.0), twist(0.5), twist(-0.5),
    )  # fmt: skip
    return sequence("tour", *(_lively(stroke, i) for i, stroke in enumerate(strokes)), endless=True)


def _lively(stroke: Stroke, seed: int) -> Stroke:
    """Returns the stroke with the flaws of a hand: tremor, drift, one finger late and weak."""
    fingers = tuple(
        replace(
            finger,
            tremor_mm=0.1,
            drift_mm=0.2,
            delay_us=25_000 * i,
            seed=10 * seed + i,
        )
        for i, finger in enumerate(stroke.fingers)
    )
    return replace(stroke, fingers=fingers)


def _fast() -> Script:
    quick = StrokeTiming(165_000, 300_000, 180_000)
    ways = ((LEFT, (9.0, 0.0)), (RIGHT, (-9.0, 0.0)), (UP, (0.0, 9.0)), (DOWN, (0.0, -9.0)))
    return sequence("fast", *(push(way, 18.0, at, quick) for way, at in ways))


def _three_fingers() -> Script:
    return sequence(
        "three-fingers",
        pinch(6.0, THREE), zoom(5.0, CLOSE), twist(0.5, THREE),
        twist(-0.5, THREE),
    )  # fmt: skip


def _random() -> Script:
    from neurotouch_hid.source.simulator.simulated_people import draw_stroke  # noqa: PLC0415

    rng = np.random.default_rng(7)
    kinds = list(GestureKind)[1:]
    strokes = [draw_stroke(kinds[int(rng.integers(len(kinds)))], rng) for _ in range(60)]
    return sequence("random", *strokes, endless=True)


def _single(stroke: Stroke) -> Callable[[], Script]:
    return lambda: sequence(stroke.kind.label, _lively(stroke, 0))


_SCENES: dict[str, Callable[[], Script]] = {
    "tour": _tour,
    "rest": _rest,
    "press": _single(press(4.0)),
    "push": _single(push(RIGHT, 7.0)),
    "push-left": _single(push(LEFT, 7.0)),
    "push-right": _single(push(RIGHT, 7.0)),
    "push-up": _single(push(UP, 7.0)),
    "push-down": _single(push(DOWN, 7.0)),
    "pinch": _single(pinch(6.0)),
    "zoom": _single(zoom(5.0)),
    "twist-cw": _single(twist(0.5)),
    "twist-ccw": _single(twist(-0.5)),
    "three-fingers": _three_fingers,
    "fast": _fast,
    "noise": lambda: replace(_tour(), name="noise"),
    "random": _random,
}
