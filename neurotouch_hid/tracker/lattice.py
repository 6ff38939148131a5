"""Finds the markers of a known gel among the blobs of a frame of the gel at rest."""

import cmath
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX

_GATE = 0.42  # of the pitch: a dot farther from its site may belong to the next one
_CELL_PX, _N_SMOOTH, _N_PEAK = 0.25, 3, 6  # of the vote for the lattice's side
_LEAST_VOTE = 2.5  # times the mean vote; dots without any lattice reach less
_PRINT_BEND = 1.1  # the largest of 177 means of nine, in tolerances of single markers


@dataclass(frozen=True, slots=True)
class LatticeConfig:
    """Limits within which blobs are accepted as the gel.

    Attributes:
        min_pitch_px, max_pitch_px: range of scales searched; nominal 10 [NT, "Results"].
        min_share: least share of the markers that must be seen; the model gives the others. A gel
            made by hand lacks some here and there.
        max_aside: largest distance of the middle of the seen markers from that of all, as a share
            of the gel's radius. If markers lack on one side, the picture does not show the whole
            gel.
        max_bend_px: largest ``Lattice.bend_px`` of an undeformed gel. Measured on simulated gels:
            0.2 for strong optics and a print tolerance of 0.1 mm, 0.7 to 1.4 for one finger that
            pushes by 1 mm.
        max_displaced: largest ``Lattice.n_displaced`` of an undeformed gel.
    """

    min_pitch_px: float = 5.6
    max_pitch_px: float = 18.4
    min_share: float = 0.675
    max_aside: float = 2.5 / 30.0
    max_bend_px: float = 0.6
    max_displaced: int = 4


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
    """

    position_px: NDArray[np.float64]
    blob: NDArray[np.intp]
    bend_px: float
    print_px: float
    aside: float
    n_displaced: int

    @property
    def n_found(self) -> int:
        """The number of markers that were seen."""
        return int((self.blob >= 0).sum())

    @property
    def share(self) -> float:
        """The share of the markers that were seen."""
        return self.n_found / len(self.blob)


class LatticeFinder:
    """Finds the lattice of one gel.

    Args:
        gel: the gel.
        config: the ranges searched.
    """

    def __init__(self, gel: Gel = PAPER_GEL, config: LatticeConfig | None = None) -> None:
        self.gel, self.config = gel, config or LatticeConfig()
        # Each marker and its neighbours.
        self._around = np.column_stack([np.arange(gel.n_markers), gel.neighbours])
        self._sites = np.rint(gel.points_mm / gel.pitch_mm).astype(np.intp)
        self._reach = reach = int(gel.radius_mm // gel.pitch_mm)  # sites are -7..7
        self._disc = np.zeros((2 * reach + 1, 2 * reach + 1), dtype=np.bool_)
        self._disc[self._sites[:, 1] + reach, self._sites[:, 0] + reach] = True
        axis = np.arange(-2 * reach, 2 * reach + 1)
        self._grid = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
        self._grid_far = np.hypot(*self._grid.T)

    def find(
        self, centroid_px: NDArray[np.float64], rig: Rig | None = None, *, near_rad: float = 0.0
    ) -> Lattice | None:
        """Returns the lattice among blobs, or None if nothing looks like one.

        1. The most frequent vector between neighbours gives scale and rotation. A square lattice
           allows four rotations; the nearest to ``near_rad`` counts.
        2. The lattice grows from blob to blob, along a smooth map of those that it has.
        3. It is placed on the gel's sites so that most sites are taken.
        4. A smooth model (similarity, perspective, dome and lens to fifth order) decides which
           blobs belong to it.

        Args:
            centroid_px: (m, 2) float64 px.
            rig: where the gel is, if that is known.
            near_rad: the turn of the lattice that is expected.
        """
        gel, n = self.gel, self.gel.n_markers
        if len(centroid_px) < n // 4:
            return None
        if rig is None:
            basis = _find_basis(centroid_px, self.config)
            if basis is None:
                return None
            quarters = round((near_rad - cmath.phase(basis)) / (math.pi / 2.0))
            basis *= 1j**quarters
            sites = self._grow(centroid_px, basis)
            model = self._place(centroid_px, sites)
        else:
            model = rig.to_px(gel.points_mm)
            basis = cmath.rect(rig.px_per_mm * gel.pitch_mm, rig.rotation_rad)
        if model is None:
            return None
        blob = assign(model, centroid_px, 0.4 * abs(basis))
        for _ in range(3):
            if (blob >= 0).sum() < n // 3:
                return None
            model = fit_model(centroid_px, blob, gel)
            blob = assign(model, centroid_px, _GATE * abs(basis))
        found = blob >= 0
        if found.sum() < n // 3:
            return None
        position = model.copy()
        position[found] = centroid_px[blob[found]]
        off = np.where(found[:, None], position - model, 0.0)
        bend, own = self._average(off, found)
        tolerance = 1.4826 * float(np.median(np.abs(own[found])))
        bend2 = float((bend**2).sum(axis=1).max()) - (_PRINT_BEND * tolerance) ** 2
        free = np.setdiff1d(np.arange(len(centroid_px)), blob[found])
        displaced = assign(model[~found], centroid_px[free], abs(basis)) >= 0
        aside_mm = np.hypot(*(gel.points_mm[found].mean(axis=0) - gel.points_mm.mean(axis=0)))
        bend_px = math.sqrt(max(bend2, 0.0))
        aside = float(aside_mm) / gel.radius_mm
        return Lattice(position, blob, bend_px, tolerance, aside, int(displaced.sum()))

    def _average(
        self, off_px: NDArray[np.float64], found: NDArray[np.bool_]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns each marker's deviation averaged with its neighbours', and what that leaves over.

        Args:
            off_px: (n, 2) float64 px, deviations from the model, 0 for markers that are not seen.
            found: (n,) bool, markers that are seen.
        """
        use = (self._around >= 0) & found[self._around]
        total = np.where(use[:, :, None], off_px[self._around], 0.0).sum(axis=1)
        mean = total / np.maximum(use.sum(axis=1, keepdims=True), 4)  # few neighbours prove nothing
        return mean, off_px - mean

    def _grow(self, points: NDArray[np.float64], basis: complex) -> dict[tuple[int, int], int]:
        """Returns the blob of each lattice site, grown ring by ring from a blob in the middle.

        A smooth map of the sites that have their blobs tells where the next ring is, because the
        lattice may be bent, and single dots may be off their places, or missing.
        """
        z = points @ (1, 1j)
        best: dict[tuple[int, int], int] = {}
        seeds = np.argsort(np.abs(z - np.median(z.real) - 1j * np.median(z.imag)))[:12]
        for seed in seeds:
            if int(seed) in best.values():
                continue
            sites = self._grow_from(points, points[seed], basis)
            if len(sites) > len(best):
                best = sites
            if len(best) > self.gel.n_markers // 2:
                break
        return best

    def _grow_from(
        self, points: NDArray[np.float64], start_px: NDArray[np.float64], basis: complex
    ) -> dict[tuple[int, int], int]:
        """Returns the blob of each lattice site around a blob at ``start_px``."""
        step = np.array([[basis.real, basis.imag], [-basis.imag, basis.real]])
        model, n_before = start_px + self._grid @ step, 0
        blob = np.full(len(self._grid), -1, dtype=np.intp)
        for reach in range(1, 2 * self._reach + 1):
            near = np.flatnonzero(reach + 0.5 > self._grid_far)
            for _ in range(2):
                blob[:] = -1
                blob[near] = assign(model[near], points, _GATE * abs(basis))
                seen = np.flatnonzero(blob >= 0)
                if len(seen) < 4:
                    break
                order = 1 if len(seen) < 16 else 2 if len(seen) < 40 else 3
                model = _extend_map(self._grid / self._reach, seen, points[blob[seen]], order)
            if len(seen) == n_before or len(seen) < 4:  # the ring is empty: this is the rim
                break
            n_before = len(seen)
        found = np.flatnonzero(blob >= 0)
        return {(int(self._grid[k, 0]), int(self._grid[k, 1])): int(blob[k]) for k in found}

    def _place(
        self, points: NDArray[np.float64], sites: dict[tuple[int, int], int]
    ) -> NDArray[np.float64] | None:
        """Returns a first model, (n, 2) px: the grown lattice placed on the sites of the gel."""
        if len(sites) < self.gel.n_markers // 3:
            return None
        where = np.array(list(sites))
        blob = np.array(list(sites.values()))
        margin = 3 * self._reach
        grid = np.zeros((2 * margin + 1, 2 * margin + 1), dtype=np.bool_)
        grid[where[:, 1] + margin, where[:, 0] + margin] = True
        size = 2 * self._reach + 1
        centre = np.array((SENSOR_WIDTH_PX / 2, SENSOR_HEIGHT_PX / 2))
        best_score, best_model = (-1, -math.inf), None
        windows = np.lib.stride_tricks.sliding_window_view(grid, (size, size))
        hits = (windows & self._disc).sum(axis=(2, 3))
        for row, column in np.argwhere(hits >= hits.max()):
            shift = np.array((column, row)) + self._reach - margin
            inside = np.abs(where - shift).max(axis=1) <= self._reach
            inside[inside] = self._disc[tuple((where[inside] - shift + self._reach).T[::-1])]
            lookup = {
                tuple(site): b for site, b in zip(where[inside] - shift, blob[inside], strict=True)
            }
            assigned = np.array(
                [lookup.get((int(x), int(y)), -1) for x, y in self._sites], dtype=np.intp
            )
            model = fit_model(points, assigned, self.gel)
            score = (int(hits[row, column]), -float(np.hypot(*(model.mean(axis=0) - centre))))
            if score > best_score:
                best_score, best_model = score, model
        return best_model


