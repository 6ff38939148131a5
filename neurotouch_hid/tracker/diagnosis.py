"""Finds out why a frame shows no gel, from the frame itself."""

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, fit_rig
from neurotouch_hid.messages import (
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    Frame,
    GelProblem,
    GelState,
)
from neurotouch_hid.process.kernel_cache import load
from neurotouch_hid.tracker.blobs import Blobs, lighten
from neurotouch_hid.tracker.growth import find_net
from neurotouch_hid.tracker.kernels import dots as kernels
from neurotouch_hid.tracker.kernels import matching
from neurotouch_hid.tracker.lattice import Lattice, LatticeFinder
from neurotouch_hid.tracker.sharpness import is_blurred, measure_sharpness
from neurotouch_hid.tracker.spectrum import find_pattern

_DARK, _DIM = 16.0, 50.0  # grey levels that 199 of 200 pixels of a dark picture do not reach
_SATURATED, _BRIGHT_SHARE = 250, 0.1  # share of saturated pixels of a picture that is too bright
_WIDE: Final = (
    2.8,
    255.0,
)  # pitch and radius in px, searched for a gel that is too small or too large
_MOST_SCATTER: Final = 0.0875  # of the pitch; single markers farther off their places are irregular
_GLINT: Final = 1.2  # as much brighter than the markers around it is a reflection ...
_USUAL: Final = 0.9  # ... than the brighter ones of them: some may be faint
_BENT_PX: Final = 0.8  # a smaller bend is no touch
_REGULAR: Final = 0.6  # share of dots whose neighbour is as far as everybody's
_MOTION_GATE_PX, _MOTION_PX, _MOTION_US = 3.0, 0.2, 1_500_000
_EDGE_DOTS: Final = 5  # as many dots along the border: the gel goes on behind it


class Motion:
    """Tells whether some of the dots move, as they do under every hand."""

    def __init__(self) -> None:
        self._before_px: NDArray[np.float64] = np.empty((0, 2))
        self._begin_us: int | None = None
        self._moved_us: int | None = None
        no_px, match = self._before_px, np.empty(0, np.int32)
        load(matching.match_points, no_px, no_px, _MOTION_GATE_PX, match)

    def update(self, centroid_px: NDArray[np.float64], t_us: int) -> bool | None:
        """Returns whether dots have moved lately; None if that is not known yet."""
        if self._begin_us is None:
            self._begin_us = t_us
        before, now = self._before_px, centroid_px.copy()
        self._before_px = now
        match = np.empty(len(before), np.int32)
        matching.match_points(before, now, _MOTION_GATE_PX, match)
        seen = match >= 0
        if seen.sum() > len(before) // 2:
            moved = np.hypot(*(now[match[seen]] - before[seen]).T)
            if np.percentile(moved, 95) > _MOTION_PX:
                self._moved_us = t_us
        if self._moved_us is not None and t_us - self._moved_us < _MOTION_US:
            return True
        return None if t_us - self._begin_us < _MOTION_US else False


