"""Linear algebra of small systems: normal equations, their solution and an inverse."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]


@kernel(fastmath={"reassoc", "contract"})
def accumulate(
    columns: Floats, target: Floats, weight: Floats, normal: Floats, right: Floats
) -> None:
    """Writes the normal equations of the weighted least squares, lower half.

    The order of the sums is free, so that a processor adds several products at once. Two rows and
    two columns at once need half as many numbers from memory.

    Args:
        columns: (m or more, 2, n) float64.
        target: (2, n) float64 mm, displacements.
        weight: (n,) float64, trust in each marker.
        normal: (m, m) float64, its lower half is written; what is above has no meaning.
        right: (m, 1) float64, written.
    """
    m, n = len(normal), len(weight)
    flat, goal = columns.reshape(len(columns), 2 * n), target.reshape(2 * n)
    weighted = np.empty((2, 2 * n))
    for a in range(0, m, 2):
        next_a = min(a + 1, m - 1)  # the last of an odd number counts as both
        for row in range(2):
            column, own = flat[min(a + row, m - 1)], weighted[row]
            for i in range(n):
                own[i], own[n + i] = weight[i] * column[i], weight[i] * column[n + i]
        first, second = weighted[0], weighted[1]
        x = y = 0.0
        for i in range(2 * n):
            x += first[i] * goal[i]
            y += second[i] * goal[i]
        right[a, 0], right[next_a, 0] = x, y
        for b in range(0, a + 2, 2):
            next_b = min(b + 1, m - 1)
            left, other = flat[b], flat[next_b]
            xx = xy = yx = yy = 0.0
            for i in range(2 * n):
                xx += first[i] * left[i]
                xy += first[i] * other[i]
                yx += second[i] * left[i]
                yy += second[i] * other[i]
            normal[a, b], normal[a, next_b] = xx, xy
            normal[next_a, b], normal[next_a, next_b] = yx, yy


@kernel(inline="always")
def solve(matrix: Floats, vector: Floats) -> bool:
    """Solves the symmetric positive system in place (Cholesky); False if it is singular.

    Args:
        matrix: (n, n) float64; its lower half becomes the Cholesky factor.
        vector: (n, k) float64; becomes the solution.
    """
    n = len(matrix)
    for i in range(n):
        for j in range(i + 1):
            s = matrix[i, j]
            for k in range(j):
                s -= matrix[i, k] * matrix[j, k]
            if i == j:
                if s <= 0.0:
                    return False
                matrix[i, i] = math.sqrt(s)
            else:
                matrix[i, j] = s / matrix[j, j]
    for c in range(vector.shape[1]):
        for i in range(n):
            s = vector[i, c]
            for k in range(i):
                s -= matrix[i, k] * vector[k, c]
            vector[i, c] = s / matrix[i, i]
        for i in range(n - 1, -1, -1):
            s = vector[i, c]
            for k in range(i + 1, n):
                s -= matrix[k, i] * vector[k, c]
            vector[i, c] = s / matrix[i, i]
    return True


@kernel(inline="always")
def invert(matrix: Floats) -> None:
    """Inverts a general matrix (n, n) with dominant diagonal in place (Gauss-Jordan, pivoting)."""
    n = len(matrix)
    work = np.zeros((n, 2 * n))
    for i in range(n):
        work[i, n + i] = 1.0
        for j in range(n):
            work[i, j] = matrix[i, j]
    for i in range(n):
        best = i
        for j in range(i + 1, n):
            if abs(work[j, i]) > abs(work[best, i]):
                best = j
        if best != i:
            for k in range(2 * n):
                work[i, k], work[best, k] = work[best, k], work[i, k]
        pivot = work[i, i]
        if abs(pivot) < 1e-9:
            pivot = 1e-9
        for k in range(2 * n):
            work[i, k] /= pivot
        for j in range(n):
            if j != i:
                factor = work[j, i]
                if factor != 0.0:
                    for k in range(2 * n):
                        work[j, k] -= factor * work[i, k]
    for i in range(n):
        for j in range(n):
            matrix[i, j] = work[i, n + j]
