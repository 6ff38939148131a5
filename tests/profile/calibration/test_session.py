"""Calibration on synthetic gestures: what was done is what comes out."""

import math
import re

import numpy as np
import pytest

from neurotouch_hid.messages import Gesture, GestureKind
from neurotouch_hid.profile import check_user, rehearse
from neurotouch_hid.profile.calibration import (
    CalibrationSession,
    HoldTeller,
    describe_peak,
    find_weak_sides,
    undo_ranges,
    write_ranges,
)
from neurotouch_hid.profile.calibration.result import measure_range, measure_rest
from neurotouch_hid.profile.calibration.tremor import find_tremor, propose_filter, smooth
from neurotouch_hid.profile.editing import ProfileText
from neurotouch_hid.profile.engine.one_euro import FILTERS
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.user import MovementRange, UserSettings

STEP_US = 10_000


def play(session, script):
    found = [session.take(gesture) for gesture in rehearse(script)]
    return [repetition for repetition in found if repetition is not None]


def say(movement):
    return movement.replace("push_", "push ")


def test_every_movement_is_found_and_measured():
    script = "".join(
        f"rest 1s; {say(name)} {mm}mm 300ms hold 200ms; rest 700ms; {say(name)} {mm}mm;"
        for name, mm in zip(MOVEMENTS, (4.0, 5.0, 6.0, 7.0, 8.0, 3.0, 9.0, 10.0), strict=True)
    )
    session = CalibrationSession(UserSettings(), guided=False)
    found = play(session, script)
    assert [r.movement for r in found] == [name for name in MOVEMENTS for _ in range(2)]
    fulls = [range_.full for range_ in session.ranges.values()]
    assert fulls == pytest.approx([3.2, 4.0, 4.8, 5.6, 6.4, 2.4, 7.2, 8.0], abs=0.11)
    assert session.rest_mm == 0.6
    assert all(r.begin_us < r.end_us for r in found)


def test_a_hand_that_never_lets_go_entirely_still_repeats():
    points = np.zeros((1, 2))
    session = CalibrationSession(UserSettings(), guided=False)
    found = []
    for i in range(600):
        mm = 2.0 + 6.0 * max(0.0, math.sin(i / 100 * 2.0 * math.pi))
        moved = (mm, 0.0)
        found.append(
            session.take(Gesture(i * STEP_US, GestureKind.PUSH, points, points, mm, moved))
        )
    peaks = [repetition.peak_mm for repetition in found if repetition is not None]
    assert len(peaks) >= 5
    assert all(7.5 < peak <= 8.0 for peak in peaks)


def test_one_wrong_measurement_is_no_peak():
    points = np.zeros((1, 2))
    session = CalibrationSession(UserSettings(), guided=False)
    for i, gesture in enumerate(rehearse("push left 4mm 300ms hold 300ms")):
        mm = 30.0 if i == 40 else gesture.intensity_mm
        spoilt = Gesture(gesture.t_us, gesture.kind, points, points, mm, gesture.translation_mm)
        repetition = session.take(spoilt)
        if repetition is not None:
            assert repetition.peak_mm == pytest.approx(4.0)
            return
    raise AssertionError("no repetition")


def test_the_guided_way_asks_step_by_step_goes_back_and_skips():
    session = CalibrationSession(UserSettings(), ("zoom", "pinch"))
    assert session.step == "neutral"
    play(session, "rest 1s")
    session.next()
    assert session.step == "hold"
    play(session, "pinch 5mm 300ms hold 6s tremor 6hz 0.9mm")
    session.next()
    assert session.step == "zoom"
    [wrong] = play(session, "rest 500ms; pinch 5mm")
    assert not session.accepts(wrong)
    [small] = play(session, "rest 500ms; zoom 2mm")
    assert not session.accepts(small)
    play(session, "rest 500ms; zoom 3mm; rest 500ms; zoom 3mm")
    session.next()
    play(session, "rest 500ms; pinch 9mm; rest 500ms; pinch 9mm")
    assert session.ranges["pinch"].full == pytest.approx(7.2)
    session.back()
    assert session.step == "zoom"
    assert "zoom" not in session.ranges  # neither measured nor skipped: it stays as it was
    session.skip()
    session.next()
    assert session.step is None
    session.next()
    assert session.ranges["zoom"] is None
    assert session.tremor.frequency_hz == pytest.approx(6.0, abs=0.3)
    assert session.tremor.amplitude_mm == pytest.approx(0.9, rel=0.1)


