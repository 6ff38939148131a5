"""Tremor: the filters against their design values, and no press that was not meant."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from neurotouch_hid.messages import Gesture, GestureKind
from neurotouch_hid.profile import Mapping, UserSettings
from neurotouch_hid.profile.engine.one_euro import FILTERS, OneEuro
from tests.profile.stage import make_profile

STEP_US = 10_000

DESIGN = {
    "light": ({4: 82, 5: 72, 6: 63, 8: 49, 10: 39}, 13, 12, 26),
    "medium": ({4: 36, 5: 28, 6: 22, 8: 16, 10: 12}, 40, 39, 72),
    "strong": ({4: 19, 5: 14, 6: 11, 8: 8, 10: 6}, 55, 57, 84),
}
"""By preset: percent of a tremor of 1 mm that is left, by its frequency in Hz; delay in ms of a
press at half its rise and of its release at 20 %; lag in ms on a slow ramp of 3 mm/s."""


def smooth(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    one_euro = OneEuro(*FILTERS[name])
    return np.array([one_euro.update(float(value), STEP_US) for value in values])


def cross(times: NDArray[np.float64], values: NDArray[np.float64], level: float) -> float:
    """When the values pass the level for the first time, by linear interpolation, in s."""
    above = (values >= level) == (values[-1] >= level)
    i = int(np.argmax(above & (np.arange(len(values)) > 0)))
    share = (level - values[i - 1]) / (values[i] - values[i - 1])
    return float(times[i - 1] + share * (times[i] - times[i - 1]))


@pytest.mark.parametrize("name", DESIGN)
def test_the_presets_leave_of_a_tremor_what_the_design_says(name: str) -> None:
    times = np.arange(0, 6, STEP_US * 1e-6)
    for hz, expected in DESIGN[name][0].items():
        left = smooth(name, 5.0 + np.sin(2 * np.pi * hz * times))[200:]
        assert 100 * np.ptp(left) / 2 == pytest.approx(expected, abs=3), (hz, name)


@pytest.mark.parametrize("name", DESIGN)
def test_the_presets_delay_as_the_design_says(name: str) -> None:
    _, rise_ms, release_ms, ramp_ms = DESIGN[name]
    times = np.arange(-0.5, 2.0, STEP_US * 1e-6)
    share = np.clip(times / 0.3, 0, 1)
    press = 5 * (10 * share**3 - 15 * share**4 + 6 * share**5)
    late = cross(times, smooth(name, press), 2.5) - cross(times, press, 2.5)
    assert 1e3 * late == pytest.approx(rise_ms, abs=3)
    release = 5.0 - press
    late = cross(times, smooth(name, release), 1.0) - cross(times, release, 1.0)
    assert 1e3 * late == pytest.approx(release_ms, abs=4)
    ramp = 3.0 * np.clip(times, 0, None)
    lag = (ramp - smooth(name, ramp))[-1] / 3.0
    assert 1e3 * lag == pytest.approx(ramp_ms, abs=4)


def test_a_new_zero_does_not_open_the_filter() -> None:
    times = np.arange(0, 3, STEP_US * 1e-6)
    tremor = np.sin(2 * np.pi * 5 * times)
    one_euro = OneEuro(*FILTERS["medium"])
    for value in 5.0 + tremor[:100]:
        one_euro.update(float(value), STEP_US)
    one_euro.reset(to=0.0)
    left = np.array([one_euro.update(float(value), STEP_US) for value in tremor[100:120]])
    assert np.ptp(left) / 2 < 0.5


@pytest.mark.parametrize("step_us", [0, -5, 1, 10**12])
def test_odd_steps_of_time_do_no_harm(step_us: int) -> None:
    one_euro = OneEuro(*FILTERS["light"])
    values = [one_euro.update(value, step_us) for value in (0.0, 5.0, -5.0, 60.0)]
    assert all(math.isfinite(value) and -5.0 <= value <= 60.0 for value in values)


def trembling(hold_mm: float, hz: float, swing_mm: float) -> list[Gesture]:
    """A press of 300 ms, a hold of 3 s with a tremor, a release; then rest."""
    gestures = []
    points = np.zeros((2, 2))
    for i in range(400):
        t = i * STEP_US * 1e-6
        share = min(1.0, t / 0.3, max(0.0, (3.6 - t) / 0.3))
        mm = hold_mm * (10 * share**3 - 15 * share**4 + 6 * share**5)
        mm = max(0.0, mm + swing_mm * share * math.sin(2 * math.pi * hz * t))
        kind = GestureKind.PUSH if mm >= 0.16 else GestureKind.NONE
        gestures.append(Gesture(i * STEP_US, kind, points, points, mm, (mm, 0.0)))
    return gestures


EVERY_WAY = [
    "when: push, do: {button: a}",
    "when: {gesture: push, press: tap}, do: {button: b}",
    "when: {gesture: push, press: double}, do: {button: x}",
    "when: {gesture: push, direction: left}, do: {button: y}",
    "when: {gesture: push, direction: up}, do: {button: lb}",
    "when: {sequence: [push, push]}, do: {button: rb}",
]


@pytest.mark.parametrize("hz", [4, 5, 6, 8, 10, 12])
@pytest.mark.parametrize("swing_mm", [0.2, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("hold_mm", [4.0, 5.0, 8.0])
def test_under_steady_a_tremor_on_a_hold_presses_once_and_nothing_else(
    hz: float, swing_mm: float, hold_mm: float
) -> None:
    mapping = Mapping(make_profile(*EVERY_WAY), UserSettings(timing="steady"))
    presses = []
    before: frozenset = frozenset()
    for gesture in trembling(hold_mm, hz, swing_mm):
        now = mapping.update(gesture).buttons
        presses += sorted(now - before)
        before = now
    assert presses == ["a"]
    assert not before


@pytest.mark.parametrize("hz", [4, 8, 12])
@pytest.mark.parametrize("swing_mm", [0.2, 1.0, 1.5])
def test_under_steady_a_tremor_at_rest_presses_nothing(hz: float, swing_mm: float) -> None:
    mapping = Mapping(make_profile(*EVERY_WAY), UserSettings(timing="steady"))
    assert not any(mapping.update(gesture).buttons for gesture in trembling(0.0, hz, swing_mm))


WAYS = [
    f"when: {{gesture: push, direction: {way}}}, do: {{dpad: {way}}}"
    for way in ("left", "right", "up", "down")
]


@pytest.mark.parametrize("hz", [4, 5, 8, 12])
@pytest.mark.parametrize("swing_mm", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("degrees", [0, 20, 45, 80])
def test_under_steady_a_tremor_across_a_push_keeps_its_direction(
    hz: float, swing_mm: float, degrees: float
) -> None:
    """The tremor goes across the push, at 45 degrees right between two directions."""
    mapping = Mapping(make_profile(*WAYS), UserSettings(timing="steady"))
    along = (math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
    points = np.zeros((1, 2))
    presses = []
    before: dict = {}
    for straight in trembling(5.0, hz, 0.0):
        mm = straight.intensity_mm
        side = swing_mm * mm / 5.0 * math.sin(2 * math.pi * hz * straight.t_us * 1e-6)
        way = (mm * along[0] - side * along[1], mm * along[1] + side * along[0])
        now = mapping.update(
            Gesture(straight.t_us, straight.kind, points, points, math.hypot(*way), way)
        ).axes
        presses += [axis for axis in now if axis not in before]
        before = dict(now)
    assert len(presses) == 1
