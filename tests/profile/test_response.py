"""Shapes of response."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from neurotouch_hid.profile.engine.response import make_bend, make_response
from neurotouch_hid.profile.schema.shaping import Curve, Expo, Points, Power, Shaped

curves = st.one_of(
    st.just("linear"),
    st.floats(-1, 1).map(lambda share: Expo(expo=share)),
    st.floats(0.2, 5).map(lambda exponent: Power(power=exponent)),
    st.lists(st.tuples(st.integers(1, 99), st.floats(0, 1)), min_size=1, max_size=6).map(
        lambda drawn: Points(
            points=list(
                zip(
                    sorted({x / 100 for x, _ in drawn}),
                    sorted(y for _, y in drawn),
                    strict=False,
                )
            )
        )
    ),
)


@pytest.mark.parametrize(
    ("curve", "deadzone", "expected"),
    [
        ("linear", 0.0, [0, 0, 0.25, 0.5, 0.75, 1, 1]),
        ("linear", 0.5, [0, 0, 0, 0, 0.5, 1, 1]),
        (Power(power=2), 0.0, [0, 0, 0.0625, 0.25, 0.5625, 1, 1]),
        (Expo(expo=1), 0.0, [0, 0, 0.015625, 0.125, 0.421875, 1, 1]),
        (Expo(expo=0.5), 0.0, [0, 0, 0.1328125, 0.3125, 0.5859375, 1, 1]),
        (Expo(expo=-1), 0.0, [0, 0, 0.25 ** (1 / 3), 0.5 ** (1 / 3), 0.75 ** (1 / 3), 1, 1]),
        (Points(points=[(0.5, 0.25)]), 0.0, [0, 0, 0.09375, 0.25, 0.59375, 1, 1]),
        (Points(points=[(0.25, 0.5), (0.75, 0.5)]), 0.0, [0, 0, 0.5, 0.5, 0.5, 1, 1]),
    ],
)
def test_values(curve: Curve, deadzone: float, expected: list[float]) -> None:
    respond = make_response((1.0, 9.0), Shaped(deadzone=deadzone, curve=curve))
    assert [respond(mm) for mm in (0, 1, 3, 5, 7, 9, 18)] == pytest.approx(expected, abs=1e-12)


@settings(derandomize=True, deadline=None)
@given(
    rest=st.floats(0, 5),
    extent=st.floats(0.5, 13),
    deadzone=st.floats(0, 0.9),
    curve=curves,
    levels=st.lists(st.floats(-1, 20), min_size=2),
)
def test_it_rises_from_end_to_end(
    rest: float, extent: float, deadzone: float, curve: Curve, levels: list[float]
) -> None:
    respond = make_response((rest, rest + extent), Shaped(deadzone=deadzone, curve=curve))
    values = [respond(mm) for mm in sorted(levels)]
    assert all(0.0 <= value <= 1.0 for value in values)
    assert all(a <= b + 1e-12 for a, b in pairwise(values))
    assert respond(rest) == 0.0
    assert respond(rest + extent) == 1.0


@pytest.mark.parametrize("expo", [0.0005, 0.001, 0.1, 0.5, 0.9, 1.0])
def test_a_negative_expo_is_the_mirror_image(expo: float) -> None:
    bend, mirrored = make_bend(Expo(expo=expo)), make_bend(Expo(expo=-expo))
    for x in (0.0, 0.1, 0.3, 0.5, 0.9, 1.0):
        assert mirrored(bend(x)) == pytest.approx(x, abs=1e-3)
    for x in (0.0, 1.0):
        assert mirrored(x) == pytest.approx(x, abs=1e-12)


def test_points_may_stand_as_near_as_is_said() -> None:
    hundredths = [(percent / 100, 0.5) for percent in range(1, 100)]
    for near in pairwise(hundredths):
        Points(points=list(near))


def test_points_agree_with_another_monotone_interpolation() -> None:
    """Where the secants do not change much, nothing is limited: plain finite differences."""
    points = [(0.2, 0.1), (0.4, 0.3), (0.6, 0.55), (0.8, 0.8)]
    bend = make_bend(Points(points=points))
    xs = np.array([0.0, *(x for x, _ in points), 1.0])
    ys = np.array([0.0, *(y for _, y in points), 1.0])
    slopes = np.gradient(ys, xs)
    expected = CubicHermiteSpline(xs, ys, slopes)
    for x in np.linspace(0, 1, 51):
        assert bend(float(x)) == pytest.approx(float(expected(x)), abs=1e-9)


def test_gain_and_ends() -> None:
    shaped = Shaped(deadzone=0.0, gain=2.0, anti_deadzone=0.2, saturate=0.9)
    respond = make_response((0.0, 10.0), shaped)
    assert [respond(mm) for mm in (0, 1e-9, 2.5, 5, 10)] == pytest.approx([0, 0.2, 0.6, 0.9, 0.9])
