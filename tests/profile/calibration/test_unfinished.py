"""What a person has done of a calibration is kept until it is finished or given up."""

import json

import pytest

from neurotouch_hid.profile import UserSettings, rehearse
from neurotouch_hid.profile.calibration import (
    CalibrationSession,
    UnfinishedCalibration,
    describe_unfinished,
    find_unfinished_file,
)

MOVES = ("zoom", "pinch")
ZOOMS = "rest 1s; zoom 5mm; rest 1s; zoom 6mm; rest 1s"
PINCHES = "rest 1s; pinch 8mm; rest 1s; pinch 7mm; rest 1s"
HOLD = "rest 1s; pinch 8mm 300ms hold 6s tremor 5hz 1mm; rest 1s"


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))


def play(session, script):
    for gesture in rehearse(script):
        session.take(gesture)
    session.next()


def test_what_was_done_before_the_end_counts_as_if_nothing_had_ended():
    whole = CalibrationSession(UserSettings(), MOVES)
    parts = CalibrationSession(UserSettings(), MOVES)
    kept = UnfinishedCalibration(MOVES, is_simulated=False)
    for script in ("rest 4s", HOLD, ZOOMS, PINCHES):
        play(whole, script)
        play(parts, script)
        kept.save(parts.progress)
        parts = CalibrationSession(UserSettings(), MOVES)  # the program has ended, and is back
        before = kept.read(parts.steps)
        assert before is not None
        parts.resume(before)
        assert parts.step == whole.step
    assert parts.ranges == whole.ranges
    assert set(parts.ranges) == set(MOVES)
    assert parts.tremor == whole.tremor
    assert parts.tremor_filter == whole.tremor_filter
    assert parts.rest_mm == whole.rest_mm
    kept.forget()
    assert kept.read(parts.steps) is None


def test_what_a_person_cannot_do_is_not_asked_again():
    session = CalibrationSession(UserSettings(), MOVES)
    for _ in range(3):
        session.skip()
    again = CalibrationSession(UserSettings(), MOVES)
    again.resume(session.progress)
    assert again.step == "pinch"
    assert again.ranges == {"zoom": None}
    again.restart()
    assert (again.step, again.ranges) == ("neutral", {})


def test_other_movements_and_a_rehearsal_are_kept_apart():
    every = CalibrationSession(UserSettings())
    paths = {
        UnfinishedCalibration(movements, is_simulated=simulated).path
        for movements in (every.movements, MOVES, ("zoom",))
        for simulated in (False, True)
    }
    assert len(paths) == 6
    every.next()
    UnfinishedCalibration(every.movements, is_simulated=True).save(every.progress)
    assert describe_unfinished(is_simulated=False) == ""
    UnfinishedCalibration(every.movements, is_simulated=False).save(every.progress)
    assert describe_unfinished(is_simulated=False) == "1 of 10 steps"


@pytest.mark.parametrize(
    "change",
    [
        {"at": 11},
        {"at": -1},
        {"version": 2},
        {"peaks_mm": {"zoom": [float("nan")]}},
        {"hold_mm": ["1"]},
        {"more": 1},
        {"steps": ["neutral"]},
    ],
)
def test_a_damaged_file_is_none(change):
    session = CalibrationSession(UserSettings())
    kept = UnfinishedCalibration(session.movements, is_simulated=False)
    kept.save(session.progress)
    assert kept.path == find_unfinished_file(is_simulated=False)
    assert kept.read(session.steps) is not None
    content = json.loads(kept.path.read_text())
    kept.path.write_text(json.dumps({**content, **change}))
    assert kept.read(session.steps) is None
    kept.path.write_bytes(b"\x80")
    assert kept.read(session.steps) is None
