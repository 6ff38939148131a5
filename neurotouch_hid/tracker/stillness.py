"""Notices that the gel has been still for a while, and keeps the mean of these frames."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.tracker.kernels import matching

_GATE_PX: Final = 2.0  # a longer motion is not small
_REACH_PX: Final = 20.0  # two pitches; a hand moves dots that are nearer to each other alike
_PAIRED: Final = 0.8  # of the dots are seen again; noise hides some, and makes others


@dataclass(frozen=True, slots=True)
class StillConfig:
    """Limits within which a gel counts as still.

    Attributes:
        still_us: nothing must move for this time.
        least_frames: the least number of frames in this time, for a camera that sends few.
        max_bent_px: largest motion that neighbours share between two frames.
        max_all_bent_px: the same since the first frame: a gel that sinks back is not still.
        max_swing_px: largest motion of everything between two frames. A fan that shakes the rig
            moves it so far, and a rig that was bumped moves farther.
    """

    still_us: int = 1_000_000
    least_frames: int = 10
    max_bent_px: float = 0.1
    max_all_bent_px: float = 0.2
    max_swing_px: float = 0.3


class Stillness:
    """Follows the dots from frame to frame.

    Args:
        config: when a gel is still.
        least_dots: a picture with fewer, for example a black one, shows neither motion nor rest.
    """

    def __init__(self, config: StillConfig, least_dots: int) -> None:
        self._config, self._least_dots = config, least_dots
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        self._sum = np.zeros(shape, np.uint32)  # of the frames, once there are two
        self._first: Frame | None = None
        self._first_px: NDArray[np.float64] = np.empty((0, 2))
        self._before_px: NDArray[np.float64] = np.empty((0, 2))
        self._begin_us = self._n_frames = 0

    def forget(self) -> None:
        """Starts again: the next frame is the first one."""
        self._n_frames = 0

    def update(self, frame: Frame, centroid_px: NDArray[np.float64]) -> bool:
        """Returns True once the gel has been still for long enough; then the next time begins.

        Args:
            frame: the frame.
            centroid_px: (m, 2) float64 px, its dots.
        """
        config = self._config
        if len(centroid_px) < self._least_dots:
            return False
        before, self._before_px = self._before_px, centroid_px.copy()
        if not self._n_frames or not self._is_still(before):
            self._first_px, self._begin_us = self._before_px, frame.t_us
            self._first, self._n_frames = frame, 1
            return False
        if self._first is not None:
            self._sum[:], self._first = self._first.pixels, None
        self._sum += frame.pixels
        self._n_frames += 1
        is_long = frame.t_us - self._begin_us >= config.still_us
        return is_long and self._n_frames >= config.least_frames

    def take_mean(self, frame: Frame) -> Frame:
        """Returns the mean of the still frames, stamped as the last of them, and starts again.

        A single picture in weak light hides faint dots, and its noise makes all others irregular.
        """
        half = self._n_frames // 2
        pixels = ((self._sum + half) // max(self._n_frames, 1)).astype(np.uint8)
        self.forget()
        return Frame(pixels, frame.exposure_begin_us, frame.exposure_end_us)

    def _is_still(self, before_px: NDArray[np.float64]) -> bool:
        config, now_px = self._config, self._before_px
        least = _PAIRED * len(before_px)
        bent_px = _measure(before_px, now_px, least, config.max_swing_px)
        if bent_px > config.max_bent_px:
            return False
        if self._n_frames > 1:  # else the first one is the one before
            bent_px = _measure(self._first_px, now_px, 0.0, math.inf)
        return bent_px <= config.max_all_bent_px


def _measure(
    before_px: NDArray[np.float64], now_px: NDArray[np.float64], least: float, most_px: float
) -> float:
    """Returns what neighbours share of their motion, see ``measure_shared``."""
    match = np.empty(len(before_px), np.int32)
    measured = matching.measure_shared(
        before_px, now_px, _GATE_PX, _REACH_PX, least, most_px, match
    )
    return float(measured[2])