class Diagnosis:
    """Explains frames without a gel.

    Args:
        finder: finds the gel within its limits.
        near_rad: the turn that is expected, see ``LatticeFinder``.
    """

    def __init__(self, finder: LatticeFinder, near_rad: float) -> None:
        self._gel, self._config, self._near_rad = finder.gel, finder.config, near_rad
        wide = replace(finder.config, min_pitch_px=_WIDE[0], max_radius_px=_WIDE[1])
        self._wide = LatticeFinder(finder.gel, wide)
        net = find_net(finder.gel)
        self._is_square = net is not None and net.n_turns == 4

    def explain(
        self,
        frame: Frame,
        blobs: Blobs,
        lattice: Lattice | None,
        problem: GelProblem,
        *,
        moves: bool | None,
    ) -> GelState:
        """Returns the state of a gel that is not found, with its true problem.

        Args:
            frame: the frame.
            blobs: its bright dots.
            lattice: the lattice among them, if there is one.
            problem: why that is no gel at rest.
            moves: some dots have moved lately; None if that is not known yet.
        """
        if problem in (GelProblem.TOUCHED, GelProblem.LEARNING) and lattice is not None:
            return self._explain_bent(frame, blobs, lattice, problem, moves=moves)
        if problem is GelProblem.PATTERN and lattice is not None:
            return replace(measure_gel(frame, blobs, lattice, self._gel), problem=problem)
        if light := _judge_light(frame.pixels):
            return GelState(layout=self._gel, problem=light, n_seen=len(blobs.centroid_px))
        return self._look_again(frame, blobs, moves=moves)

    def _explain_bent(
        self,
        frame: Frame,
        blobs: Blobs,
        lattice: Lattice,
        problem: GelProblem,
        *,
        moves: bool | None,
    ) -> GelState:
        """Explains a lattice with enough markers that are not where they should be."""
        state = measure_gel(frame, blobs, lattice, self._gel)
        if problem is GelProblem.LEARNING or moves is None:
            return replace(state, problem=GelProblem.LEARNING)
        if state.problem:
            problem = state.problem
        elif state.n_glints > self._config.max_displaced and not moves:
            problem = GelProblem.GLINTS
        elif not moves:
            problem = GelProblem.BENT
        return replace(state, problem=problem)

    def _look_again(self, frame: Frame, blobs: Blobs, *, moves: bool | None) -> GelState:
        """Looks for a gel that is too small, too large or not whole."""
        lattice = self._wide.find(blobs.centroid_px, near_rad=self._near_rad)
        if lattice is None:
            return self._explain_scattered(frame, blobs)
        state = measure_gel(frame, blobs, lattice, self._gel)
        return replace(state, problem=self._judge(state, lattice, blobs, moves=moves))

    def _judge(
        self, state: GelState, lattice: Lattice, blobs: Blobs, *, moves: bool | None
    ) -> GelProblem:
        """Returns the problem of a lattice with too few markers, or in the wrong place."""
        px_per_mm = state.px_per_mm or 1.0
        if lattice.beyond > self._config.max_beyond:
            return GelProblem.PATTERN
        if problem := self._judge_view(px_per_mm, state.problem):
            return problem
        if _is_outside(state, blobs.centroid_px):
            return GelProblem.OUTSIDE
        if moves is not False and lattice.bend_px > _BENT_PX:
            return GelProblem.TOUCHED if moves else GelProblem.LEARNING
        if lattice.print_px > _MOST_SCATTER * self._gel.pitch_mm * px_per_mm:
            return GelProblem.IRREGULAR
        return GelProblem.GLINTS if state.n_glints > len(state.missing) else GelProblem.MISSING

    def _judge_view(self, px_per_mm: float, sharpness: GelProblem) -> GelProblem:
        """Returns what is wrong with the scale, or else with how sharp the dots are."""
        if px_per_mm * self._gel.pitch_mm < self._config.min_pitch_px:
            return GelProblem.SMALL
        if px_per_mm * self._gel.radius_mm > self._config.max_radius_px:
            return GelProblem.LARGE
        return sharpness

    def _explain_scattered(self, frame: Frame, blobs: Blobs) -> GelState:
        """Explains bright dots that form no lattice."""
        n_seen = len(blobs.centroid_px)
        state = GelState(layout=self._gel, problem=GelProblem.NO_DOTS, n_seen=n_seen)
        pitch_px = _find_pitch(blobs.centroid_px)
        if pitch_px is not None and _touches_border(blobs.centroid_px, pitch_px):
            scale = round(pitch_px / self._gel.pitch_mm, 2)
            problem = self._judge_view(scale, GelProblem.NONE) or GelProblem.OUTSIDE
            return replace(state, problem=problem, px_per_mm=scale)
        # Only a square lattice looks the same after a quarter turn, which the pattern relies on.
        pattern = find_pattern(frame.pixels, self._gel) if self._is_square else None
        if pattern is None:
            is_dim = float(np.percentile(frame.pixels, 99.5)) < _DIM
            return replace(state, problem=GelProblem.DARK) if is_dim else state
        if n_seen >= self._config.min_share * self._gel.n_markers:  # seen, but not where they fit
            return replace(state, problem=GelProblem.BENT)
        px_per_mm, blur_px = (round(pattern.px_per_mm, 2), round(pattern.blur_px, 1))
        is_soft = is_blurred(blur_px, px_per_mm)
        sharpness = GelProblem.BLURRED if is_soft else GelProblem.NONE
        problem = self._judge_view(px_per_mm, sharpness) or GelProblem.FAINT
        return replace(state, problem=problem, px_per_mm=px_per_mm, blur_px=blur_px)


