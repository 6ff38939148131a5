"""Smooth maps from the gel to the picture, and the dots that belong to them."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, find_median
from neurotouch_hid.tracker.kernels.matching import pair_nearest

GATE = 0.42  # of the pitch: a dot farther from its site may belong to the next one


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
        keep = error <= max(3.0 * float(find_median(error)), 0.5)
        if keep.all() or keep.sum() < gel.n_markers // 4:
            break
        use, target = use[keep], target[keep]
    return model


class SiteMap:
    """Maps sites to the picture by a polynomial that fits those that are seen.

    Args:
        sites: (n, 2), the sites.
        orders: of the polynomials that ``fit`` may take.
    """

    def __init__(self, sites: NDArray[np.float64], orders: Iterable[int]) -> None:
        x, y = sites.T
        self._terms = {
            order: np.stack(
                [x**a * y**b for a in range(order + 1) for b in range(order + 1 - a)], axis=1
            )
            for order in orders
        }

    def fit(
        self, seen: NDArray[np.intp], target: NDArray[np.float64], order: int
    ) -> NDArray[np.float64]:
        """Returns all sites in the picture, (n, 2) px.

        Args:
            seen: (k,) the sites that are seen.
            target: (k, 2) px, where.
            order: of the polynomial.
        """
        terms = self._terms[order]
        solution = np.linalg.lstsq(terms[seen], target, rcond=None)[0]
        model: NDArray[np.float64] = terms @ solution
        return model


def assign(
    model: NDArray[np.float64], points: NDArray[np.float64], gate_px: float
) -> NDArray[np.intp]:
    """Returns the blob of each marker, nearest to the model within the gate; -1 without one.

    Args:
        model: (n, 2) px, where the markers should be.
        points: (m, 2) px, the blobs.
        gate_px: a blob that is farther belongs to no marker.

    Returns:
        (n,) intp.
    """
    blob = np.empty(len(model), np.intp)
    pair_nearest(np.ascontiguousarray(model), np.ascontiguousarray(points), gate_px, blob)
    return blob