def _find_basis(points: NDArray[np.float64], config: LatticeConfig) -> complex | None:
    """Returns the least rotated lattice vector, x + iy in px, by a vote of close pairs."""
    z = points @ (1, 1j)
    vectors = (z[:, None] - z[None, :]).ravel()
    length = np.abs(vectors)
    low, high = config.min_pitch_px, config.max_pitch_px
    near = (length > low) & (length < high)
    length, angle = length[near], np.angle(vectors[near] ** 4) / 4
    n_lengths, n_angles = max(round((high - low) / _CELL_PX), 8), 30
    vote, edges, _ = np.histogram2d(
        length, angle, (n_lengths, n_angles), ((low, high), (-math.pi / 4, math.pi / 4))
    )
    # Pairs that belong to no lattice are as frequent in each cell as their lengths allow.
    vote /= (edges[:-1, None] + edges[1:, None]) / 2.0
    for _ in range(_N_SMOOTH):
        vote = (np.roll(vote, 1, axis=1) + 2.0 * vote + np.roll(vote, -1, axis=1)) / 4.0
        wide = np.pad(vote, ((1, 1), (0, 0)), mode="edge")
        vote = (wide[:-2] + 2.0 * vote + wide[2:]) / 4.0
    best = vote.max()
    if not best > _LEAST_VOTE * vote.mean():  # also if no pair has such a length
        return None
    # The diagonal of a small lattice can be as frequent as its side, so the shortest wins.
    row = int(np.flatnonzero(vote.max(axis=1) > 0.7 * best)[0])
    row += int(np.argmax(vote[row : row + _N_PEAK].max(axis=1)))
    column = int(np.argmax(vote[row]))
    centre_length = (edges[row] + edges[row + 1]) / 2
    centre_angle = (column + 0.5) * math.pi / 2 / n_angles - math.pi / 4
    turn = np.angle(np.exp(4j * (angle - centre_angle))) / 4
    members = (np.abs(length - centre_length) < 1.0) & (np.abs(turn) < 0.12)
    rotation = centre_angle + float(np.median(turn[members]))
    return cmath.rect(float(np.median(length[members])), rotation)


