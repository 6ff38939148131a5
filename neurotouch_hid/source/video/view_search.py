"""Finds where a gel is in a sensor's pictures, and the view that shows it."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, cycle
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import NOMINAL_PX_PER_MM
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.view import MIDDLE_PX, View, ViewTable


class GelFinder(Protocol):
    """Finds a gel of known layout in canonical pictures; the tracker offers one.

    Attributes:
        points_mm: (n, 2) float64 mm, the gel's points.
    """

    points_mm: NDArray[np.float64]

    def find(self, pixels: NDArray[np.uint8]) -> NDArray[np.float64] | None:
        """Returns the dots of the gel in a picture, or None without a gel.

        Args:
            pixels: (260, 346) uint8, at 1.4 to 4.6 px/mm.

        Returns:
            (n, 2) float64 px, in the order of ``points_mm``; NaN for a dot that is not seen.
        """
        ...


_PARTS: Final = (0.62, 0.4, 0.25)
"""Sides of the parts of the picture that are searched, as a share of the whole. The finder sees a
gel that takes a third of a part's height, so a part's largest gel is the smallest of the one
before."""
_LARGEST: Final = 0.55
"""Share of a part's height that its largest gel takes: parts overlap so far."""
_SHARPEST: Final = 1.2
"""Canonical pixels per sensor pixel; smaller parts show no more."""
_PER_PICTURE: Final = 16
"""Parts that are searched in one picture, beside the whole."""
_N_FITS: Final = 2
"""The first fit may come from a small gel, whose dots are few pixels."""
_MAX_MISFIT: Final = 0.1
"""How far a second look may differ: share of the scale, and of the picture's height."""
_STRETCHES: Final = np.linspace(-0.5, 0.5, 41)
"""Lens terms that are tried, as the change of scale at the farthest dot."""


class ViewSearch:
    """Searches pictures of one size until the view of the gel is known.

    The whole picture is searched first, then smaller parts of it, some in each picture. What is
    found counts once the next picture shows the gel there, too.

    Args:
        finder: finds the gel in a canonical picture.
        whole: the table of the view of the whole picture.

    Attributes:
        table: makes canonical pictures; of the whole picture until the gel is found.
        is_found: the view of the gel is known, and will not change.
    """

    def __init__(self, finder: GelFinder, whole: ViewTable) -> None:
        self._finder, self._whole = finder, whole
        self._parts = _list_parts(whole.view)
        self.table = whole
        self.is_found = False

    def update(self, pixels: NDArray[np.uint8]) -> None:
        """Searches a picture, (h, w) uint8, while the view is not known."""
        if self.is_promising:
            self.is_found = self._shows_gel(self.table, pixels)
            if self.is_found:
                return
            self.table = self._whole
        for table in chain([self._whole], self._next_parts()):
            found = self._fit(table, pixels)
            if found is not None and self._shows_gel(found, pixels):
                self.table = found
                return

    @property
    def is_promising(self) -> bool:
        """True if the gel was found in the last picture, and the next one will confirm it."""
        return not self.is_found and self.table is not self._whole

    def _fit(self, table: ViewTable, pixels: NDArray[np.uint8]) -> ViewTable | None:
        """Returns the view of the gel, or None if this view shows none."""
        for _ in range(_N_FITS):
            dots_px = self._look(table, pixels)
            if dots_px is None:
                return None
            table = ViewTable(fit_view(table.view, dots_px, self._finder.points_mm))
        return table

    def _next_parts(self) -> Iterator[ViewTable]:
        for _ in range(_PER_PICTURE):
            part = next(self._parts, None)
            if part is None:
                return
            yield ViewTable(part)

    def _look(self, table: ViewTable, pixels: NDArray[np.uint8]) -> NDArray[np.float64] | None:
        canonical = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
        table.draw(pixels, canonical)
        return self._finder.find(canonical)

    def _shows_gel(self, table: ViewTable, pixels: NDArray[np.uint8]) -> bool:
        """Returns whether a view shows the gel in its middle, as large as it should be."""
        dots_px = self._look(table, pixels)
        if dots_px is None:
            return False
        known = np.isfinite(dots_px).all(axis=1)
        factor, centre = _fit_similarity(self._finder.points_mm[known], dots_px[known])
        is_centred = abs(centre - complex(*MIDDLE_PX)) < _MAX_MISFIT * SENSOR_HEIGHT_PX
        return is_centred and abs(abs(factor) / NOMINAL_PX_PER_MM - 1.0) < _MAX_MISFIT


