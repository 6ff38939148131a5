"""From speeds to whole steps: nothing is lost, nothing leaps."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.device.outputs import mouse
from neurotouch_hid.messages import GamepadState

X, Y, WHEEL, FINE = 0, 1, 8, 11
SLICE_US = 10_000

speeds = st.floats(-5000.0, 5000.0)
wheels = st.floats(-50.0, 50.0)


def travel(states: list[GamepadState]) -> dict[int, int]:
    """How far each code went in all."""
    motion = mouse.PointerMotion()
    way = dict.fromkeys((X, Y, WHEEL, FINE), 0)
    for state in states:
        for code, n_steps in motion.compute_steps(state):
            way[code] += n_steps
    return way


def every_slice(rates: list[tuple[float, float, float]]) -> list[GamepadState]:
    """A state at rest, then one for each pointer speed and wheel speed."""
    return [
        GamepadState(0),
        *(
            GamepadState((n + 1) * SLICE_US, pointer=(x, y), wheel=wheel)
            for n, (x, y, wheel) in enumerate(rates)
        ),
    ]


def test_the_first_state_only_starts_the_clock():
    assert (
        mouse.PointerMotion().compute_steps(GamepadState(7_000_000, pointer=(5000.0, 5000.0))) == ()
    )


def test_a_steady_push_moves_evenly():
    motion = mouse.PointerMotion()
    motion.compute_steps(GamepadState(0))
    steps = [motion.compute_steps(state) for state in every_slice([(900.0, -900.0, 0.0)] * 50)[1:]]
    assert steps == [((X, 9), (Y, -9))] * 50


def test_a_push_below_one_pixel_per_slice_still_arrives():
    assert travel(every_slice([(7.0, -3.0, 0.0)] * 1000)) == {X: 70, Y: -30, WHEEL: 0, FINE: 0}


def test_time_counts_not_the_number_of_states():
    coarse = [GamepadState(t_us, pointer=(333.0, 0.0)) for t_us in range(0, 1_000_001, 20_000)]
    fine = [GamepadState(t_us, pointer=(333.0, 0.0)) for t_us in range(0, 1_000_001, 1_000)]
    assert travel(coarse)[X] == travel(fine)[X] == 333


@pytest.mark.parametrize(("gap_us", "way"), [(50_000, 50), (10_000_000, 50), (-10_000, 0), (0, 0)])
def test_over_a_gap_the_pointer_does_not_leap(gap_us, way):
    states = [GamepadState(1_000_000), GamepadState(1_000_000 + gap_us, pointer=(1000.0, 0.0))]
    assert travel(states)[X] == way


@pytest.mark.parametrize(
    ("speed", "way"), [(math.nan, 0), (math.inf, 200), (-math.inf, -200), (1e300, 200)]
)
def test_no_number_throws_the_pointer(speed, way):
    states = every_slice([(speed, 0.0, 0.0), (0.0, speed, 0.0)])
    assert travel(states)[X] == travel(states)[Y] == way


@pytest.mark.parametrize(("speed", "fine"), [(math.nan, 0), (math.inf, 240), (-1e9, -240)])
def test_no_number_spins_the_wheel(speed, fine):
    assert travel(every_slice([(0.0, 0.0, speed)]))[FINE] == fine


def test_a_slow_wheel_is_smooth_and_clicks_after_120_steps():
    motion = mouse.PointerMotion()
    motion.compute_steps(GamepadState(0))
    seen = [motion.compute_steps(state) for state in every_slice([(0.0, 0.0, 10.0)] * 20)[1:]]
    assert [dict(steps)[FINE] for steps in seen] == [12] * 20
    assert [n for n, steps in enumerate(seen) if dict(steps).get(WHEEL)] == [9, 19]


def test_up_and_down_are_the_same():
    up, down = (travel(every_slice([(0.0, 0.0, sign * 3.3)] * 250)) for sign in (1, -1))
    assert up[WHEEL] == -down[WHEEL] == 8
    assert up[FINE] == -down[FINE] == 990


@given(rates=st.lists(st.tuples(speeds, speeds, wheels), max_size=60))
def test_the_way_is_the_integral_of_the_speed_to_half_a_step(rates):
    seen = travel(every_slice(rates))
    for code, part, per_unit in ((X, 0, 1), (Y, 1, 1), (FINE, 2, 120)):
        exact = math.fsum(rate[part] * per_unit * SLICE_US * 1e-6 for rate in rates)
        assert abs(seen[code] - exact) <= 0.5 + 1e-6
    assert abs(120 * seen[WHEEL] - seen[FINE]) < 120


@given(rates=st.lists(st.tuples(speeds, speeds, wheels), max_size=60))
def test_steps_are_never_zero_and_every_code_is_declared(rates):
    motion = mouse.PointerMotion()
    for state in every_slice(rates):
        for code, n_steps in motion.compute_steps(state):
            assert n_steps
            assert code in mouse.SPEC.motions
