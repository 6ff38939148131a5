"""When a type is recognised and lost, and false gestures, on timelines made by hand."""

import pytest

from neurotouch_hid.evaluation.accuracy import LabelTrack, Tally, summarise
from neurotouch_hid.evaluation.accuracy.type_timing import Stopwatch, TypeTiming
from neurotouch_hid.messages import GestureKind
from tests.evaluation.timelines import label

SLICE_US = 10_000
NAMES = {"-": GestureKind.NONE, "p": GestureKind.PUSH, "z": GestureKind.ZOOM}


def play(labelled, intensities, recognised):
    """One letter and one number for each slice of 10 ms."""
    truths = [
        label((k + 1) * SLICE_US, NAMES[letter], intensity)
        for k, (letter, intensity) in enumerate(zip(labelled, intensities, strict=True))
    ]
    stopwatch = Stopwatch(LabelTrack(truths))
    for truth, letter in zip(truths, recognised, strict=True):
        stopwatch.add(truth.t_us, SLICE_US, truth, NAMES[letter])
    return stopwatch.timing


RAMP = (0, 1, 2, 3, 4, 4, 3, 2, 1, 0)  # 2.5 mm is reached in the fourth slice, left in the eighth


@pytest.mark.parametrize(
    ("recognised", "times_ms", "changes"),
    [
        ("--pppppp--", [0.0], 0),
        ("-----ppp--", [20.0], 0),
        ("-zzzpppp--", [10.0], 0),  # another type before the right one is late, not a change
        ("-ppppp----", [0.0], 1),  # let go at 3 mm
        ("-pppppp---", [0.0], 0),  # let go at 2 mm
        ("-ppppppz--", [0.0], 1),  # another type while it is released
        ("-ppzpzp---", [10.0], 1),  # more than one change counts once
        ("-zzzzzz---", [], 0),
        ("-pp-------", [], 0),  # right only before 2.5 mm
    ],
)
def test_one_gesture(recognised, times_ms, changes):
    timing = play("-pppppppp-", RAMP, recognised)
    assert timing.gestures == 1
    assert timing.times_ms == times_ms
    assert timing.changes == changes


def test_a_gesture_that_stays_weak_is_not_timed():
    timing = play("-pppp-", (0, 1, 2, 2, 1, 0), "-ppzz-")
    assert (timing.gestures, timing.times_ms, timing.changes) == (0, [], 0)


def test_each_labelled_gesture_is_timed_for_itself():
    timing = play("-ppppzzzz-", (0, 3, 3, 3, 3, 3, 3, 3, 3, 0), "--pppppzz-")
    assert timing.gestures == 2
    assert timing.times_ms == [10.0, 20.0]
    assert timing.changes == 0


def test_false_gestures_are_counted_at_rest_alone():
    rest, hand = 200, 20  # slices: 2 s of rest on both sides of a gesture of 0.2 s
    labelled = "-" * rest + "p" * hand + "-" * rest
    recognised = list("-" * rest + "p" * hand + "-" * rest)
    recognised[20:23] = "ppp"  # one
    recognised[100], recognised[101] = "p", "z"  # one, its type does not matter
    recognised[rest - 30] = "p"  # 0.3 s before the gesture: the hand is arriving
    recognised[rest + hand : rest + hand + 80] = "p" * 80  # stuck 0.8 s: one, from 0.5 s on
    recognised[-1] = "p"  # one
    timing = play(labelled, (0,) * rest + (4,) * hand + (0,) * rest, recognised)
    assert timing.false_gestures == 4
    assert timing.rest_s == pytest.approx(2 * (2.0 - 0.5), abs=0.021)


def test_figures_add_up_over_recordings_and_infinity_is_none():
    quick, slow = (
        TypeTiming(18, [0.0] * 9 + [40.0] * 9, 1, 2, 300.0),
        TypeTiming(1, [120.0], 0, 0, 300.0),
    )
    never = TypeTiming(1, [], 0, 1, 0.0)
    report = summarise(Tally(timing=quick) + Tally(timing=slow) + Tally(timing=never))
    assert report["time_to_type_ms"] == {"median": 40.0, "p95": 120.0, "gestures": 20, "never": 1}
    assert report["type_changes"] == pytest.approx(1 / 20)
    assert report["false_gestures_per_10_min"] == pytest.approx(3.0)
    assert report["at_rest_s"] == 600.0
    lost = summarise(Tally(timing=slow) + Tally(timing=never))["time_to_type_ms"]
    assert (lost["median"], lost["p95"]) == (120.0, None)


def test_without_gestures_and_rest_nothing_is_known():
    report = summarise(Tally())
    assert report["time_to_type_ms"]["median"] is None
    assert report["type_changes"] is None
    assert report["false_gestures_per_10_min"] is None
