"""Shapes of response."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.profile.curves import make_response
from neurotouch_hid.profile.targets import Curve, Expo, Power

curves = st.one_of(
    st.just("linear"),
    st.floats(0, 1).map(lambda share: Expo(expo=share)),
    st.floats(0.2, 5).map(lambda exponent: Power(power=exponent)),
)


@pytest.mark.parametrize(
    ("curve", "deadzone", "expected"),
    [
        ("linear", 0.0, [0, 0, 0.25, 0.5, 0.75, 1, 1]),
        ("linear", 0.5, [0, 0, 0, 0, 0.5, 1, 1]),
        (Power(power=2), 0.0, [0, 0, 0.0625, 0.25, 0.5625, 1, 1]),
        (Expo(expo=1), 0.0, [0, 0, 0.015625, 0.125, 0.421875, 1, 1]),
        (Expo(expo=0.5), 0.0, [0, 0, 0.1328125, 0.3125, 0.5859375, 1, 1]),
    ],
)
def test_values(curve: Curve, deadzone: float, expected: list[float]) -> None:
    respond = make_response((1.0, 9.0), deadzone, curve)
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
    respond = make_response((rest, rest + extent), deadzone, curve)
    values = [respond(mm) for mm in sorted(levels)]
    assert all(0.0 <= value <= 1.0 for value in values)
    assert all(a <= b + 1e-12 for a, b in pairwise(values))
    assert respond(rest) == 0.0
    assert respond(rest + extent) == 1.0
