"""Judges whether frames alone tell the markers apart, or the hand is too fast for the camera."""

import numpy as np

from neurotouch_hid.geometry import NOMINAL_PITCH_PX, Gel
from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.kernels import correction, matching
from neurotouch_hid.tracker.kernels.tracks import Tracks, Tuning
from neurotouch_hid.tracker.kernels.unexplained import count_unexplained
from neurotouch_hid.tracker.second_look import SecondLook

_NEVER_US = -(1 << 60)
_UNSURE_SHARE = 0.055  # of the markers unseen: others are taken for their neighbours
_SURE_SHARE = 0.025  # of the markers, which fingers that pinch hide as well
_MOST_STRANGERS = 2  # dots that are no marker's, beyond those at rest
_HIDDEN_SHARE = 0.1  # of the markers; more are not hidden by dots that run together
_EXPLAINED_FRAMES = 2  # in a row, until the markers are told apart again
_HASTY_US = 100_000  # markers that were too fast are told apart by then, or have been mistaken
_OTHERS_SHARE = 0.05  # of the dots, which noise and fingers hide or show
_SLOW_PITCHES = 0.25  # from frame to frame; no dot that moves less is taken for another


class FrameIdentity:
    """Judges each frame that has moved the tracks, and looks at it again in doubt.

    Args:
        tracks: the tracks that follow frames.
        tuning: of the neighbour check.
        gel: the gel.

    Attributes:
        is_unsure: frames alone do not tell the markers apart, because they move too fast.
        frame_us: the middle of the last exposure that was judged.
    """

    def __init__(self, tracks: Tracks, tuning: Tuning, gel: Gel) -> None:
        n = gel.n_markers
        self._tracks = tracks
        self._second_look = SecondLook(tracks, tuning)
        self.is_unsure, self.frame_us = False, 0
        self._absent = np.zeros(n, np.bool_)  # markers that the last frame at rest hid
        far_mm = np.hypot(*(gel.points_mm - gel.points_mm.mean(axis=0)).T)
        self._inner = far_mm <= far_mm.max() - gel.pitch_mm
        self._place_px = np.empty((n, 2))
        self._n_strangers = self._n_strangers_at_rest = 0
        self._n_explained = 0  # pictures in a row that contradict no track
        self._hasty_us = _NEVER_US  # the last time that a marker went more than half of the pitch
        self._moving_us = _NEVER_US  # the last time that a hasty picture was not slow
        self._dots_px = np.empty((0, 2))  # the markers' dots in the last frame

    def anchor(self) -> None:
        """Takes that the gel is at rest, which tells all markers apart."""
        self._absent, self.is_unsure = self._tracks.state["n_missed"] > 0, False
        self._n_strangers_at_rest = self._n_strangers

    def remember(self) -> None:
        """Takes the markers before a frame moves them."""
        self._second_look.remember()

    def judge(self, t_us: int, blobs: Blobs) -> None:
        """Tells the markers apart in a frame, and notes whether that is certain.

        It may not be where a marker goes more than half of the pitch from frame to frame and others
        are not seen. Fingers that squeeze dots together hide some as well, but then no dot is left
        over; a patch of tracks that is one place off leaves some behind it.
        """
        state, elapsed_us = self._tracks.state, t_us - self.frame_us
        self.frame_us = t_us
        going_px = 1e-6 * elapsed_us * float(np.hypot(state["vx"], state["vy"]).max())
        if going_px > 0.5 * NOMINAL_PITCH_PX:
            self._hasty_us = t_us
        is_hasty = t_us - self._hasty_us <= _HASTY_US
        if (is_hasty or self.is_unsure) and not self._is_picture_slow(blobs):
            self._moving_us = t_us
        # A hand that has stopped counts again, though some markers are at a neighbour's place.
        is_moving = t_us - self._moving_us <= _HASTY_US
        n_vanished, n_strangers = self._count_unexplained(blobs)
        n_most = self._n_strangers_at_rest + _MOST_STRANGERS
        if is_hasty and n_vanished + n_strangers > n_most:
            n_left = n_vanished + n_strangers
            look = self._second_look.look(
                blobs, elapsed_us, self._absent, self._inner, n_left, n_most
            )
            n_vanished, n_strangers = look or (n_vanished, n_strangers)
        self._n_strangers = n_strangers
        unseen = float(((state["n_missed"] > 0) & ~self._absent).mean())
        n_more = n_strangers - self._n_strangers_at_rest
        is_explained = n_more <= _MOST_STRANGERS and n_vanished <= _HIDDEN_SHARE * len(state)
        self._n_explained = self._n_explained + 1 if is_explained else 0
        is_shifted = n_more > _MOST_STRANGERS and n_vanished > _MOST_STRANGERS
        if self.is_unsure:
            is_sure = unseen <= _SURE_SHARE and n_more <= _MOST_STRANGERS
            is_told = is_sure or self._n_explained >= _EXPLAINED_FRAMES
            self.is_unsure = is_moving and not is_told
        elif is_shifted or (unseen > _UNSURE_SHARE and not is_explained):
            self.is_unsure = is_moving and is_hasty
        seen = state["n_missed"] == 0
        self._dots_px = np.column_stack([state["x"][seen], state["y"][seen]])
        self._second_look.judge(is_certain=is_explained and not self.is_unsure)

    def _is_picture_slow(self, blobs: Blobs) -> bool:
        """Returns whether the markers' dots have hardly moved since the last frame.

        It does not matter whose they are. Specks of noise come and go, so they do not count.
        """
        before_px, match = self._dots_px, np.empty(len(self._dots_px), np.int32)
        n_most = int(_OTHERS_SHARE * len(before_px))
        n_pairs, way_px = matching.measure_largest(
            before_px, blobs.centroid_px, correction.GATE_PX, n_most, match
        )
        is_slow = way_px <= _SLOW_PITCHES * NOMINAL_PITCH_PX
        return bool(is_slow and n_pairs >= len(before_px) - n_most)

    def _count_unexplained(self, blobs: Blobs) -> tuple[int, int]:
        """Returns how many markers and how many dots of a frame contradict the tracks."""
        state, place_px = self._tracks.state, self._place_px
        place_px[:, 0], place_px[:, 1] = state["x"], state["y"]
        is_seen = state["n_missed"] == 0
        n_vanished, n_strangers = count_unexplained(
            blobs.centroid_px, blobs.begin, place_px, is_seen, self._absent, self._inner
        )
        return int(n_vanished), int(n_strangers)
