"""Compiled loops that measure how far the white pixels of two frames are apart."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

REFERENCE, NOW = 1, 2  # bits of the mask


@kernel
def ring_distance(index: int, mask: NDArray[np.uint8], bit: int, most_px2: int) -> int:
    """Returns the squared distance, px², of one pixel to the nearest one with a bit in ``mask``.

    Searches square rings of growing size around the pixel.

    Args:
        index: of the pixel.
        mask: (h, w) uint8.
        bit: ``REFERENCE`` or ``NOW``.
        most_px2: a larger distance, or none in an empty mask, counts as this one.
    """
    h, w = mask.shape
    y, x = index // w, index % w
    if mask[y, x] & bit:
        return 0
    best = most_px2
    k = 1
    while k * k < best and k < h + w:
        for j in range(-k, k + 1):
            d = k * k + j * j
            if d < best:
                left, right, top, bottom = x - k, x + k, y - k, y + k
                v, u = y + j, x + j
                beside = 0 <= v < h and (
                    (left >= 0 and mask[v, left] & bit) or (right < w and mask[v, right] & bit)
                )
                if beside or (
                    0 <= u < w
                    and (
                        (top >= 0 and mask[top, u] & bit) or (bottom < h and mask[bottom, u] & bit)
                    )
                ):
                    best = d
        k += 1
    return best


@kernel
def chamfer(
    now: NDArray[np.int32], reference: NDArray[np.int32], mask: NDArray[np.uint8], most_px2: int
) -> float:
    """Returns the sum of both mean squared distances of two sets of pixels, px² [NT, Eq. Chamfer].

    Args:
        now: (k,) int32, the pixels of a frame; infinite without any.
        reference: (l,) int32, the pixels of the reference.
        mask: (h, w) uint8, ``REFERENCE`` in these and 0 in all others; the same afterwards.
        most_px2: a larger distance of a single pixel counts as this one.
    """
    if not len(now):
        return np.inf
    flat = mask.ravel()
    forward, backward = 0, 0
    for index in now:
        if not flat[index]:
            forward += ring_distance(index, mask, REFERENCE, most_px2)
    for index in now:
        flat[index] |= NOW
    for index in reference:
        if flat[index] == REFERENCE:
            backward += ring_distance(index, mask, NOW, most_px2)
    for index in now:
        flat[index] &= REFERENCE
    return forward / len(now) + backward / len(reference)


@kernel
def gather_inside(
    centroid_px: NDArray[np.float64],
    begin: NDArray[np.int32],
    members: NDArray[np.int32],
    centre_px: tuple[float, float],
    radius_px: float,
    out: NDArray[np.int32],
) -> int:
    """Writes the pixels of all blobs with their centroid in a circle; returns their number."""
    n = 0
    for i in range(len(centroid_px)):
        dx, dy = centroid_px[i, 0] - centre_px[0], centroid_px[i, 1] - centre_px[1]
        if dx * dx + dy * dy < radius_px * radius_px:
            for k in range(begin[i], begin[i + 1]):
                out[n] = members[k]
                n += 1
    return n
