"""Finds where a gel is in a sensor's pictures, and the view that shows it."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, cycle
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import NOMINAL_PITCH_PX, Gel
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.view import MIDDLE_PX, View, ViewTable


class GelFinder(Protocol):
    """Finds a gel of known layout in canonical pictures; the tracker offers one.

    Attributes:
        gel: the gel.
    """

    gel: Gel

    def find(
        self, pixels: NDArray[np.uint8], *, is_still: bool = False
    ) -> NDArray[np.float64] | None:
        """Returns the dots of the gel in a picture, or None without a gel.

        Args:
            pixels: (260, 346) uint8; the dots are at least 5.6 px apart.
            is_still: only a gel that nothing deforms counts.

        Returns:
            (n, 2) float64 px, in the order of ``gel.points_mm``; NaN for a dot that is not seen.
        """
        ...


_PARTS: Final = (0.62, 0.4, 0.25)
"""Sides of the parts of the picture that are searched, as a share of the whole. The finder sees a
gel that takes a third of a part's height, so a part's largest gel is the smallest of the one
before."""
_FAR: Final = 2.5
"""How much smaller the whole picture is shown, too: the dots of a gel that has few are too far
apart in it."""
_LARGEST: Final = 0.55
"""Share of a part's height that its largest gel takes: parts overlap so far."""
_SHARPEST: Final = 1.2
"""Canonical pixels per sensor pixel; smaller parts show no more."""
_N_EAGER: Final = 10
"""Pictures at the start that are searched in more parts: a gel is usually there."""
_PER_PICTURE: Final = (4, 16)
"""Parts that are searched in one picture beside the whole, usually and at the start."""
_N_UNSEEN: Final = 5
"""Looks without the gel, one after the other, before it is searched elsewhere."""
_N_PATIENT: Final = 30
"""Pictures at the start in which the view is fitted only to a gel that nothing deforms: a push
looks like a lens. Later any gel counts, as one may be made so unevenly that it always looks
deformed."""
_N_FITS: Final = 2
"""The first fit may come from a small gel, whose dots are few pixels."""
_MAX_MISFIT: Final = 0.1
"""How far a second look may differ: share of the scale, and of the picture's height."""
_WIDEST: Final = 0.94
"""Share of the picture's height that a gel may take."""
_STRETCHES: Final = np.linspace(-0.5, 0.5, 41)
"""Lens terms that are tried, as the change of scale at the farthest dot."""