def fit_view(view: View, dots_px: NDArray[np.float64], points_mm: NDArray[np.float64]) -> View:
    """Returns the view that brings a gel to the middle of the canonical picture at 2.5 px/mm.

    The turn stays. The lens term is the one with which the dots are most like the points.

    Args:
        view: the view in which the gel was found.
        dots_px: (n, 2) float64 canonical px, NaN for a dot that is not seen.
        points_mm: (n, 2) float64 mm, the gel's points in the same order.
    """
    known = np.isfinite(dots_px).all(axis=1)
    sensor_px = view.to_sensor(dots_px[known])
    points = points_mm[known] * (-1.0 if view.mirrored else 1.0, 1.0)

    def fit(stretch: float) -> tuple[View, float]:
        """Returns the view with a lens term, and how unlike dots and points are, in mm²."""
        bent = replace(view, lens=stretch / farthest)
        straight = bent.undistort(sensor_px)
        factor, centre = _fit_similarity(points, straight)
        left_mm = np.abs((straight @ (1, 1j) - centre) / factor - points @ (1, 1j))
        place = (centre.real, centre.imag)
        found = replace(bent, centre_px=place, scale=NOMINAL_PX_PER_MM / abs(factor))
        return found, float((left_mm**2).mean())

    farthest = float(view.measure_radii(sensor_px).max()) ** 2
    errors = [fit(stretch)[1] for stretch in _STRETCHES]
    best = int(np.clip(np.argmin(errors), 1, len(errors) - 2))
    before, least, after = errors[best - 1 : best + 2]  # the lowest point of their parabola
    step = 0.5 * (before - after) / (before - 2.0 * least + after)
    return fit(float(_STRETCHES[best] + np.clip(step, -1.0, 1.0) * np.diff(_STRETCHES)[0]))[0]


def _fit_similarity(
    points: NDArray[np.float64], target: NDArray[np.float64]
) -> tuple[complex, complex]:
    """Returns factor and place of the origin that bring points (n, 2) nearest to others (n, 2)."""
    source, there = points @ (1, 1j), target @ (1, 1j)
    ds, dt = source - source.mean(), there - there.mean()
    factor = np.vdot(ds, dt) / np.vdot(ds, ds).real
    return complex(factor), complex(there.mean() - factor * source.mean())


def _list_parts(whole: View) -> Iterator[View]:
    """Gives the views of ever smaller parts, for ever; none if the whole picture is as sharp."""
    views = []
    for part in _PARTS:
        scale = whole.scale / part
        if scale > _SHARPEST:
            break
        gel_px = _LARGEST * SENSOR_HEIGHT_PX / scale
        columns = _spread(whole.width_px, SENSOR_WIDTH_PX / scale, gel_px)
        rows = _spread(whole.height_px, SENSOR_HEIGHT_PX / scale, gel_px)
        views += [replace(whole, centre_px=(x, y), scale=scale) for y in rows for x in columns]
    return cycle(views)


def _spread(size: float, part: float, overlap: float) -> list[float]:
    """Returns the middles of overlapping parts that cover a side of a picture, px."""
    if part >= size:
        return [(size - 1.0) / 2.0]
    n = 1 + math.ceil((size - part) / (part - overlap))
    return [float(at) for at in np.linspace((part - 1.0) / 2.0, size - (part + 1.0) / 2.0, n)]
