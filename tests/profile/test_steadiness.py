"""Tremor: the filters against their design values, and no press that was not meant."""

import math

import numpy as np
import pytest
from neurotouch_devtools.bench.steadiness import DESIGN, measure_filter
from scipy import signal

from neurotouch_hid.messages import Axis, Gesture, GestureKind
from neurotouch_hid.profile import Mapping, UserSettings
from neurotouch_hid.profile.engine.notch import QUALITY, Notch, TremorWatch
from neurotouch_hid.profile.engine.one_euro import FILTERS, OneEuro
from tests.profile.stage import make_profile

STEP_US = 10_000


@pytest.mark.parametrize("name", DESIGN)
def test_the_presets_leave_and_delay_what_the_design_says(name: str) -> None:
    measured, design = measure_filter(name), DESIGN[name]
    for hz, percent in design.left.items():
        assert measured.left[hz] == pytest.approx(percent, abs=3), (hz, name)
    assert measured.press_ms == pytest.approx(design.press_ms, abs=3)
    assert measured.release_ms == pytest.approx(design.release_ms, abs=4)
    assert measured.ramp_ms == pytest.approx(design.ramp_ms, abs=4)


@pytest.mark.parametrize("step_us", [3_000, 10_000, 30_000])
def test_a_notch_agrees_with_the_one_of_scipy(step_us: int) -> None:
    rng = np.random.default_rng(1)
    values = rng.normal(5.0, 1.0, 200)
    b, a = signal.iirnotch(5.0, QUALITY, 1e6 / step_us)
    begun = signal.lfilter_zi(b, a) * values[0]
    expected, _ = signal.lfilter(b, a, values, zi=begun)
    # SciPy's width is that of the bilinear transform, the cookbook's that of the sine
    notch = Notch(5.0)
    assert np.corrcoef([notch.update(v, step_us) for v in values], expected)[0, 1] > 0.98
    still = Notch(5.0)
    assert [still.update(4.0, step_us) for _ in range(50)] == pytest.approx([4.0] * 50)


@pytest.mark.parametrize("choices_us", [(1_000, 4_000), (1_000, 1_000, 9_000), (700, 9_300)])
def test_steps_of_uneven_lengths_are_as_good(choices_us: tuple[int, ...]) -> None:
    """A live driver's slices are shorter while the hand moves."""
    rng = np.random.default_rng(1)
    steps_us = rng.choice(choices_us, 3000)
    times_s = np.cumsum(steps_us) * 1e-6
    values = 5.0 + np.sin(2 * np.pi * 5.0 * times_s)
    notch, watch = Notch(5.0), TremorWatch(4.5)
    pairs = list(zip(values, map(int, steps_us), strict=True))
    settled = [notch.update(*pair) for pair in pairs][500:]
    assert np.ptp(settled) < 0.05
    found = [hz for pair in pairs if (hz := watch.update(*pair)) is not None]
    assert found
    assert found == pytest.approx([5.0] * len(found), abs=0.2)


def test_the_tremor_is_followed_as_it_drifts_but_not_beyond() -> None:
    def find(hz: float, swing_mm: float = 1.0) -> list[float]:
        watch = TremorWatch(5.0)
        times = np.arange(0, 7, STEP_US * 1e-6)
        found = [
            watch.update(5.0 + swing_mm * math.sin(2 * math.pi * hz * t), STEP_US) for t in times
        ]
        return [hz for hz in found if hz is not None]

    assert find(6.0) == pytest.approx([6.0, 6.0], abs=0.2)
    assert find(8.0) == []
    assert find(5.0, 0.01) == []


def test_a_persons_own_tremor_is_taken_out_of_a_hold() -> None:
    profile = make_profile("when: push, do: {axis: left_x, range_mm: [0, 10], deadzone: 0}")

    def sway(hz: float, **own: float) -> float:
        mapping = Mapping(profile, UserSettings(filter="medium", **own))
        values = [mapping.update(g).axes.get(Axis.LEFT_X, 0.0) for g in trembling(5.0, hz, 1.0)]
        return float(np.ptp(values[200:300]))

    assert sway(5.0) > 0.04
    assert sway(5.0, tremor_hz=5.0) < 0.2 * sway(5.0)
    drifted = Mapping(profile, UserSettings(filter="medium", tremor_hz=5.0))
    swayed = [
        drifted.update(
            Gesture(
                i * STEP_US,
                GestureKind.PUSH,
                np.zeros((2, 2)),
                np.zeros((2, 2)),
                5.0 + math.sin(2 * math.pi * 6.0 * i * STEP_US * 1e-6),
                (5.0, 0.0),
            )
        ).axes.get(Axis.LEFT_X, 0.0)
        for i in range(800)
    ]
    assert np.ptp(swayed[500:]) < 0.5 * np.ptp(swayed[150:290])


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
