"""Measures a hand, without a time limit: noise, tremor, the range of eight movements.

A name loads its module when it is first asked for: only the session needs numpy.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.profile.calibration.repetition import Repetition
    from neurotouch_hid.profile.calibration.result import (
        LEAST_PEAKS,
        WeakSide,
        find_weak_sides,
        undo_ranges,
        write_ranges,
    )
    from neurotouch_hid.profile.calibration.sentences import HoldTeller, describe_peak
    from neurotouch_hid.profile.calibration.session import CalibrationSession
    from neurotouch_hid.profile.calibration.unfinished import (
        UnfinishedCalibration,
        describe_unfinished,
        find_unfinished_file,
    )
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "repetition": "Repetition",
            "result": "LEAST_PEAKS WeakSide find_weak_sides undo_ranges write_ranges",
            "sentences": "HoldTeller describe_peak",
            "session": "CalibrationSession",
            "unfinished": "UnfinishedCalibration describe_unfinished find_unfinished_file",
        },
    )

__all__ = [
    "LEAST_PEAKS",
    "CalibrationSession",
    "HoldTeller",
    "Repetition",
    "UnfinishedCalibration",
    "WeakSide",
    "describe_peak",
    "describe_unfinished",
    "find_unfinished_file",
    "find_weak_sides",
    "undo_ranges",
    "write_ranges",
]
