"""Frames correct what events have let drift."""

from neurotouch_hid.tracker.correction.frames import FrameCorrection

__all__ = ["FrameCorrection"]
