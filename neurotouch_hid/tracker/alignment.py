"""Finds a gel whose markers form no lattice: tries where its middle fits the dots, and grows it."""

import cmath
import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, measure_pitch
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.smooth_map import GATE, SiteMap, assign

Floats = NDArray[np.float64]

_INNER: Final = 0.55  # of the radius; a lens and a dome hardly bend this part
_LEAST_INNER: Final = 24
_NEAR: Final = 0.35  # of the pitch, from a marker of the inner part to its dot
_N_ANCHORS: Final = 3  # markers in the middle; two of them may be missing
_N_STARTS: Final = 48  # dots in the middle, one of which is an anchor
_SCALES: Final = (0.92, 1.0, 1.08)
_N_BEST: Final = 6  # places that are grown; neighbours of the best one are among them


class Alignment:
    """Finds a gel with any layout.

    Args:
        gel: the gel.
        n_turns: turns of the gel onto itself.
        low_px, high_px: range of pitches searched.
    """

    def __init__(self, gel: Gel, n_turns: int, low_px: float, high_px: float) -> None:
        self._gel, self._n_turns, self._range_px = gel, n_turns, (low_px, high_px)
        self._near_mm = measure_pitch(gel.points_mm)
        self._places = gel.points_mm - gel.points_mm.mean(axis=0)
        self._map = SiteMap(self._places / gel.radius_mm, (1, 2, 3))
        self._far = np.hypot(*self._places.T)
        order = np.argsort(self._far, kind="stable")
        n_inner = max(int((self._far <= _INNER * gel.radius_mm).sum()), _LEAST_INNER)
        self._inner, self._anchors = order[:n_inner], order[:_N_ANCHORS]
        self._reach_mm = float(self._far[self._inner].max())

    def search(self, points: Floats, near_rad: float) -> tuple[Floats, float] | None:
        """Returns a first model of the markers, (n, 2) px, and the pitch in px; None without one.

        1. The median distance of neighbours gives the scale.
        2. A dot in the middle is taken for a marker in the middle, at each turn; the places where
           most markers of the inner part have a dot count.
        3. From each of the best the gel grows outwards, along a smooth map of the markers that
           have their dots. The one with most of them is the gel.

        Args:
            points: (m, 2) float64 px, the blobs.
            near_rad: the turn of the gel that is expected.
        """
        middle = np.median(points, axis=0)
        starts = np.argsort(np.hypot(*(points - middle).T))[:_N_STARTS]
        scale = measure_pitch(points[starts]) / self._near_mm
        pitch_px = scale * self._gel.pitch_mm
        low_px, high_px = self._range_px
        if not low_px < pitch_px < high_px:
            return None
        best_score, best = (len(self._far) // 3, -math.inf), None
        for model in self._try_places(points, points[starts], scale, near_rad):
            grown, n_seen, off_px = self._grow(points, model, pitch_px)
            if (n_seen, -off_px) > best_score:
                best_score, best = (n_seen, -off_px), (grown, pitch_px)
        return best

    def _try_places(
        self, points: Floats, starts: Floats, scale: float, near_rad: float
    ) -> list[Floats]:
        """Returns the models of the best places, (n, 2) px each."""
        pitch_px = scale * self._gel.pitch_mm
        is_near = _mark_near(points, _NEAR * pitch_px)
        inner, anchors = self._places[self._inner] @ (1, 1j), self._places[self._anchors] @ (1, 1j)
        begin = starts @ (1, 1j)
        n = math.ceil(math.pi / self._n_turns / (0.5 * _NEAR * self._gel.pitch_mm / self._reach_mm))
        found: list[tuple[int, complex, complex]] = []
        for share in _SCALES:
            for k in range(-n, n):
                factor = cmath.rect(share * scale, near_rad + k * math.pi / self._n_turns / n)
                centre = (begin[:, None] - factor * anchors).ravel()
                z = centre[:, None] + factor * inner
                hits = is_near[_find_pixels(z)].sum(axis=1)
                found += [
                    (int(hits[i]), complex(centre[i]), factor)
                    for i in np.argsort(-hits, kind="stable")[:_N_BEST]
                ]
        found.sort(key=lambda each: -each[0])
        every = self._places @ (1, 1j)
        models: list[Floats] = []
        kept: list[complex] = []
        for _, centre, factor in found:
            rim = centre + factor * self._reach_mm
            if all(abs(rim - other) > 0.5 * pitch_px for other in kept):
                kept.append(rim)
                z = centre + factor * every
                models.append(np.column_stack([z.real, z.imag]))
            if len(models) == _N_BEST:
                break
        return models

    def _grow(self, points: Floats, model: Floats, pitch_px: float) -> tuple[Floats, int, float]:
        """Returns a model that has grown outwards, its number of dots, and how far they are off."""
        last_mm = float(self._far.max()) + self._gel.pitch_mm
        seen: NDArray[np.intp] = np.empty(0, np.intp)
        off_px = math.inf
        for reach_mm in np.arange(self._reach_mm, last_mm, self._gel.pitch_mm):
            near = np.flatnonzero(self._far <= reach_mm + 1e-9)
            for _ in range(2):
                blob = assign(model[near], points, GATE * pitch_px)
                seen, target = near[blob >= 0], points[blob[blob >= 0]]
                if len(seen) < _LEAST_INNER // 2:
                    return model, 0, math.inf
                order = 1 if len(seen) < 16 else 2 if len(seen) < 40 else 3
                model = self._map.fit(seen, target, order)
                off_px = float(np.median(np.hypot(*(model[seen] - target).T)))
        return model, len(seen), off_px


def _mark_near(points: Floats, reach_px: float) -> NDArray[np.bool_]:
    """Returns which pixels are near a dot, row by row, and False for all that are outside."""
    y, x = np.mgrid[:SENSOR_HEIGHT_PX, :SENSOR_WIDTH_PX]
    near = np.zeros((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.bool_)
    reach = math.ceil(reach_px)
    for px, py in points:
        left, top = max(round(px) - reach, 0), max(round(py) - reach, 0)
        part = np.s_[top : round(py) + reach + 1, left : round(px) + reach + 1]
        near[part] |= np.hypot(x[part] - px, y[part] - py) <= reach_px
    return np.append(near.ravel(), False)


def _find_pixels(z: NDArray[np.complex128]) -> NDArray[np.intp]:
    """Returns the pixel of each point x + iy, the last one for those that are outside."""
    x, y = np.rint(z.real).astype(np.intp), np.rint(z.imag).astype(np.intp)
    inside = (x >= 0) & (x < SENSOR_WIDTH_PX) & (y >= 0) & (y < SENSOR_HEIGHT_PX)
    return np.where(inside, y * SENSOR_WIDTH_PX + x, SENSOR_WIDTH_PX * SENSOR_HEIGHT_PX)
