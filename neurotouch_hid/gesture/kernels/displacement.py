"""The compiled loop from positions to displacements of markers."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel


@kernel
def displace(
    rest_px: NDArray[np.float32],
    position_px: NDArray[np.float32],
    valid: NDArray[np.bool_],
    moved_px: NDArray[np.float64],
    use: NDArray[np.bool_],
) -> int:
    """Writes how far each measured marker has moved since rest.

    Args:
        rest_px: (n, 2) float32 px, columns x, y.
        position_px: (n, 2) float32 px.
        valid: (n,) bool, measured markers.
        moved_px: (n, 2) float64 px, written; 0 for markers that cannot be used.
        use: (n,) bool, written: valid markers with a finite position.

    Returns:
        The number of markers that can be used.
    """
    n_used = 0
    for i in range(len(rest_px)):
        use[i] = valid[i] and np.isfinite(position_px[i, 0]) and np.isfinite(position_px[i, 1])
        n_used += use[i]
        for axis in range(2):
            moved = np.float64(position_px[i, axis]) - np.float64(rest_px[i, axis])
            moved_px[i, axis] = moved if use[i] else 0.0
    return n_used
