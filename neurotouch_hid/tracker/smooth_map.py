"""Smooth maps from the gel to the picture, and the dots that belong to them."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel

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
        keep = error <= max(3.0 * float(np.median(error)), 0.5)
        if keep.all() or keep.sum() < gel.n_markers // 4:
            break
        use, target = use[keep], target[keep]
    return model


def extend_map(
    sites: NDArray[np.float64], seen: NDArray[np.intp], target: NDArray[np.float64], order: int
) -> NDArray[np.float64]:
    """Returns a polynomial map of all sites, (n, 2) px, fitted to those that are seen."""
    x, y = sites.T
    design = np.stack([x**a * y**b for a in range(order + 1) for b in range(order + 1 - a)], axis=1)
    solution = np.linalg.lstsq(design[seen], target, rcond=None)[0]
    model: NDArray[np.float64] = design @ solution
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
