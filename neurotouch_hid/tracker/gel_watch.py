"""Watches what the frames show of the gel, and says it only once it is sure."""

import math
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import find_median, fit_rig
from neurotouch_hid.messages import Frame, GelProblem, GelState
from neurotouch_hid.tracker.blobs import Blobs
from neurotouch_hid.tracker.diagnosis import Diagnosis, Motion, count_glints
from neurotouch_hid.tracker.lattice import Lattice, LatticeFinder
from neurotouch_hid.tracker.sharpness import is_blurred, measure_sharpness

_SURE_US: Final = 400_000  # a problem lasts as long before it replaces another one
_LOST_US: Final = 800_000  # as long as nothing of the gel is seen, before it is lost
_LOOK_US: Final = 500_000  # time between two diagnoses, and between two changes of numbers
_MOVED_US: Final = 10_000_000  # as long it is said that the gel has moved
_HASTE_US: Final = 5_000_000  # as long it is said that the hand was too fast
_MOVED_MM: Final = 0.5  # a smaller way is not worth a sentence
_TOUCH_US: Final = 2_000_000  # a touch that lasts longer ...
_LIGHT_US: Final = 1_200_000  # ... and is light and steady for this part of it, rests on the gel
_STEADY_PX: Final = 1.0  # a slow push changes more
_NO_FRAMES_US: Final = 500_000  # a camera sends its first picture sooner
_LIGHT_SHARE: Final = 0.9  # of the markers are near their places under a light touch
_SEEN_SHARE: Final = 0.5  # of the markers must be bright dots, wherever a touch moves them
_WHOLE_SHARE: Final = 0.9  # of the markers are on a gel that is held; one that has gone shows fewer
_ELSEWHERE: Final = GelProblem.OUTSIDE, GelProblem.SMALL, GelProblem.LARGE


