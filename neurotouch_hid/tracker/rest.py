"""Detects whether the gel is at rest: compares every frame with a reference.

[NT, "Resting Position Detection"].
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig, fit_rig
from neurotouch_hid.messages import (
    EventPacket,
    Frame,
    GelProblem,
    GelState,
    RestField,
)
from neurotouch_hid.process.kernel_cache import load
from neurotouch_hid.tracker.blobs import BlobFinder, Blobs
from neurotouch_hid.tracker.event_camera import EventCamera
from neurotouch_hid.tracker.gel_watch import GelWatch
from neurotouch_hid.tracker.kept_motion import PACE_US, KeptMotion
from neurotouch_hid.tracker.kernels import matching, rigid
from neurotouch_hid.tracker.lattice import Lattice, LatticeFinder
from neurotouch_hid.tracker.moved_rig import MovedRig
from neurotouch_hid.tracker.reference import Reference
from neurotouch_hid.tracker.rest_config import RestConfig
from neurotouch_hid.tracker.stillness import Stillness

_SAME_BEND_PX = 0.1  # two pictures of one undeformed gel differ by less
_CLEAR_BEND_PX = 0.19  # an untouched gel is bent less, with any optics
_SINKING_PX = 0.03  # from frame to frame; more means that a touch is just ending
_RIG_SHARE = 0.5  # of the limit of rest; markers that are farther off may show a rig that creeps


@dataclass(frozen=True, slots=True)
class RestStats:
    """Counts and measurements of the detector so far.

    Attributes:
        n_frames: number of frames.
        n_rest: number of frames at rest.
        n_references: number of references: 0 before the gel is found, more than 1 if it was moved.
        n_found: number of markers seen in the last frame.
        chamfer_px2: Chamfer distance of the last frame; NaN without a reference, and if the markers
            alone showed that the gel is not at rest.
        displacement_px: largest distance of a seen marker from its reference, without the
            ``max_displaced`` largest; NaN without a reference.
        problem: why the last frame is no gel at rest.
    """

    n_frames: int
    n_rest: int
    n_references: int
    n_found: int
    chamfer_px2: float
    displacement_px: float
    problem: GelProblem


class DrawnFrame(NamedTuple):
    """A frame drawn from events.

    Attributes:
        frame: the frame.
        blobs: its blobs; valid until the next frame is searched.
        rest: all markers, if the gel is at rest.
    """

    frame: Frame
    blobs: Blobs
    rest: RestField | None


class RestDetector:
    """Finds the gel, then decides for every frame whether it is at rest."""

    def __init__(
        self,
        config: RestConfig | None = None,
        rig: Rig | None = None,
        finder: BlobFinder | None = None,
        near_rad: float = 0.0,
        gel: Gel = PAPER_GEL,
    ) -> None:
        """Starts without a reference.

        Args:
            config: thresholds.
            rig: where the gel is known to be; None searches for it.
            finder: finds the blobs of frames; sharing it within a thread saves work.
            near_rad: the turn of the lattice that is expected, see ``LatticeFinder``.
            gel: the gel.
        """
        self._config = config or RestConfig()
        self._gel, self._lattice = gel, LatticeFinder(gel, self._config.lattice)
        self._rig, self._near_rad = rig, near_rad
        self._finder = finder or BlobFinder(self._config.blobs, gel)
        self._reference: Reference | None = None
        self._camera: EventCamera | None = EventCamera(self._lattice, rig, near_rad)
        self._match, no_px = np.empty(gel.n_markers, np.int32), np.empty((0, 2))
        load(rigid.creep, no_px, no_px, self._match, 0.0, no_px)  # the first frames do without it
        self._paced_us: int | None = None
        self._is_paced = False
        self._rig_watch, self._kept = MovedRig(), KeptMotion()
        self._still = Stillness(self._config.still, gel.n_markers // 3)
        self._bend_px = np.inf
        self._watch = GelWatch(self._lattice, near_rad)
        self._stats = RestStats(0, 0, 0, 0, float("nan"), float("nan"), GelProblem.WAITING)

    def stats(self) -> RestStats:
        """Returns the counts and measurements so far."""
        return self._stats

    @property
    def gel(self) -> GelState:
        """The gel as the frames so far show it."""
        return self._watch.state

    def note_flicker(self, hz: float | None) -> None:
        """Takes the frequency at which the light flickers, as events show it; None if it does not.

        ``gel`` then names it.
        """
        self._watch.flicker_hz = hz

    def note_camera(self, *, has_events: bool) -> None:
        """Takes whether the camera sends events; without, dots at rest are found as finely."""
        self._finder.is_fine = not has_events

    def note_haste(self, t_us: int) -> None:
        """Takes that the markers have just moved too fast for frames; ``gel`` then says so."""
        self._watch.haste_us = t_us

    def note_missing_frames(self, t_us: int) -> None:
        """Takes that frames no longer show the markers; ``gel`` says so if none come."""
        self._watch.miss(t_us)

    @property
    def is_watching(self) -> bool:
        """True while there is no frame yet and events may show the gel."""
        return self._camera is not None

    def update(self, frame: Frame) -> RestField | None:
        """Returns all markers if the frame shows the gel at rest, else None."""
        if self._camera is not None:  # what events have shown is not as good as a frame
            self._camera = self._reference = None
            self._watch.is_drawn = False
        return self._look(frame, self._finder.find(frame.pixels))

    def watch(self, packet: EventPacket) -> DrawnFrame | None:
        """Returns a frame that is drawn from events, now and then, if the camera sends none."""
        if self._camera is None:
            return None
        n_learnt = self._camera.n_learnt
        frame = self._camera.update(packet)
        if frame is None:
            if not self._camera.n_learnt:
                n_found = self._camera.n_found
                self._stats = replace(self._stats, n_found=n_found, problem=GelProblem.NO_FRAMES)
                self._watch.wait(packet.t_end_us, n_found)
            return None
        self._watch.is_drawn = True
        blobs = self._finder.find(frame.pixels)
        if self._camera.n_learnt == n_learnt:
            return DrawnFrame(frame, blobs, self._look(frame, blobs))
        return DrawnFrame(frame, blobs, self._take(frame, blobs))

    def _take(self, frame: Frame, blobs: Blobs) -> RestField | None:
        """Takes a frame as the reference that shows markers where they are at rest."""
        lattice = self._lattice.find(blobs.centroid_px, self._rig, near_rad=self._near_rad)
        if lattice is None:
            return None
        self._set_reference(lattice, frame, blobs)
        self._count(lattice.n_found, GelProblem.NONE, 0.0, 0.0)
        self._watch.rest(frame, blobs, lattice.blob, lattice.bend_px)
        return RestField(frame.t_us, lattice.position_px.astype(np.float32), is_new=True)

    def _look(self, frame: Frame, blobs: Blobs) -> RestField | None:
        # What tests motion from frame to frame leaves out some frames of a fast camera.
        since_us = None if self._paced_us is None else frame.t_us - self._paced_us
        self._is_paced = since_us is None or not 0 <= since_us < PACE_US
        if self._is_paced:
            self._paced_us = frame.t_us
        if self._reference is None:
            return self._search(frame, blobs)
        return self._compare(frame, blobs, self._reference)

    def _search(self, frame: Frame, blobs: Blobs) -> RestField | None:
        """Takes the frame as the reference if it shows the undeformed lattice."""
        lattice = self._lattice.find(blobs.centroid_px, self._rig, near_rad=self._near_rad)
        doubt = self._doubt(lattice)
        settled = self._is_paced and self._still.update(frame, blobs.centroid_px)
        shown_px = None
        if settled:  # a longer look than for ``doubt``
            doubt, shown_px = GelProblem.NONE, blobs.centroid_px.copy()
            frame, blobs, lattice = self._find_in_mean(frame, self._rig)
        n_found = len(blobs.centroid_px) if lattice is None else lattice.n_found
        problem = self._judge(lattice, odd=settled) or doubt
        if lattice is None or problem:
            self._count(n_found, problem)
            if not self._judge(lattice, odd=True):  # it is found as soon as it is still
                problem = GelProblem.LEARNING
            self._watch.search(frame, blobs, lattice, problem)
            return None
        self._set_reference(lattice, frame, blobs, shown_px)
        self._count(n_found, GelProblem.NONE, 0.0, 0.0)
        self._watch.rest(frame, blobs, lattice.blob, lattice.bend_px)
        position_px = lattice.position_px.astype(np.float32)
        return RestField(frame.t_us, position_px, blur_px=self._watch.blur_px)

    def _doubt(self, lattice: Lattice | None) -> GelProblem:
        """Returns whether a bent lattice may be the end of a touch."""
        bend_px = np.inf if lattice is None else lattice.bend_px
        is_sinking = not self._is_paced or bend_px < self._bend_px - _SINKING_PX
        if self._is_paced:
            self._bend_px = bend_px
        if bend_px > _CLEAR_BEND_PX and is_sinking:
            return GelProblem.LEARNING
        return GelProblem.NONE

    def _compare(self, frame: Frame, blobs: Blobs, reference: Reference) -> RestField | None:
        """Returns all markers if white pixels and markers are at the places of the reference."""
        n_found, off_px, chamfer_px2 = reference.compare(blobs, self._match)
        is_off = off_px > _RIG_SHARE * reference.limit_px
        if is_off and self._rig_watch.update(frame.t_us, blobs, reference, n_found, self._match):
            self._note_moved(reference, frame)
            n_found, off_px, chamfer_px2 = reference.compare(blobs, self._match)
        is_rest = chamfer_px2 <= self._config.max_chamfer_px2
        if is_rest:
            self._kept.forget()
            if reference.add(frame.t_us, blobs, self._match):
                self._note_moved(reference, frame)
        share, off_mm = n_found / reference.n_found, off_px / reference.px_per_mm
        if is_rest or self._kept.update(frame.t_us, blobs.centroid_px, share, off_mm):
            self._still.forget()
            self._count(n_found, GelProblem.NONE, chamfer_px2, off_px)
            self._watch.rest(frame, blobs, self._match, reference.bend_px)
            seen_px = reference.locate(blobs, self._match)
            return RestField(frame.t_us, seen_px, blur_px=self._watch.blur_px)
        self._count(n_found, GelProblem.TOUCHED, chamfer_px2, off_px)
        self._watch.touch(frame, blobs, n_found, off_px)
        return self._settle(frame, blobs, reference)

    def _note_moved(self, reference: Reference, frame: Frame) -> None:
        self._watch.find(reference.position_px, reference.n_found, frame)
        self._stats = replace(self._stats, n_references=self._stats.n_references + 1)

    def _settle(self, frame: Frame, blobs: Blobs, reference: Reference) -> RestField | None:
        """Takes a new reference if the gel is at rest elsewhere, and returns its markers."""
        if not (self._is_paced and self._still.update(frame, blobs.centroid_px)):
            return None
        shown_px = blobs.centroid_px.copy()
        frame, blobs, lattice = self._find_in_mean(frame, None)
        if (
            lattice is None
            or self._judge(lattice, odd=True)
            or lattice.bend_px > reference.bend_px + _SAME_BEND_PX
        ):
            return None
        self._set_reference(lattice, frame, blobs, shown_px)
        position_px = lattice.position_px.astype(np.float32)
        return RestField(frame.t_us, position_px, blur_px=self._watch.blur_px)

    def _find_in_mean(self, frame: Frame, rig: Rig | None) -> tuple[Frame, Blobs, Lattice | None]:
        """Returns the mean of the still frames that end with this one, its blobs and lattice."""
        mean = self._still.take_mean(frame)
        blobs = self._finder.find(mean.pixels)
        return mean, blobs, self._lattice.find(blobs.centroid_px, rig, near_rad=self._near_rad)

    def _set_reference(
        self,
        lattice: Lattice,
        frame: Frame,
        blobs: Blobs,
        shown_px: NDArray[np.float64] | None = None,
    ) -> None:
        """Takes a lattice as the reference.

        Args:
            lattice: the markers.
            frame: the frame that shows them, or the mean of several.
            blobs: its blobs.
            shown_px: (m, 2) px, the blobs of the last frame of a mean, which may show fewer.
        """
        self._reference = reference = Reference(lattice, blobs, self._gel, self._config)
        if shown_px is not None:
            n_shown = matching.match_points(
                lattice.position_px, shown_px, reference.gate_px, self._match
            )
            reference.n_found = min(reference.n_found, int(n_shown))
        n_found = reference.n_found
        # A gel that turns in its mount is searched at its new turn from now on.
        self._near_rad = fit_rig(lattice.position_px, self._gel).rotation_rad
        self._watch.find(lattice.position_px, n_found, frame)
        self._still.forget()
        s = self._stats
        self._stats = RestStats(
            s.n_frames, s.n_rest, s.n_references + 1, n_found, 0.0, 0.0, GelProblem.NONE
        )

    def _judge(self, lattice: Lattice | None, *, odd: bool = False) -> GelProblem:
        """Returns why this is no gel at rest; ``odd`` allows for odd optics."""
        c, most = self._config.lattice, self._config
        if lattice is None:
            return GelProblem.NO_DOTS
        if lattice.share < c.min_share or lattice.aside > c.max_aside:
            return GelProblem.MISSING
        if lattice.beyond > c.max_beyond:
            return GelProblem.PATTERN
        is_flat = lattice.bend_px <= c.max_bend_px
        max_bend_px = most.max_odd_bend_px if odd else c.max_bend_px
        max_displaced = most.max_odd_displaced if odd and is_flat else c.max_displaced
        if lattice.bend_px > max_bend_px or lattice.n_displaced > max_displaced:
            return GelProblem.TOUCHED
        if lattice.print_px > most.max_print_px and not odd:
            return GelProblem.LEARNING
        return GelProblem.NONE

    def _count(
        self,
        n_found: int,
        problem: GelProblem,
        chamfer_px2: float = float("nan"),
        displacement_px: float = float("nan"),
    ) -> None:
        s = self._stats
        self._stats = RestStats(
            s.n_frames + 1,
            s.n_rest + (not problem),
            s.n_references,
            n_found,
            chamfer_px2,
            displacement_px,
            problem,
        )
