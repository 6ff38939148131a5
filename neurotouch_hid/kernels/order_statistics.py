"""Compiled loops that find a median, or another value by its rank, without sorting."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

_ALL_BUT_SIGN = np.int64(0x7FFFFFFFFFFFFFFF)


@kernel
def _make_keys(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Returns integers in the same order as the values, both (n,)."""
    bits, keys = values.view(np.int64), np.empty(len(values), np.int64)
    for i in range(len(values)):  # those of a negative value fall while it rises
        keys[i] = bits[i] ^ ((bits[i] >> 63) & _ALL_BUT_SIGN)
    return keys


@kernel
def _find_value(key: int) -> float:
    """Returns the value of a key."""
    bits = np.array([key ^ ((key >> 63) & _ALL_BUT_SIGN)])
    return float(bits.view(np.float64)[0])


@kernel
def _select_key(keys: NDArray[np.int64], k: int) -> int:
    """Returns the key with index ``k`` of the sorted keys, (n,) int64.

    A binary search: it has no branches that a processor would mispredict, as sorting has. After
    each round, both limits move on to the next key that occurs, so it takes ten rounds instead of
    sixty.
    """
    low, high = keys.min(), keys.max()
    while low < high:
        middle = (low & high) + ((low ^ high) >> 1)  # their sum may be too large
        n, below, above = 0, low, high
        for i in range(len(keys)):  # eight at once
            is_below = keys[i] <= middle
            n += is_below
            below = max(below, keys[i] if is_below else low)
            above = min(above, high if is_below else keys[i])
        if n > k:
            high = below
        else:
            low = above
    return int(low)


@kernel
def select(values: NDArray[np.float64], k: int) -> float:
    """Returns the value with index ``k`` of the sorted values, (n,) float64."""
    return float(_find_value(_select_key(_make_keys(values), k)))


@kernel
def median(values: NDArray[np.float64]) -> float:
    """Returns the median of values, (n,) float64, at least one."""
    keys, n = _make_keys(values), len(values)
    first = float(_find_value(_select_key(keys, (n - 1) // 2)))
    return first if n & 1 else 0.5 * (first + float(_find_value(_select_key(keys, n // 2))))