class GelWatch:
    """Turns the results for single frames into the state of the gel.

    Args:
        finder: finds the gel within its limits.
        near_rad: the turn that is expected, see ``LatticeFinder``.

    Attributes:
        state: what is known of the gel; a new object when something changes.
        flicker_hz: frequency at which the light flickers; None if it is steady.
        haste_us: when the markers moved too fast for frames; None if they never did.
        is_drawn: frames are drawn from events, because the camera sends none.
    """

    def __init__(self, finder: LatticeFinder, near_rad: float = 0.0) -> None:
        self._gel = gel = finder.gel
        self.state = GelState(layout=gel)
        self.flicker_hz: float | None = None
        self.haste_us: int | None = None
        self.is_drawn = False
        self._diagnosis = Diagnosis(finder, near_rad)
        self._motion = Motion()
        self._first_px: NDArray[np.float64] | None = None
        self._place_px: NDArray[np.float64] = np.zeros(gel.points_mm.shape)
        self._n_found = 0
        self._centre_px, self._radius_px = np.zeros(2), 0.0
        self._px_per_mm, self._rotation_deg = 1.0, 0.0
        self._doubt: tuple[bool, GelProblem] | None = None
        self._doubt_us = self._told_us = 0
        self._looked_us: int | None = None
        self._moved_us: int | None = None
        self._moved_mm = 0.0
        self._touch_us: int | None = None
        self._light_us = self._last_us = 0
        self._light_px = 0.0
        self._rests = False
        self._begin_us: int | None = None
        self._seen = GelState(layout=gel)
        self._sharpness = GelProblem.NONE

    @property
    def blur_px(self) -> float:
        """Standard deviation of the point spread if the lens is out of focus, else 0."""
        blur_px = self._seen.blur_px
        return blur_px if blur_px and is_blurred(blur_px, self._px_per_mm) else 0.0

    def wait(self, t_us: int, n_seen: int) -> None:
        """Notes that there are events, but no frames yet."""
        self._begin_us = t_us if self._begin_us is None else self._begin_us
        if t_us - self._begin_us >= _NO_FRAMES_US:
            self._consider(
                GelState(layout=self._gel, problem=GelProblem.NO_FRAMES, n_seen=n_seen), t_us
            )

    def miss(self, t_us: int) -> None:
        """Notes that events alone show the markers; dark frames have their own reason."""
        if self.state.is_found and t_us - self._last_us >= _NO_FRAMES_US:
            self._consider(self.state, t_us, problem=GelProblem.EVENTS_ONLY)

    def search(
        self, frame: Frame, blobs: Blobs, lattice: Lattice | None, problem: GelProblem
    ) -> None:
        """Notes a frame in which the gel is not found.

        Args:
            frame: the frame.
            blobs: its bright dots.
            lattice: the markers among them, or None.
            problem: why that is no gel at rest.
        """
        moves = self._motion.update(blobs.centroid_px, frame.t_us)
        if self._is_due(frame.t_us, problem):
            self._seen = self._diagnosis.explain(frame, blobs, lattice, problem, moves=moves)
        self._consider(self._seen, frame.t_us)

    def find(self, position_px: NDArray[np.float64], n_found: int, frame: Frame) -> None:
        """Notes a reference: where the markers are at rest, from now on.

        Args:
            position_px: (n, 2) px.
            n_found: how many of them were seen.
            frame: the frame that shows them.
        """
        rig = fit_rig(position_px, self._gel)
        if self._first_px is None:
            self._first_px = position_px
        moved_px = float(find_median(np.hypot(*(position_px - self._first_px).T)))
        self._moved_mm = round(moved_px / rig.px_per_mm, 1)
        if self._moved_mm > _MOVED_MM:
            self._moved_us = frame.t_us
        self._place_px, self._n_found = position_px, n_found
        self._px_per_mm, self._rotation_deg = rig.px_per_mm, math.degrees(rig.rotation_rad)
        self._centre_px = np.array(rig.centre_px)
        reach = np.hypot(*(position_px - self._centre_px).T).max()
        self._radius_px = float(reach) + self._gel.pitch_mm * rig.px_per_mm
        self._touch_us = None

    def rest(self, frame: Frame, blobs: Blobs, blob: NDArray[np.integer], bend_px: float) -> None:
        """Notes a frame that shows the gel at rest.

        Args:
            frame: the frame.
            blobs: its bright dots.
            blob: (n,), the dot of each marker; negative without one.
            bend_px: bend of the lattice.
        """
        self._touch_us, self._rests, self._last_us = None, False, frame.t_us
        if self._is_due(frame.t_us, GelProblem.NONE) or not self.state.is_found:
            self._seen = self._describe(frame, blobs, blob, bend_px)
        self._consider(self._seen, frame.t_us, problem=self._find_flaw(frame.t_us))

    def touch(self, frame: Frame, blobs: Blobs, n_found: int, displacement_px: float) -> None:
        """Notes a frame in which the gel is deformed, or not seen at all.

        Args:
            frame: the frame.
            blobs: its bright dots.
            n_found: markers that are near their places.
            displacement_px: how far they are off.
        """
        since_us, self._last_us = frame.t_us - self._last_us, frame.t_us
        if self._touch_us is None:
            self._touch_us, self._light_us = frame.t_us, 0
        if abs(displacement_px - self._light_px) > _STEADY_PX:
            self._light_px, self._light_us = displacement_px, 0
        elif n_found >= _LIGHT_SHARE * self._n_found:
            self._light_us += since_us
        if frame.t_us - self._touch_us > _TOUCH_US and self._light_us > _LIGHT_US:
            self._rests = True
        gone = self._find_gone(frame, blobs, n_found)
        if gone is not None:
            self._consider(gone, frame.t_us, is_found=False, was_found=True)
        elif self.state.is_found:
            self._consider(self.state, frame.t_us, problem=self._find_flaw(frame.t_us))

    def _find_gone(self, frame: Frame, blobs: Blobs, n_found: int) -> GelState | None:
        """Returns what is seen instead of the gel; None if a hand may have moved its markers."""
        share = _SEEN_SHARE * self._n_found
        if n_found >= share:
            return None
        apart_px = np.hypot(*(blobs.centroid_px - self._centre_px).T)
        n_inside = int((apart_px < self._radius_px).sum())
        if n_inside >= _WHOLE_SHARE * self._n_found:
            return None  # at once: a diagnosis takes 10 ms, and play would wait for it
        if self._is_due(frame.t_us, GelProblem.NO_DOTS):
            self._seen = self._diagnosis.explain(
                frame, blobs, None, GelProblem.NO_DOTS, moves=False
            )
        elsewhere = self._seen.problem in _ELSEWHERE
        return self._seen if n_inside < share or elsewhere else None

    def _describe(
        self, frame: Frame, blobs: Blobs, blob: NDArray[np.integer], bend_px: float
    ) -> GelState:
        """Returns a gel at rest with all its figures."""
        place_px = self._place_px
        missing = np.flatnonzero(blob < 0)
        blur_px, self._sharpness = measure_sharpness(
            frame.pixels, blobs, self._px_per_mm, self._gel
        )
        return GelState(
            layout=self._gel,
            is_found=True,
            was_found=True,
            problem=GelProblem.NONE,
            n_seen=len(blob) - len(missing),
            missing=tuple(missing.tolist()),
            missing_px=tuple((round(x, 1), round(y, 1)) for x, y in place_px[missing].tolist()),
            px_per_mm=round(self._px_per_mm, 2),
            rotation_deg=round(self._rotation_deg, 1),
            bend_px=round(bend_px, 1),
            blur_px=blur_px,
            n_glints=count_glints(frame.pixels, blobs, blob, self._gel),
        )

    def _find_flaw(self, t_us: int) -> GelProblem:
        """Returns what is wrong with a gel that is found."""
        if self.is_drawn:
            return GelProblem.EVENTS_ONLY
        if self._sharpness or self._rests:
            # Frames that are not sharp do not show whether something rests on the gel.
            return self._sharpness or GelProblem.RESTS
        if self.flicker_hz is not None:
            return GelProblem.FLICKER
        if self.haste_us is not None and t_us - self.haste_us < _HASTE_US:
            return GelProblem.TOO_FAST
        if self._moved_us is not None and t_us - self._moved_us < _MOVED_US:
            return GelProblem.MOVED
        return GelProblem.NONE

    def _is_due(self, t_us: int, problem: GelProblem) -> bool:
        """Returns whether it is time for another look at the whole frame."""
        fits = bool(problem) == bool(self._seen.problem)
        before_us = self._looked_us
        if fits and before_us is not None and 0 <= t_us - before_us < _LOOK_US:
            return False
        self._looked_us = t_us
        return True

    def _consider(self, seen: GelState, t_us: int, **changes: Any) -> None:
        """Takes what is seen, with changes, as the state, once it lasted; good news at once."""
        changes |= {"flicker_hz": self.flicker_hz, "moved_mm": self._moved_mm}
        if any(getattr(seen, name) != value for name, value in changes.items()):
            seen = replace(seen, **changes)
        now = self.state
        if seen == now:
            self._doubt = None
            return
        key = (seen.is_found, seen.problem)
        if key == (now.is_found, now.problem):
            self._doubt = None
            if not 0 <= t_us - self._told_us < _LOOK_US:
                self.state, self._told_us = seen, t_us
            return
        if key != self._doubt:
            self._doubt, self._doubt_us = key, t_us
        wait_us = _LOST_US if now.is_found and not seen.is_found else _SURE_US
        good = seen.is_found and not (now.is_found and seen.problem)
        first = now.problem is GelProblem.WAITING
        if good or first or t_us - self._doubt_us >= wait_us:
            self.state, self._told_us, self._doubt = seen, t_us, None
