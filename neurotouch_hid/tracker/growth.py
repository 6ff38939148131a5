"""Finds a gel whose markers form a lattice: grows the lattice from dot to dot."""

import cmath
import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, find_median
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.smooth_map import GATE, SiteMap, assign, fit_model

Floats = NDArray[np.float64]

_CELL_PX, _N_SMOOTH, _N_PEAK = 0.25, 3, 6  # of the vote for the lattice's side
_N_ANGLES: Final = 120  # cells of a whole turn in that vote
_LEAST_VOTE = 2.5  # times the mean vote; dots without any lattice reach less
_EXACT: Final = 1e-6  # of the pitch; larger deviations are no rounding
_SHARE: Final = 0.5  # of its sites that a lattice has around its middle


@dataclass(frozen=True, slots=True, eq=False)
class Net:
    """A lattice that all markers of a gel are on.

    Attributes:
        first_mm, second_mm: its two vectors, x + iy; the first is the shortest.
        sites: (n, 2) intp, the place of each marker, in these vectors.
        n_turns: turns of the lattice onto itself: 2, 4 or 6.
    """

    first_mm: complex
    second_mm: complex
    sites: NDArray[np.intp]
    n_turns: int


def find_net(gel: Gel) -> Net | None:
    """Returns the lattice that all markers of a gel are on; None if there is none."""
    z = gel.points_mm @ (1, 1j)
    middle = z[np.abs(z - z.mean()).argmin()]
    steps = np.delete(z, np.flatnonzero(z == middle)) - middle
    nearest = steps[np.abs(steps) < (1.0 + _EXACT) * np.abs(steps).min()]
    first = complex(nearest[np.abs(np.angle(nearest)).argmin()])
    across = steps[(steps / first).imag > _EXACT]
    if not len(across):
        return None
    ratio = across / first
    # Of equally near vectors the one at a right angle, else the one at the sharpest.
    order = np.lexsort((np.abs(np.angle(ratio)), np.round(np.abs(ratio), 6)))
    second = complex(across[order[0]])
    inverse = np.linalg.inv([[first.real, first.imag], [second.real, second.imag]])
    places = (gel.points_mm - (middle.real, middle.imag)) @ inverse
    sites = np.rint(places).astype(np.intp)
    if np.abs(places - sites).max() > _EXACT:
        return None
    width, height = np.ptp(sites, axis=0) + 1
    if gel.n_markers < _SHARE * width * height:
        return None
    return Net(first, second, sites, _count_turns(second / first))


def _count_turns(ratio: complex) -> int:
    if abs(ratio - 1j) < _EXACT:
        return 4
    return 6 if abs(ratio - cmath.rect(1.0, math.pi / 3.0)) < _EXACT else 2