@pytest.mark.parametrize("slices_us", [(1_000, 4_000, 2_500), (33_333,)])
def test_a_tremor_is_what_it_is_however_often_gestures_come(slices_us):
    """Slices are shorter while the hand moves; a webcam sees 30 pictures a second."""
    session = CalibrationSession(UserSettings(), ("zoom",))
    session.next()
    fine, t_us = list(rehearse("pinch 5mm 300ms hold 6s tremor 6hz 0.9mm", slice_us=500)), 0
    for i in range(len(fine)):
        t_us += slices_us[i % len(slices_us)]
        if t_us // 500 >= len(fine):
            break
        session.take(fine[t_us // 500])
    assert session.held_s == 0.0
    assert session.tremor.frequency_hz == pytest.approx(6.0, abs=0.3)
    assert session.tremor.amplitude_mm == pytest.approx(0.9, rel=0.15)


def test_lost_gestures_are_no_hold_and_what_was_done_can_be_kept():
    """A busy machine may lose seconds."""
    session = CalibrationSession(UserSettings(), ("zoom",))
    session.next()
    for gesture in rehearse("pinch 5mm 300ms hold 6s"):
        if not 1_000_000 < gesture.t_us < 5_000_000:
            session.take(gesture)
            assert session.progress.at == 1
    assert session.held_s < 2.0
    assert session.tremor_filter is None


def test_one_repetition_switches_nothing_off():
    session = CalibrationSession(UserSettings(), ("zoom", "pinch"))
    session.next()
    session.next()
    assert session.missing == 2
    play(session, "rest 500ms; zoom 6mm; rest 500ms")
    assert session.missing == 1
    session.next()
    play(session, "rest 500ms; pinch 9mm; rest 500ms; pinch 9mm; rest 500ms")
    assert session.missing == 0
    assert set(session.ranges) == {"pinch"}
    assert session.unfinished == {"zoom": 1}


def test_undo_takes_back_a_calibration_and_nothing_else():
    first = ProfileText(
        "version: 1\n\n# Calibrated 2026-11-20.\nrange:\n  zoom: {rest: 0.6, full: 3.0}\n"
    )
    second = write_ranges(first, RANGES, "2026-11-21", "medium", 5.0)
    later = second.rewrite(f"{second}feedback: {{sound: tones}}\n")
    undone = undo_ranges(later, first, second)
    assert undone.text == f"{first}feedback: {{sound: tones}}\n"
    chosen = later.replace(("filter",), "strong")
    assert "filter: strong" in undo_ranges(chosen, first, second).text
    assert undo_ranges(undone, first, second) == undone


def test_undo_of_the_first_calibration_leaves_none():
    before = ProfileText("version: 1\n")
    after = write_ranges(before, RANGES, "2026-11-21")
    undone = undo_ranges(after, before, after).text
    assert "Calibrated" not in undone
    assert "full" not in undone


def test_orientation_is_the_persons():
    session = CalibrationSession(UserSettings(mirror=True), guided=False)
    assert [r.movement for r in play(session, "push left 5mm; rest 1s; twist_cw 5mm")] == [
        "push_right",
        "twist_ccw",
    ]
    session = CalibrationSession(UserSettings(rotate_deg=90.0), guided=False)
    assert [r.movement for r in play(session, "push right 5mm")] == ["push_down"]


def test_how_a_hand_was_laid_down_is_no_noise_of_its_rest():
    session = CalibrationSession(UserSettings(neutral="resting"))
    assert session.step == "neutral"
    play(session, "push down 3mm 300ms hold 3s release 0ms; rest 4s")
    assert session.rest_mm == 0.6


def test_noise_sets_where_a_movement_begins():
    rng = np.random.default_rng(1)
    assert measure_rest(list(rng.normal(0.0, 0.5, 1000))) == pytest.approx(1.5, abs=0.1)
    assert measure_rest([0.0] * 100) == 0.6
    assert measure_rest([]) == 1.0
    assert measure_rest(list(rng.normal(0.0, 9.0, 100))) == 3.0


@pytest.mark.parametrize(
    ("peaks", "full"),
    [
        ([5.0, 5.0], 4.0),
        ([3.0, 5.0, 9.0], 4.0),
        ([5.0], None),
        ([2.4, 2.4, 9.0], None),
        ([], None),
        ([2.5, 2.6], 2.0),
        ([30.0, 30.0], 18.0),
    ],
)
def test_full_is_four_fifths_of_a_comfortable_movement(peaks, full):
    range_ = measure_range(peaks, 0.6)
    assert (range_.full if range_ is not None else None) == (
        pytest.approx(full, abs=0.1) if full is not None else None
    )


def test_a_side_below_half_of_its_partner_is_weak():
    ranges = {
        "pinch": MovementRange(rest=0.6, full=6.0),
        "zoom": MovementRange(rest=0.6, full=2.9),
        "push_left": MovementRange(rest=0.6, full=5.0),
        "push_right": MovementRange(rest=0.6, full=3.0),
        "twist_cw": MovementRange(rest=0.6, full=5.0),
        "twist_ccw": None,
        "push_up": None,
        "push_down": None,
    }
    found = [(side.weak, round(side.share, 2)) for side in find_weak_sides(ranges)]
    assert found == [("zoom", 0.48), ("twist_ccw", 0.0)]


@pytest.mark.parametrize("frequency_hz", [3.5, 5.0, 8.0, 11.0])
@pytest.mark.parametrize("amplitude_mm", [0.2, 1.0, 2.0])
def test_a_tremor_is_found_where_it_is(frequency_hz, amplitude_mm):
    rng = np.random.default_rng(2)
    t_s = np.arange(800) * STEP_US * 1e-6
    mm = 5.0 - 0.1 * t_s + amplitude_mm * np.sin(2.0 * np.pi * frequency_hz * t_s)
    tremor = find_tremor(mm + rng.normal(0.0, 0.05, len(mm)), STEP_US)
    assert tremor.frequency_hz == pytest.approx(frequency_hz, abs=0.2)
    assert tremor.amplitude_mm == pytest.approx(amplitude_mm, rel=0.1)


def test_noise_and_slow_movement_are_no_tremor():
    rng = np.random.default_rng(3)
    t_s = np.arange(800) * STEP_US * 1e-6
    assert find_tremor(5.0 + rng.normal(0.0, 0.05, len(t_s)), STEP_US) is None
    assert find_tremor(5.0 + np.sin(2.0 * np.pi * 0.5 * t_s), STEP_US) is None
    assert find_tremor(5.0 + np.sin(2.0 * np.pi * 5.0 * t_s[:100]), STEP_US) is None


def test_the_weakest_calm_filter_is_chosen():
    t_s = np.arange(1000) * STEP_US * 1e-6
    chosen = []
    for amplitude_mm in (0.0, 0.3, 0.6, 1.2, 2.0):
        mm = 5.0 + amplitude_mm * np.sin(2.0 * np.pi * 5.0 * t_s)
        name = propose_filter(mm, STEP_US)
        chosen.append(name)
        left = find_tremor(smooth(mm, STEP_US, name), STEP_US)
        assert left is None or 2.0 * left.amplitude_mm <= 1.0 or name == "strong"
    order = ["none", *FILTERS]
    assert [order.index(name) for name in chosen] == sorted(order.index(name) for name in chosen)
    assert chosen[0] == "none"
    assert chosen[-1] != "none"


RANGES = {
    "pinch": MovementRange(rest=0.6, full=6.0),
    "zoom": MovementRange(rest=0.7, full=2.9),
    "twist_cw": None,
}


def test_the_users_file_gets_what_was_measured_and_the_date():
    before = ProfileText("version: 1\nhandedness: left\n")
    text = write_ranges(before, RANGES, "2026-11-21", "medium")
    settings = check_user(text.encode(), "user.yaml").require()
    assert settings.range.zoom == RANGES["zoom"]
    assert settings.range.twist_cw is None
    assert (settings.filter, settings.handedness) == ("medium", "left")
    assert "# Calibrated 2026-11-21." in text.text
    again = write_ranges(text, {"zoom": MovementRange(rest=0.6, full=3.0)}, "2027-01-02")
    assert "# Calibrated 2027-01-02." in again.text
    assert "2026" not in again.text
    now = check_user(again.encode(), "user.yaml").require()
    assert now.range.zoom.full == 3.0
    assert now.range.pinch == RANGES["pinch"]
    assert len(set(again.text.splitlines()) - set(text.text.splitlines())) == 2
    gone = write_ranges(again, {"zoom": None}, "2027-01-02")
    assert check_user(gone.encode(), "user.yaml").require().range.zoom is None


def test_the_second_repetition_is_enough():
    assert describe_peak(8.44, 1) == "8.4 millimetres, good, 1 of 2"
    assert describe_peak(8.0, 2) == (
        "8.0 millimetres, good, 2 made: enough. Go on to the next one."
    )


@pytest.mark.parametrize(
    ("held_s", "heard", "proposed"),
    [
        (2.0, ["Keep it there.", "Kept for 2.0 seconds. Keep it for 4 or longer."], None),
        (
            6.0,
            [
                "Keep it there.",
                "4 seconds, enough. Go on to the next one, or keep it longer.",
                "Kept for 6.0 seconds, enough. Go on to the next one, or keep it again.",
            ],
            "none",
        ),
    ],
)
def test_a_hold_is_told_and_what_is_called_enough_is_enough(held_s, heard, proposed):
    session = CalibrationSession(UserSettings())
    session.next()
    hold, said = HoldTeller(), []
    for gesture in rehearse(f"push right 5mm hold {held_s:g}s; rest 1s"):
        session.take(gesture)
        said.append(hold.take(session.held_s))
    told = [re.sub(r"[.]\d", ".0", words) if "Kept" in words else words for words in said if words]
    assert told == heard
    assert session.tremor_filter == proposed
