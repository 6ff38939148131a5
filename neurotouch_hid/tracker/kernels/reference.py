"""Compiled loops that compare the blobs of a frame with the gel at rest."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.tracker.kernels.chamfer import chamfer, gather_inside
from neurotouch_hid.tracker.kernels.matching import measure_largest


@kernel
def compare(
    place_px: NDArray[np.float64],
    centre_px: NDArray[np.float64],
    radius_px: float,
    white: NDArray[np.int32],
    mask: NDArray[np.uint8],
    scratch: NDArray[np.int32],
    centroid_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    members: NDArray[np.int32],
    gate_px: float,
    n_left_out: int,
    limit_px: float,
    least_found: float,
    most_px2: int,
    match: NDArray[np.int32],
) -> tuple[int, float, float]:
    """Returns how far markers and white pixels are from those of the gel at rest.

    Args:
        place_px: (n, 2) float64 px, the markers at rest.
        centre_px: (2,) float64 px, their middle.
        radius_px: blobs farther from it are not on the gel.
        white: (l,) int32, the white pixels of the gel at rest.
        mask: (h, w) uint8, see ``chamfer``.
        scratch: (h * w,) int32, written.
        centroid_px: (m, 2) float64 px, of the blobs.
        begin: (m + 1,) int32: the pixels of blob i are ``members[begin[i]:begin[i + 1]]``.
        members: int32, indices of pixels.
        gate_px: distance limit of a marker and its blob.
        n_left_out: the number of markers that may be elsewhere.
        limit_px: if markers are farther off, white pixels are not compared.
        least_found: nor are they if fewer markers are seen.
        most_px2: a larger distance of a single white pixel counts as this one.
        match: (n,) int32, written: the blob of each marker, see ``match_points``.

    Returns:
        The number of markers near their places; the largest distance of all but a few of them, px;
        the Chamfer distance, px², NaN if it was not measured.
    """
    n_found, off_px = measure_largest(place_px, centroid_px, gate_px, n_left_out, match)
    if off_px > limit_px or n_found < least_found:
        return n_found, off_px, np.nan
    circle = centre_px[0], centre_px[1]
    n = gather_inside(centroid_px, begin, members, circle, radius_px, scratch)
    return n_found, off_px, chamfer(scratch[:n], white, mask, most_px2)


@kernel
def write_seen(
    place_px: NDArray[np.float64],
    centroid_px: NDArray[np.float64],
    match: NDArray[np.int32],
    out_px: NDArray[np.float32],
) -> None:
    """Writes each marker's blob, (n, 2) float32 px, or its place at rest if there is none."""
    for i in range(len(place_px)):
        j = match[i]
        for axis in range(2):
            out_px[i, axis] = centroid_px[j, axis] if j >= 0 else place_px[i, axis]
