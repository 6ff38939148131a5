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

    The order of the sums is free, so that a processor adds several products at once.

    Args:
        columns: (m or more, 2, n) float64.
        target: (2, n) float64 mm, displacements.
        weight: (n,) float64, trust in each marker.
        normal: (m, m) float64, its lower half is written.
        right: (m, 1) float64, written.
    """
    m, n = len(normal), len(weight)
    x, y = np.empty(n), np.empty(n)
    for a in range(m):
        value = 0.0
        for i in range(n):
            x[i], y[i] = weight[i] * columns[a, 0, i], weight[i] * columns[a, 1, i]
            value += x[i] * target[0, i] + y[i] * target[1, i]
        right[a, 0] = value
        for b in range(a + 1):
            value = 0.0
            for i in range(n):
                value += x[i] * columns[b, 0, i] + y[i] * columns[b, 1, i]
            normal[a, b] = value


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
