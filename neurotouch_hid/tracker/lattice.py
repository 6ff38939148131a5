"""Finds the markers of a known gel among the blobs of a frame of the gel at rest."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig, count_turns, find_median
from neurotouch_hid.tracker.alignment import Alignment
from neurotouch_hid.tracker.beyond import find_beyond
from neurotouch_hid.tracker.growth import Growth, find_net
from neurotouch_hid.tracker.smooth_map import GATE, assign, fit_model

_PRINT_BEND = 3.3  # the largest of 177 means, in standard errors of a mean on one axis


@dataclass(frozen=True, slots=True)
class LatticeConfig:
    """Limits within which blobs are accepted as the gel.

    Attributes:
        min_pitch_px: the smallest scale searched: nearer dots run together; nominal 10 [NT,
            "Results"].
        max_radius_px: the largest scale searched: more of the gel would not be in the picture.
        min_share: least share of the markers that must be seen; the model gives the others. A gel
            made by hand lacks some here and there.
        max_aside: largest distance of the middle of the seen markers from that of all, as a share
            of the gel's radius. If markers lack on one side, the picture does not show the whole
            gel.
        max_bend_px: largest ``Lattice.bend_px`` of an undeformed gel. Measured on simulated gels:
            0.2 for strong optics and a print tolerance of 0.1 mm, 0.7 to 1.4 for one finger that
            pushes by 1 mm.
        max_displaced: largest ``Lattice.n_displaced`` of an undeformed gel.
        max_beyond: largest ``Lattice.beyond`` of a gel. At random places, one blob per
            square of the pitch gives 0.12, and four give 0.4. A square panel with as many dots
            across as the gel gives 0.56, a pattern without an end 1.
    """

    min_pitch_px: float = 5.6
    max_radius_px: float = 138.0
    min_share: float = 0.675
    max_aside: float = 2.5 / 30.0
    max_bend_px: float = 0.6
    max_displaced: int = 4
    max_beyond: float = 0.45


@dataclass(frozen=True, slots=True, eq=False)
class Lattice:
    """The lattice that was found.

    Attributes:
        position_px: (n, 2) float64 px, columns x, y, in the order of ``Gel.points_mm``; the model
            gives markers that were not seen.
        blob: (n,) intp, the blob of each marker, -1 for a marker that was not seen.
        bend_px: the largest mean deviation from the model of a marker and its neighbours, beyond
            what the tolerance of single markers explains: what bends has neighbours that bend.
        print_px: the tolerance of single markers, standard deviation on one axis.
        aside: distance of the middle of the seen markers from that of all, as a share of the gel's
            radius.
        n_displaced: number of markers that were not seen at their place, but have a blob near it
            that is no other marker.
        beyond: share of the places around the gel, one pitch outside of its markers, that have a
            blob; 0 if too few of them are in the picture. A gel ends; other patterns go on.
    """

    position_px: NDArray[np.float64]
    blob: NDArray[np.intp]
    bend_px: float
    print_px: float
    aside: float
    n_displaced: int
    beyond: float

    @property
    def n_found(self) -> int:
        """The number of markers that were seen."""
        return int((self.blob >= 0).sum())

    @property
    def share(self) -> float:
        """The share of the markers that were seen."""
        return self.n_found / len(self.blob)


class LatticeFinder:
    """Finds the markers of one gel.

    Args:
        gel: the gel.
        config: the ranges searched.
    """

    def __init__(self, gel: Gel = PAPER_GEL, config: LatticeConfig | None = None) -> None:
        self.gel, self.config = gel, config or LatticeConfig()
        # Each marker and its neighbours.
        self._around = np.column_stack([np.arange(gel.n_markers), gel.neighbours])
        self._beyond = find_beyond(gel)
        low_px = self.config.min_pitch_px
        high_px = self.config.max_radius_px / gel.radius_mm * gel.pitch_mm
        net, n_turns = find_net(gel), count_turns(gel)
        self._search: Growth | Alignment = (
            Alignment(gel, n_turns, low_px, high_px)
            if net is None
            else Growth(gel, net, n_turns, low_px, high_px)
        )

    def find(
        self, centroid_px: NDArray[np.float64], rig: Rig | None = None, *, near_rad: float = 0.0
    ) -> Lattice | None:
        """Returns the lattice among blobs, or None if nothing looks like one.

        A first model comes from the rig, from the growth of a lattice, or from the alignment of a
        gel that is on none. A smooth model (similarity, perspective, dome and lens to fifth order)
        then decides which blobs belong to the gel.

        Args:
            centroid_px: (m, 2) float64 px.
            rig: where the gel is, if that is known.
            near_rad: the turn of the gel that is expected: of several that look the same, the
                nearest to it counts.
        """
        gel, n = self.gel, self.gel.n_markers
        if len(centroid_px) < n // 4:
            return None
        if rig is None:
            found = self._search.search(centroid_px, near_rad)
            if found is None:
                return None
            model, pitch_px = found
        else:
            model, pitch_px = rig.to_px(gel.points_mm), rig.px_per_mm * gel.pitch_mm
        blob = assign(model, centroid_px, 0.4 * pitch_px)
        for _ in range(3):
            if (blob >= 0).sum() < n // 3:
                return None
            model = fit_model(centroid_px, blob, gel)
            blob = assign(model, centroid_px, GATE * pitch_px)
        is_seen = blob >= 0
        if is_seen.sum() < n // 3:
            return None
        position = model.copy()
        position[is_seen] = centroid_px[blob[is_seen]]
        off = np.where(is_seen[:, None], position - model, 0.0)
        bend, own, error = self._average(off, is_seen)
        tolerance = 1.4826 * float(find_median(np.abs(own[is_seen]).ravel()))
        bend2 = float(((bend**2).sum(axis=1) - (_PRINT_BEND * tolerance * error) ** 2).max())
        is_free = np.ones(len(centroid_px), np.bool_)
        is_free[blob[is_seen]] = False
        free = np.flatnonzero(is_free)
        displaced = assign(model[~is_seen], centroid_px[free], pitch_px) >= 0
        aside_mm = np.hypot(*(gel.points_mm[is_seen].mean(axis=0) - gel.points_mm.mean(axis=0)))
        bend_px = math.sqrt(max(bend2, 0.0))
        aside = float(aside_mm) / gel.radius_mm
        beyond = self._beyond.measure(position, centroid_px[free], pitch_px)
        return Lattice(position, blob, bend_px, tolerance, aside, int(displaced.sum()), beyond)

    def _average(
        self, off_px: NDArray[np.float64], found: NDArray[np.bool_]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Returns each marker's deviation averaged with its neighbours', and what that leaves over.

        The third result is the standard error of each average, (n,), in tolerances of a marker: it
        is larger where neighbours are missing.

        Args:
            off_px: (n, 2) float64 px, deviations from the model, 0 for markers that are not seen.
            found: (n,) bool, markers that are seen.
        """
        use = (self._around >= 0) & found[self._around]
        total = np.where(use[:, :, None], off_px[self._around], 0.0).sum(axis=1)
        number = use.sum(axis=1)
        divisor = np.maximum(number, 4)  # few neighbours prove nothing
        mean = total / divisor[:, None]
        return mean, off_px - mean, np.sqrt(number) / divisor
