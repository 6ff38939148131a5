"""Measures the tremor filters beside the figures of their design, and the cost of a profile.

Signals are made, not measured: a tremor of 1 mm while 5 mm are held, a press of 5 mm within 300 ms
along a minimum-jerk path, its release, and a slow ramp of 3 mm/s, all at 100 Hz.
"""

import time
from collections.abc import Mapping as Table
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.profile import Mapping, rehearse
from neurotouch_hid.profile.engine import FILTERS, Notch, OneEuro
from neurotouch_hid.profile.reading import parse_profile

STEP_US: Final = 10_000
HOLD_MM: Final = 5.0
PRESS_S: Final = 0.3
RAMP_MM_S: Final = 3.0
GOAL_MS: Final = 0.05
"""Limit for the cost of the profile stage in a slice of 10 ms, with 60 bindings."""

N_BINDINGS: Final = 60


@dataclass(frozen=True, slots=True)
class Steadiness:
    """Figures of a filter.

    Attributes:
        left: percent of a tremor that is left, by its frequency in Hz.
        press_ms: delay of half of a press.
        release_ms: delay at which a release falls below 20 %.
        ramp_ms: lag on a slow ramp.
    """

    left: Table[int, float]
    press_ms: float
    release_ms: float
    ramp_ms: float


NOTCHED: Final = "medium with 5 Hz taken out"

DESIGN: Final[Table[str, Steadiness]] = MappingProxyType(
    {
        "light": Steadiness({4: 82, 5: 72, 6: 63, 8: 49, 10: 39}, 13, 12, 26),
        "medium": Steadiness({4: 36, 5: 28, 6: 22, 8: 16, 10: 12}, 40, 39, 72),
        "strong": Steadiness({4: 19, 5: 14, 6: 11, 8: 8, 10: 6}, 55, 57, 84),
        NOTCHED: Steadiness({4: 8, 5: 0, 6: 4, 8: 8, 10: 9}, 87, 101, 117),
    }
)
"""The design values of the presets, from a simulation outside this program."""


def measure_filter(name: str) -> Steadiness:
    """Returns the figures of the filter of this name in ``DESIGN``."""
    times = np.arange(-0.5, 6.0, STEP_US * 1e-6)
    share = np.clip(times / PRESS_S, 0.0, 1.0)
    press = HOLD_MM * (10 * share**3 - 15 * share**4 + 6 * share**5)
    release = HOLD_MM - press
    ramp = RAMP_MM_S * np.clip(times, 0.0, None)
    left = {}
    for hz in DESIGN["light"].left:
        swing = _smooth(name, HOLD_MM + np.sin(2 * np.pi * hz * times))[250:]  # once it is settled
        left[hz] = 100.0 * float(np.ptp(swing)) / 2.0
    return Steadiness(
        left,
        1e3 * (_cross(times, _smooth(name, press), 2.5) - _cross(times, press, 2.5)),
        1e3 * (_cross(times, _smooth(name, release), 1.0) - _cross(times, release, 1.0)),
        1e3 * float((ramp - _smooth(name, ramp))[-1]) / RAMP_MM_S,
    )


def _smooth(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    notch, preset = (Notch(5.0), "medium") if name == NOTCHED else (None, name)
    one_euro = OneEuro(*_CONSTANTS[preset])
    steady = [v if notch is None else notch.update(v, STEP_US) for v in values.tolist()]
    return np.array([one_euro.update(value, STEP_US) for value in steady])


def _cross(times: NDArray[np.float64], values: NDArray[np.float64], level: float) -> float:
    """Returns when the values first pass the level, by linear interpolation, in s."""
    above = (values >= level) == (values[-1] >= level)
    i = int(np.argmax(above & (np.arange(len(values)) > 0)))
    share = (level - values[i - 1]) / (values[i] - values[i - 1])
    return float(times[i - 1] + share * (times[i] - times[i - 1]))


def measure_engine(repetitions: int = 20) -> dict[str, float]:
    """Returns the cost of the profile stage a slice, with 60 bindings and the filter ``medium``.

    Returns:
        ``median`` and ``p99`` in ms, over every gesture held and tapped.
    """
    ways = ("left", "right", "up", "down")
    places = [f"gesture: push, direction: {way}" for way in ways]
    places += [f"gesture: {name}" for name in ("pinch", "zoom", "twist_cw", "twist_ccw")]
    whens = [f"{{{place}, press: {press}}}" for place in places for press in _PRESSES]
    lines = [f"  - {{when: {when}, do: {{key: f{1 + i % 24}}}}}" for i, when in enumerate(whens)]
    lines += [f"  - {{when: {when}, do: {{button: a}}}}" for when in whens]
    lines = ["  - {when: push, do: {stick: left}}", *lines][:N_BINDINGS]
    text = "\n".join(["version: 1", "name: sixty", "filter: medium", "bindings:", *lines])
    mapping = Mapping(parse_profile(text.encode(), "sixty"))
    script = "; ".join(
        f"{name} 6mm 200ms hold 1s; rest 300ms; {name} 6mm tap; rest 300ms"
        for name in (*(f"push {way}" for way in ways), "pinch", "zoom", "twist_cw", "twist_ccw")
    )
    costs = []
    for _ in range(repetitions):
        for gesture in rehearse(script):
            begun = time.perf_counter()
            mapping.update(gesture)
            costs.append(1e3 * (time.perf_counter() - begun))
    return {
        "median": float(np.median(costs)),
        "p99": float(np.percentile(costs, 99)),
        "bindings": float(len(lines)),
    }


_CONSTANTS: Final = {str(name): constants for name, constants in FILTERS.items()}
_PRESSES: Final = ("tap", "hold", "long", "double")
