"""``neurotouch run`` in a real kernel: the simulated gel in, a game's controller out."""

import json
from collections import Counter

import pytest

from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.messages import Axis, Button, GamepadState

XBOX = load_identities()["xbox360"].layout
MOVES = {
    # What profiles/spacecraft.yaml says, in SDL's words; -1 the one way, 1 the other.
    "push": {("leftx", -1), ("leftx", 1), ("lefty", -1), ("lefty", 1)},
    "twist_cw": {("rightx", 1)},
    "twist_ccw": {("rightx", -1)},
    "zoom": {("righttrigger", 1)},
    "pinch": {("lefttrigger", 1)},
}
MOVED_AXES = {
    "push": {"left_x", "left_y"},
    "twist_cw": {"right_x"},
    "twist_ccw": {"right_x"},
    "zoom": {"right_trigger"},
    "pinch": {"left_trigger"},
}
CLEARLY = 5000
"""Of 32767: what no trembling reaches and even the weakest gesture of the tour exceeds."""
AXIS_CODES = {control.code: axis for axis, control in XBOX.axes.items()}
KEY_CODES = {control.code: button for button, control in XBOX.buttons.items()}
NEUTRAL = XBOX.encode(GamepadState(0))


def read_reports(events: list[list[int]]) -> list[tuple[int, ...]]:
    """Return the report of the pad at the end of each frame."""
    codes = [(1, code) for code in KEY_CODES] + [(3, code) for code in AXIS_CODES]
    values = dict.fromkeys(codes, 0)
    reports = []
    for kind, code, value in events:
        if kind == 0:
            assert code == 0, "the kernel dropped events: the reader was too slow"
            reports.append(tuple(values.values()))
        else:
            values[kind, code] = value
    return reports


def read_trace(trace) -> list[tuple[int, ...]]:
    """Return the report of the pad in each line of the trace."""
    reports = []
    for line in trace.read_text().splitlines():
        pad = json.loads(line)["pad"]
        buttons = frozenset(button for button in Button if pad[button])
        reports.append(XBOX.encode(GamepadState(0, buttons, {axis: pad[axis] for axis in Axis})))
    return reports


def follows(seen: list[tuple[int, ...]], traced: list[tuple[int, ...]]) -> bool:
    """Say whether the reader saw every line of the trace, in order, and nothing else.

    The trace is rounded, so a step of one is no difference. Neutral reports are left out: in the
    slow guest the line may take longer than the stall time, and the pad is neutral for a moment.
    """
    left = [NEUTRAL, *(report for report in seen if report != NEUTRAL)]
    places = {0}  # where the reader may be: a step of one can be a change or a rounding
    for line in traced:
        if line != NEUTRAL:
            places |= {place + 1 for place in places if place + 1 < len(left)}
            places = {place for place in places if is_close(left[place], line)}
    return len(left) - 1 in places


def is_close(one: tuple[int, ...], other: tuple[int, ...]) -> bool:
    return all(abs(a - b) <= 1 for a, b in zip(one, other, strict=True))


@pytest.fixture(scope="module")
def tour(guest):
    return guest("tour")


@pytest.mark.parametrize("library", ["sdl2", "sdl3"])
@pytest.mark.parametrize("gesture", MOVES)
def test_a_game_sees_each_gesture_where_the_profile_puts_it(tour, library, gesture):
    for control, way in MOVES[gesture]:
        low, high = tour[library][control]
        assert (high if way > 0 else -low) >= CLEARLY


@pytest.mark.parametrize("library", ["sdl2", "sdl3"])
def test_a_game_sees_nothing_else_move(tour, library):
    assert set(tour[library]) == {control for moves in MOVES.values() for control, _ in moves}


def test_a_reader_sees_exactly_what_the_trace_says(tour, results):
    seen, traced = read_reports(tour["events"]), read_trace(results / "tour.jsonl")
    assert len(seen) > 100
    assert follows(seen, traced)


def test_each_gesture_mostly_moves_what_the_profile_says(tour, results):
    """Mostly: at a change from one gesture to the next the old one is let go first."""
    moved = {gesture: Counter() for gesture in [*MOVES, "none"]}
    for line in (results / "tour.jsonl").read_text().splitlines():
        step = json.loads(line)
        axes = frozenset(name for name, value in step["pad"].items() if value)
        moved[step["gesture"]][axes] += 1
    assert moved["none"].most_common(1)[0][0] == set()
    for gesture, axes in MOVED_AXES.items():
        del moved[gesture][frozenset()]
        assert moved[gesture].most_common(1)[0][0] <= axes


def test_at_the_end_everything_is_exactly_neutral(tour):
    assert read_reports(tour["events"])[-1] == NEUTRAL
    assert tour["ended"] == "No such device"
    assert not tour["node_left"]
    assert tour["exit_code"] == 0


def test_sigterm_in_a_gesture_goes_neutral_and_ends_well(guest):
    seen = guest("terminated")
    reports = read_reports(seen["events"])
    assert any(report != NEUTRAL for report in reports)
    assert reports[-1] == NEUTRAL
    assert seen["ended"] == "No such device"
    assert not seen["node_left"]
    assert seen["exit_code"] == 0


def test_kill_9_in_a_gesture_leaves_nothing_pressed(guest):
    seen = guest("driver_killed")
    keys = [event for event in seen["events"] if event[0] == 1]
    assert [1, 0x130, 1] in keys
    assert keys[-1] == [1, 0x130, 0]
    assert seen["ended"] == "No such device"
    assert not seen["node_left"]
    assert seen["exit_code"] == -9
