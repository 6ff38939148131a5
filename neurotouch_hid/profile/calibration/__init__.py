"""Measures a hand, without a time limit: noise, tremor, the range of eight movements."""

from neurotouch_hid.profile.calibration.repetition import Repetition
from neurotouch_hid.profile.calibration.result import (
    LEAST_PEAKS,
    WeakSide,
    find_weak_sides,
    undo_ranges,
    write_ranges,
)
from neurotouch_hid.profile.calibration.session import CalibrationSession
from neurotouch_hid.profile.calibration.tremor import Tremor

__all__ = [
    "LEAST_PEAKS",
    "CalibrationSession",
    "Repetition",
    "Tremor",
    "WeakSide",
    "find_weak_sides",
    "undo_ranges",
    "write_ranges",
]