class Growth:
    """Finds a gel on a lattice.

    Args:
        gel: the gel.
        net: its lattice.
        n_turns: turns of the gel onto itself.
        low_px, high_px: range of pitches searched.
    """

    def __init__(self, gel: Gel, net: Net, n_turns: int, low_px: float, high_px: float) -> None:
        self._gel, self._net, self._range_px = gel, net, (low_px, high_px)
        self._n_ways = max(net.n_turns // n_turns, 1)
        self._reach = reach = int(np.abs(net.sites).max())
        self._mask = np.zeros((2 * reach + 1, 2 * reach + 1), dtype=np.bool_)
        self._mask[net.sites[:, 1] + reach, net.sites[:, 0] + reach] = True
        axis = np.arange(-2 * reach, 2 * reach + 1)
        self._grid = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
        self._map = SiteMap(self._grid / reach, (1, 2, 3))
        self._grid_far = np.abs(self._grid @ (net.first_mm, net.second_mm)) / abs(net.first_mm)

    def search(self, points: Floats, near_rad: float) -> tuple[Floats, float] | None:
        """Returns a first model of the markers, (n, 2) px, and the pitch in px; None without one.

        1. The most frequent vector between neighbours gives scale and rotation. The lattice looks
           the same after some turns. Of those that the whole gel allows too, the nearest to
           ``near_rad`` counts.
        2. The lattice grows from blob to blob, along a smooth map of those that it has.
        3. It is placed on the gel's sites so that most sites are taken.

        Args:
            points: (m, 2) float64 px, the blobs.
            near_rad: the turn of the gel that is expected.
        """
        basis = _find_basis(points, self._net.n_turns, *self._range_px)
        if basis is None:
            return None
        first_rad, n = cmath.phase(self._net.first_mm), self._net.n_turns
        off = (near_rad + first_rad - cmath.phase(basis)) / (2.0 * math.pi / n)
        best: tuple[tuple[int, float], Floats] | None = None
        for way in range(self._n_ways):
            turns = way + self._n_ways * round((off - way) / self._n_ways)
            turned = basis * _turn(turns, n)
            found = self._place(points, self._grow(points, turned))
            if found is not None and (best is None or found[0] > best[0]):
                best = found
        return None if best is None else (best[1], abs(basis))

    def _grow(self, points: Floats, basis: complex) -> dict[tuple[int, int], int]:
        """Returns the blob of each lattice site, grown ring by ring from a blob in the middle.

        A smooth map of the sites that have their blobs tells where the next ring is, because the
        lattice may be bent, and single dots may be off their places, or missing.
        """
        z = points @ (1, 1j)
        best: dict[tuple[int, int], int] = {}
        seeds = np.argsort(np.abs(z - find_median(z.real) - 1j * find_median(z.imag)))[:12]
        for seed in seeds:
            if int(seed) in best.values():
                continue
            sites = self._grow_from(points, points[seed], basis)
            if len(sites) > len(best):
                best = sites
            if len(best) > self._gel.n_markers // 2:
                break
        return best

    def _grow_from(
        self, points: Floats, start_px: Floats, basis: complex
    ) -> dict[tuple[int, int], int]:
        """Returns the blob of each lattice site around a blob at ``start_px``."""
        second = basis * (self._net.second_mm / self._net.first_mm)
        step = np.array([[basis.real, basis.imag], [second.real, second.imag]])
        model, n_before = start_px + self._grid @ step, 0
        blob = np.full(len(self._grid), -1, dtype=np.intp)
        for reach in range(1, 2 * self._reach + 1):
            near = np.flatnonzero(reach + 0.5 > self._grid_far)
            for _ in range(2):
                blob[:] = -1
                blob[near] = assign(model[near], points, GATE * abs(basis))
                seen = np.flatnonzero(blob >= 0)
                if len(seen) < 4:
                    break
                order = 1 if len(seen) < 16 else 2 if len(seen) < 40 else 3
                model = self._map.fit(seen, points[blob[seen]], order)
            if len(seen) == n_before or len(seen) < 4:  # the ring is empty: this is the rim
                break
            n_before = len(seen)
        found = np.flatnonzero(blob >= 0)
        return {(int(self._grid[k, 0]), int(self._grid[k, 1])): int(blob[k]) for k in found}

    def _place(
        self, points: Floats, sites: dict[tuple[int, int], int]
    ) -> tuple[tuple[int, float], Floats] | None:
        """Returns the grown lattice placed on the sites of the gel, (n, 2) px, with its score."""
        if len(sites) < self._gel.n_markers // 3:
            return None
        where = np.array(list(sites))
        blob = np.array(list(sites.values()))
        margin = 3 * self._reach
        grid = np.zeros((2 * margin + 1, 2 * margin + 1), dtype=np.bool_)
        grid[where[:, 1] + margin, where[:, 0] + margin] = True
        size = 2 * self._reach + 1
        centre = np.array((SENSOR_WIDTH_PX / 2, SENSOR_HEIGHT_PX / 2))
        best: tuple[tuple[int, float], Floats] | None = None
        windows = np.lib.stride_tricks.sliding_window_view(grid, (size, size))
        hits = (windows & self._mask).sum(axis=(2, 3))
        for row, column in np.argwhere(hits >= hits.max()):
            shift = np.array((column, row)) + self._reach - margin
            inside = np.abs(where - shift).max(axis=1) <= self._reach
            inside[inside] = self._mask[tuple((where[inside] - shift + self._reach).T[::-1])]
            lookup = {
                tuple(site): b for site, b in zip(where[inside] - shift, blob[inside], strict=True)
            }
            assigned = np.array(
                [lookup.get((int(x), int(y)), -1) for x, y in self._net.sites], dtype=np.intp
            )
            model = fit_model(points, assigned, self._gel)
            score = (int(hits[row, column]), -float(np.hypot(*(model.mean(axis=0) - centre))))
            if best is None or score > best[0]:
                best = score, model
        return best


def _turn(turns: int, n: int) -> complex:
    """Returns the factor of some n-th parts of a whole turn, without rounding for quarters."""
    return 1j**turns if n == 4 else cmath.rect(1.0, 2.0 * math.pi * turns / n)


def _find_basis(points: Floats, n_turns: int, low: float, high: float) -> complex | None:
    """Returns the least rotated lattice vector, x + iy in px, by a vote of close pairs."""
    z = points @ (1, 1j)
    vectors = (z[:, None] - z[None, :]).ravel()
    length = np.abs(vectors)
    near = (length > low) & (length < high)
    length, angle = length[near], np.angle(vectors[near] ** n_turns) / n_turns
    n_lengths, n_angles = max(round((high - low) / _CELL_PX), 8), _N_ANGLES // n_turns
    most_rad = math.pi / n_turns
    vote, edges, _ = np.histogram2d(
        length, angle, (n_lengths, n_angles), ((low, high), (-most_rad, most_rad))
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
    centre_angle = (column + 0.5) * 2.0 * math.pi / n_turns / n_angles - most_rad
    turn = np.angle(np.exp(1j * n_turns * (angle - centre_angle))) / n_turns
    members = (np.abs(length - centre_length) < 1.0) & (np.abs(turn) < 0.12)
    rotation = centre_angle + float(find_median(turn[members]))
    return cmath.rect(float(find_median(length[members])), rotation)