def _extend_map(
    sites: NDArray[np.float64], seen: NDArray[np.intp], target: NDArray[np.float64], order: int
) -> NDArray[np.float64]:
    """Returns a polynomial map of all sites, (n, 2) px, fitted to those that are seen."""
    x, y = sites.T
    design = np.stack([x**a * y**b for a in range(order + 1) for b in range(order + 1 - a)], axis=1)
    solution = np.linalg.lstsq(design[seen], target, rcond=None)[0]
    model: NDArray[np.float64] = design @ solution
    return model


def fit_model(points: NDArray[np.float64], blob: NDArray[np.intp], gel: Gel) -> NDArray[np.float64]:
    """Returns a smooth map of the gel, (n, 2) px, fitted robustly to seen markers."""
    u = gel.points_mm / gel.radius_mm
    x, y = u[:, 0], u[:, 1]
    r2 = x * x + y * y
    design = np.stack(
        [np.ones_like(x), x, y, x * x, x * y, y * y, x * r2, y * r2, x * r2**2, y * r2**2], axis=1
    )
    use = np.flatnonzero(blob >= 0)
    target = points[blob[use]]
    model: NDArray[np.float64] = gel.points_mm
    for _ in range(3):
        solution = np.linalg.lstsq(design[use], target, rcond=None)[0]
        model = design @ solution
        error = np.hypot(*(target - model[use]).T)
        keep = error <= max(3.0 * float(np.median(error)), 0.5)
        if keep.all() or keep.sum() < gel.n_markers // 4:
            break
        use, target = use[keep], target[keep]
    return model


def assign(
    model: NDArray[np.float64], points: NDArray[np.float64], gate_px: float
) -> NDArray[np.intp]:
    """Returns the blob of each marker, nearest to the model within the gate; -1 without one."""
    if not len(model) or not len(points):
        return np.full(len(model), -1, dtype=np.intp)
    distance = np.hypot(*(model[:, None, :] - points[None, :, :]).transpose(2, 0, 1))
    blob = distance.argmin(axis=1)
    marker = distance.argmin(axis=0)
    rows = np.arange(len(model))
    good = (marker[blob] == rows) & (distance[rows, blob] < gate_px)
    return np.where(good, blob, -1).astype(np.intp)
