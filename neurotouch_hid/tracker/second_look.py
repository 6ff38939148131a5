"""Looks at a frame again if the first look leaves markers or dots over."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import load
from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.kernels import second_look
from neurotouch_hid.tracker.kernels.correction import MAX_MISSED
from neurotouch_hid.tracker.kernels.tracks import SECOND, Tracks, Tuning

_LONGEST_US = 50_000  # a motion that is older says nothing


class SecondLook:
    """Remembers the markers of the last frame, and of the last certain one."""

    def __init__(self, tracks: Tracks, tuning: Tuning) -> None:
        n = len(tracks.rest_px)
        self._tracks, self._tuning = tracks, tuning
        self._before_px, self._velocity = np.zeros((n, 2)), np.zeros((n, 2))
        self._certain_px, self._place_px = np.zeros((n, 2)), np.empty((n, 2))
        self._blob = np.empty(n, np.int32)
        self._is_certain = False
        no_px, some = np.empty((0, 2)), np.empty(n, np.bool_)
        no_blobs = Blobs(no_px, np.zeros(1, np.int32), np.empty(0, np.int32))
        load(second_look.look_again, *self._list_arguments(no_blobs, 0.0, some, some))

    def remember(self) -> None:
        """Takes the markers before a frame moves them."""
        state = self._tracks.state
        self._before_px[:, 0], self._before_px[:, 1] = state["x"], state["y"]
        self._velocity[:, 0], self._velocity[:, 1] = state["vx"], state["vy"]

    def judge(self, *, is_certain: bool) -> None:
        """Takes whether the frame has shown for certain who is who."""
        if is_certain:
            state = self._tracks.state
            self._certain_px[:, 0], self._certain_px[:, 1] = state["x"], state["y"]
        self._is_certain = is_certain

    def look(
        self,
        blobs: Blobs,
        elapsed_us: int,
        absent: NDArray[np.bool_],
        inner: NDArray[np.bool_],
        n_left: int,
        n_most: int,
    ) -> tuple[int, int] | None:
        """Moves all tracks to where another look at the frame finds them, if it is certain.

        Args:
            blobs: of the frame.
            elapsed_us: time since the frame before.
            absent: (n,) bool, markers that are not seen at rest either.
            inner: (n,) bool, markers that are not at the rim of the gel.
            n_left: markers and dots that the first look leaves over.
            n_most: markers and dots that a look may leave over.

        Returns:
            The number of markers and of dots that are left over now; None if no look is twice
            as good as the first one and explains the frame, or if two do that differ.
        """
        tracks, place_px, blob = self._tracks, self._place_px, self._blob
        elapsed_s = SECOND * elapsed_us if 0 < elapsed_us <= _LONGEST_US else 0.0
        state = tracks.state
        n_markers, n_dots, n_hidden, is_unique = second_look.look_again(
            *self._list_arguments(blobs, elapsed_s, absent, inner)
        )
        seen = blob >= 0
        n_first = n_left + int(((state["n_missed"] > 0) & ~absent).sum())
        is_clear = 2 * (n_markers + n_dots + n_hidden) <= n_first
        if not (is_unique and is_clear) or n_markers + n_dots > n_most:
            return None
        state["x"], state["y"] = place_px[:, 0], place_px[:, 1]
        moved_px = place_px - self._before_px
        if self._is_certain and elapsed_s:
            state["vx"], state["vy"] = moved_px[:, 0] / elapsed_s, moved_px[:, 1] / elapsed_s
        else:
            state["vx"] = state["vy"] = 0.0
        state["n_missed"] = np.where(seen, 0, np.maximum(state["n_missed"], 1))
        tracks.lost[:] = state["n_missed"] >= MAX_MISSED
        return n_markers, n_dots

    def _list_arguments(
        self,
        blobs: Blobs,
        elapsed_s: float,
        absent: NDArray[np.bool_],
        inner: NDArray[np.bool_],
    ) -> tuple[Any, ...]:
        """Returns the arguments of ``look_again``."""
        tracks, state = self._tracks, self._tracks.state
        return (
            blobs.centroid_px,
            blobs.begin,
            self._before_px if self._is_certain else self._certain_px,
            elapsed_s * self._velocity,
            self._certain_px,
            np.column_stack([state["x"], state["y"]]),
            state["n_missed"] == 0,
            tracks.rest_px,
            tracks.neighbours,
            absent,
            inner,
            self._tuning,
            self._blob,
            self._place_px,
        )
