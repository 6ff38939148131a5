"""Finds the gel at rest without frames: a stroke is over and nothing moves near the old places.

Events tell motion only, so tracks drift by tenths of a pixel with each stroke. A gel that has come
back shows where they belong.
"""

import math
from functools import partial

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.kernels.order_statistics import select
from neurotouch_hid.process.kernel_cache import load
from neurotouch_hid.tracker.kernels import correction, neighbours
from neurotouch_hid.tracker.kernels.tracks import Tracks, shift

LOOK_US = 10_000  # time between two looks
PAUSE_US = 200_000  # a longer time without a look means that there were frames
WINDOW_US = 60_000  # in which nothing moves
QUIET_US = 30_000  # as long nothing has moved within the window
STILL_PX = 0.35  # noise moves a track by less in the window; a finger moves it by more
NEAR_PX = 1.5  # no track drifts farther in a few strokes; a touch of 0.6 mm moves markers so far
RETURNED = 0.5  # of the largest motion since the last return: a push that begins is no return
MOTION_PX = 0.75  # a smaller motion is not labelled as a gesture
FEW = 3  # markers that may err: a hot pixel, or a neighbour's events
PULL_S = 5.0  # time constant with which tracks at rest go back; a slow push is faster
ALONE_S = 0.2  # the same for a track that has moved without its neighbours: a touch moves them too
ALONE_PX = 0.3  # farther than they have
RIG_PX = 1.0  # a common motion beyond this is the rig's
RIG_SHARE = 0.02  # of a smaller one: mostly the tracks' own drift


class QuietReturn:
    """Watches the tracks of a camera that sends no frames, or none for a while.

    Args:
        tracks: of the tracker; tracks at rest are moved.
    """

    def __init__(self, tracks: Tracks) -> None:
        n = len(tracks.state)
        self._tracks = tracks
        self._everyone = np.arange(n)
        self._before_px = np.empty((n, 2))
        self._now_px, self._expected_px = np.empty((n, 2)), np.empty((n, 2))
        self._spread_px, self._all = np.empty(n), np.ones(n, np.bool_)
        self._looked_us: int | None = None
        self._begin()
        load(correction.recall, 0, tracks, self._now_px)
        load(select, self._spread_px, 0)
        places = tracks.rest_px, tracks.neighbours, self._expected_px, self._spread_px
        load(neighbours.expect, self._now_px, self._all, *places)
        self._expect = partial(neighbours.expect, self._now_px, self._all, *places)

    def _begin(self) -> None:
        self._most_px = math.inf  # nobody knows what the hand did while there were frames
        self._quiet_us, self._is_back = 0, False

    def find(self, t_us: int) -> NDArray[np.float64] | None:
        """Returns where the markers are at rest if they have just come back, (n, 2) float64 px.

        Args:
            t_us: now, the end of a slice.
        """
        elapsed_us = -1 if self._looked_us is None else t_us - self._looked_us
        if not 0 <= elapsed_us < PAUSE_US:
            elapsed_us = LOOK_US
            self._begin()
        elif elapsed_us < LOOK_US:
            return None
        self._looked_us = t_us
        tracks = self._tracks
        last_us = int(tracks.past_us.max())
        if not (
            correction.recall(last_us, tracks, self._now_px)
            and correction.recall(last_us - WINDOW_US, tracks, self._before_px)
        ):
            return None
        rest_px = tracks.rest_px
        off_px = self._now_px - rest_px
        common_px = np.median(off_px, axis=0)
        far_px = _measure(off_px - common_px)
        self._most_px = max(self._most_px, far_px)
        is_still = _measure(self._now_px - self._before_px) <= STILL_PX
        self._quiet_us = self._quiet_us + elapsed_us if is_still and far_px <= NEAR_PX else 0
        if self._most_px > MOTION_PX and far_px > RETURNED * self._most_px:
            self._is_back = False
            return None
        if self._quiet_us < QUIET_US:
            return None
        if self._is_back:
            self._pull(off_px, common_px, elapsed_us)
            return None
        self._is_back, self._most_px = True, 0.0
        share = 1.0 if math.hypot(*common_px) > RIG_PX else RIG_SHARE
        return rest_px + share * common_px

    def _pull(self, off_px: NDArray[np.float64], common_px: NDArray[np.float64], us: int) -> None:
        """Moves tracks at rest to their places: slowly together, fast what noise moves alone."""
        if math.hypot(*common_px) > RIG_PX:
            return
        tracks = self._tracks
        self._expect()
        with_px = np.where(np.isfinite(self._expected_px), self._expected_px - tracks.rest_px, 0.0)
        own_px = off_px - with_px
        is_alone = np.hypot(*own_px.T) > ALONE_PX + np.hypot(*with_px.T)
        together, alone = (-math.expm1(-1e-6 * us / s) for s in (PULL_S, ALONE_S))
        own_px *= np.where(is_alone, alone, together)[:, None]
        shift(tracks, self._everyone, -together * with_px - own_px)


def _measure(moved_px: NDArray[np.float64]) -> float:
    """Returns the largest motion of all but a few markers, px."""
    size_px = np.sqrt(moved_px[:, 0] ** 2 + moved_px[:, 1] ** 2)
    return float(select(size_px, len(size_px) - 1 - FEW))
