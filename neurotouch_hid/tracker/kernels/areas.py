"""Compiled loop on how many pixels the blobs of a frame have."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel


@kernel
def find_usual_area(begin: NDArray[np.int32], n: int) -> float:
    """Returns the area of a marker's blob, px: the median of the n largest; 0 without a blob.

    Specks of noise are smaller. Areas are small whole numbers, so they are counted, not sorted.

    Args:
        begin: (m + 1,) int32, where the pixels of each blob begin.
        n: number of markers.
    """
    m = len(begin) - 1
    largest = 0
    for j in range(m):
        largest = max(largest, begin[j + 1] - begin[j])
    counts = np.zeros(largest + 1, np.int32)
    for j in range(m):
        counts[begin[j + 1] - begin[j]] += 1
    n = min(m, n)
    first, second = m - n + (n - 1) // 2, m - n + n // 2  # the middle one, or the two
    n_up_to, total = 0, 0
    for area in range(largest + 1):
        n_before, n_up_to = n_up_to, n_up_to + counts[area]
        total += area * ((n_before <= first < n_up_to) + (n_before <= second < n_up_to))
    return 0.5 * total