class ViewSearch:
    """Searches pictures of one size until the view of the gel is known.

    The whole picture is searched first, at two sizes, then smaller parts of it, some in each
    picture. What is found counts once the next picture shows the gel there, too. Later the view
    changes only if the gel has left it and is found elsewhere.

    Args:
        finder: finds the gel in a canonical picture.
        whole: the table of the view of the whole picture.

    Attributes:
        table: makes canonical pictures; of the whole picture until the gel is found.
        is_found: the view of the gel is known.
    """

    def __init__(self, finder: GelFinder, whole: ViewTable) -> None:
        self._finder, self._whole = finder, whole
        self._far = ViewTable(replace(whole.view, scale=whole.view.scale / _FAR))
        self._parts = _list_parts(whole.view)
        self._candidate: ViewTable | None = None
        self._n_searched = self._n_unseen = 0
        self.table = whole
        self.is_found = False

    @property
    def is_promising(self) -> bool:
        """True if the gel was found in the last picture, and the next one will confirm it."""
        return self._candidate is not None

    @property
    def is_eager(self) -> bool:
        """True at the start: more pictures are searched, and in more parts."""
        return self._n_searched <= _N_EAGER

    def update(self, pixels: NDArray[np.uint8]) -> None:
        """Searches a picture, (h, w) uint8, or looks whether the gel is still in its view."""
        candidate, self._candidate = self._candidate, None
        if candidate is not None:
            if self._shows_gel(candidate, pixels):
                self.table, self.is_found = candidate, True
                return
            self.table = self.table if self.is_found else self._whole
        if not self.is_found or self._has_left(pixels):
            self._search(pixels)

    def _has_left(self, pixels: NDArray[np.uint8]) -> bool:
        """Returns True if the gel has not been seen in its view for some pictures.

        A hand may hide it, or bend it so that it is not recognised.
        """
        is_seen = self._look(self.table, pixels) is not None
        self._n_unseen = 0 if is_seen else (self._n_unseen + 1) % _N_UNSEEN
        return not is_seen and not self._n_unseen

    def _search(self, pixels: NDArray[np.uint8]) -> None:
        self._n_searched += 1
        for table in chain([self._whole, self._far], self._next_parts()):
            found = self._fit(table, pixels)
            if found is None or not self._shows_gel(found, pixels):
                continue
            if not self.is_found:
                self.table = self._candidate = found
            elif not _is_same(found.view, self.table.view):
                self._candidate = found
            return

    def _fit(self, table: ViewTable, pixels: NDArray[np.uint8]) -> ViewTable | None:
        """Returns the view of the gel, or None if this view shows none."""
        for _ in range(_N_FITS):
            dots_px = self._look(table, pixels, is_still=self._n_searched <= _N_PATIENT)
            if dots_px is None:
                return None
            table = ViewTable(fit_view(table.view, dots_px, self._finder.gel))
        return table

    def _next_parts(self) -> Iterator[ViewTable]:
        for _ in range(_PER_PICTURE[self.is_eager]):
            part = next(self._parts, None)
            if part is None:
                return
            yield ViewTable(part)

    def _look(
        self, table: ViewTable, pixels: NDArray[np.uint8], *, is_still: bool = False
    ) -> NDArray[np.float64] | None:
        canonical = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
        table.draw(pixels, canonical)
        return self._finder.find(canonical, is_still=is_still)

    def _shows_gel(self, table: ViewTable, pixels: NDArray[np.uint8]) -> bool:
        """Returns whether a view shows the gel in its middle, as large as it should be."""
        dots_px = self._look(table, pixels)
        if dots_px is None:
            return False
        known = np.isfinite(dots_px).all(axis=1)
        factor, centre = _fit_similarity(self._finder.gel.points_mm[known], dots_px[known])
        is_centred = abs(centre - complex(*MIDDLE_PX)) < _MAX_MISFIT * SENSOR_HEIGHT_PX
        return is_centred and abs(abs(factor) / find_scale(self._finder.gel) - 1.0) < _MAX_MISFIT


def _is_same(view: View, other: View) -> bool:
    """Returns whether two views of a gel differ by no more than a hand on it can explain."""
    apart = np.hypot(*np.subtract(view.centre_px, other.centre_px)) * other.scale
    is_near = apart < _MAX_MISFIT * SENSOR_HEIGHT_PX
    return bool(is_near) and abs(view.scale / other.scale - 1.0) < 2.0 * _MAX_MISFIT


def find_scale(gel: Gel) -> float:
    """Returns the scale at which a gel is shown, px/mm: 2.5 for dots that are 4 mm apart."""
    return min(NOMINAL_PITCH_PX / gel.pitch_mm, _WIDEST * SENSOR_HEIGHT_PX / (2.0 * gel.radius_mm))


def fit_view(view: View, dots_px: NDArray[np.float64], gel: Gel) -> View:
    """Returns the view that brings a gel to the middle of the canonical picture.

    The turn stays. The lens term is the one with which the dots are most like the points.

    Args:
        view: the view in which the gel was found.
        dots_px: (n, 2) float64 canonical px, NaN for a dot that is not seen.
        gel: the gel, with its points in the same order.
    """
    known = np.isfinite(dots_px).all(axis=1)
    sensor_px = view.to_sensor(dots_px[known])
    points = gel.points_mm[known] * (-1.0 if view.mirrored else 1.0, 1.0)

    def fit(stretch: float) -> tuple[View, float]:
        """Returns the view with a lens term, and how unlike dots and points are, in mm²."""
        bent = replace(view, lens=stretch / farthest)
        straight = bent.undistort(sensor_px)
        factor, centre = _fit_similarity(points, straight)
        left_mm = np.abs((straight @ (1, 1j) - centre) / factor - points @ (1, 1j))
        place = (centre.real, centre.imag)
        found = replace(bent, centre_px=place, scale=find_scale(gel) / abs(factor))
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