def _find_pitch(dots_px: NDArray[np.float64]) -> float | None:
    """Returns the distance of regular dots, px; None if they are not regular."""
    if len(dots_px) < 2 * _EDGE_DOTS:
        return None
    apart = np.hypot(*(dots_px[:, None] - dots_px).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    nearest = apart.min(axis=1)
    pitch_px = float(np.median(nearest))
    is_regular = (np.abs(nearest - pitch_px) < 0.15 * pitch_px).mean() > _REGULAR
    return pitch_px if is_regular else None


def _judge_light(pixels: NDArray[np.uint8]) -> GelProblem:
    if float(np.percentile(pixels, 99.5)) < _DARK:
        return GelProblem.DARK
    if float((pixels >= _SATURATED).mean()) > _BRIGHT_SHARE:
        return GelProblem.BRIGHT
    return GelProblem.NONE


def measure_gel(frame: Frame, blobs: Blobs, lattice: Lattice, gel: Gel) -> GelState:
    """Returns the figures of a lattice that was found among the blobs of a frame.

    Its problem is that of dots which are not sharp.
    """
    px_per_mm = fit_rig(lattice.position_px, gel).px_per_mm
    missing = np.flatnonzero(lattice.blob < 0)
    places = lattice.position_px[missing].tolist()
    blur_px, problem = measure_sharpness(frame.pixels, blobs, px_per_mm, gel)
    return GelState(
        layout=gel,
        problem=problem,
        n_seen=lattice.n_found,
        missing=tuple(missing.tolist()),
        missing_px=tuple((round(x, 1), round(y, 1)) for x, y in places),
        px_per_mm=round(px_per_mm, 2),
        bend_px=round(lattice.bend_px, 1),
        scatter_px=round(lattice.print_px, 1),
        blur_px=blur_px,
        n_glints=count_glints(frame.pixels, blobs, lattice.blob, gel),
    )


def _is_outside(state: GelState, dots_px: NDArray[np.float64]) -> bool:
    """Returns whether a part of the gel is outside of the picture."""
    places = np.array(state.missing_px).reshape(-1, 2)
    size = np.array((SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX))
    beyond = ((places < 0) | (places > size - 1)).any(axis=1)
    if beyond.sum() > 0.4 * len(places):
        return True
    px_per_mm = state.px_per_mm or 1.0
    is_small = 2.2 * state.layout.radius_mm * px_per_mm < SENSOR_HEIGHT_PX
    return is_small and _touches_border(dots_px, state.layout.pitch_mm * px_per_mm)


def _touches_border(dots_px: NDArray[np.float64], pitch_px: float) -> bool:
    size = np.array((SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX))
    low, high = (dots_px < pitch_px).sum(axis=0), (dots_px > size - 1 - pitch_px).sum(axis=0)
    return int(max(low.max(), high.max())) >= _EDGE_DOTS


def count_glints(
    pixels: NDArray[np.uint8], blobs: Blobs, blob: NDArray[np.integer], gel: Gel
) -> int:
    """Returns how many reflections there are on the gel; the arguments are of ``find_glints``."""
    return len(find_glints(pixels, blobs, blob, gel))


def find_glints(
    pixels: NDArray[np.uint8], blobs: Blobs, blob: NDArray[np.integer], gel: Gel
) -> NDArray[np.intp]:
    """Returns which bright dots on the gel are brighter than the markers around them.

    Args:
        pixels: (260, 346) uint8.
        blobs: the bright dots.
        blob: (n,), the one of each marker; negative without one.
        gel: the gel.
    """
    dots_px, blob = blobs.centroid_px, blob.astype(np.int32)  # kernels are for one type only
    peak = kernels.find_peaks(lighten(pixels, gel), dots_px)
    usual = kernels.find_usual_peaks(peak, blob, gel.neighbours, _USUAL)
    marker = kernels.find_markers(dots_px, blob)
    on_gel = np.flatnonzero(marker >= 0)
    glints: NDArray[np.intp] = on_gel[peak[on_gel] > _GLINT * usual[marker[on_gel]]]
    return glints
