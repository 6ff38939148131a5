"""A second gel that shares no code with the first: a solid dome of finite elements.

Trilinear bricks with the mean dilatation of each (Hughes, *The Finite Element Method*, section
4.5), so that nearly incompressible silicone does not lock; the base is bonded. Layer by layer the
inside is condensed away (a Schur complement each) until only the surface is left, so that a finger
costs no more than a small dense solve. Nothing is fitted to the closed forms of ``kernels``.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL

Floats = NDArray[np.float64]

RADIUS_MM = PAPER_GEL.radius_mm
CELL_MM = 3.0  # side of a brick; a fingertip covers about fifteen
N_SIDE = 23  # nodes from rim to rim and one beyond, so that a point always has four to each side
LAYERS = (0.0, 0.3, 0.57, 0.8, 1.0)  # shares of the height; thin ones where the fingers are
RIM_MM, RISE_MM = 4.0, 17.0  # height at the rim, and of the middle over it
POISSON_RATIO = 0.48  # silicone
SKIN = 0.08  # how much softer a fingertip is held than by a rigid stamp, share of the gel's own
STEP_MM, STEP_RAD = 1.5, 0.1  # of a motion; the elements are linear, the path of a point is not


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """The stiffness of the gel at its surface.

    Attributes:
        plan: (n, 2) mm, the nodes seen from above.
        compliance: (3 n, 3 n), how far each moves under a unit force on each; symmetric.
        grid: (N_SIDE, N_SIDE) intp, the node at each place of the grid, n where there is none.
        skin: compliance that a fingertip adds under it.
    """

    plan: Floats
    compliance: Floats
    grid: NDArray[np.intp]
    skin: float


@lru_cache(maxsize=1)
def build_surface() -> Surface:
    """Returns the surface, solved once a process, in about a second."""
    plan, cells, grid = _plan()
    height = _height(np.hypot(*plan.T))
    surface = np.zeros((3 * len(plan), 3 * len(plan)))
    for low, high in pairwise(LAYERS):
        below, above = (np.column_stack([plan, share * height]) for share in (low, high))
        corners = np.concatenate([below[cells], above[cells]], axis=1)
        stiffness = _stiffen(corners)
        lower, upper = slice(0, 12), slice(12, 24)
        dofs = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 12)
        parts = []
        for rows, columns in ((lower, lower), (lower, upper), (upper, upper)):
            part = np.zeros_like(surface)
            np.add.at(part, (dofs[:, :, None], dofs[:, None, :]), stiffness[:, rows, columns])
            parts.append(part)
        if low == 0.0:
            surface = parts[2]  # the base is bonded
        else:
            surface = parts[2] - parts[1].T @ np.linalg.solve(surface + parts[0], parts[1])
    compliance: Floats = np.linalg.inv(surface).astype(np.float64, copy=False)
    return Surface(plan, compliance, grid, SKIN * float(np.median(np.diagonal(compliance))))


def deform(
    points: Floats, centres: Floats, radii: Floats, motions: Floats, depths: Floats
) -> Floats:
    """Moves points of the surface with the fingers that touch it.

    Args:
        points: (n, 2) float64 mm, the points at rest.
        centres: (k, 2) float64 mm, of the fingers at rest.
        radii: (k,) float64 mm.
        motions: (k, 3) float64: drag x, drag y in mm, turn in rad since rest.
        depths: (k,) float64 mm, how deep each finger presses.

    Returns:
        (n, 3) float64 mm: x, y, and how far the point has sunk.
    """
    moved = np.column_stack([points, np.zeros(len(points))])
    longest_mm = max(np.hypot(motions[:, 0], motions[:, 1]).max(), depths.max())
    if longest_mm == 0.0 and not motions.any():
        return moved
    steps = max(1, math.ceil(max(longest_mm / STEP_MM, np.abs(motions[:, 2]).max() / STEP_RAD)))
    for step in range(steps):
        here = centres + (step + 0.5) / steps * motions[:, :2]
        field = _pull(here, radii, motions / steps, depths / steps)
        moved += _read(field, moved[:, :2])
    return moved


def _pull(centres: Floats, radii: Floats, motions: Floats, depths: Floats) -> Floats:
    """Returns how every node moves, (n + 1, 3) mm, under the fingers.

    The last node never moves.
    """
    surface = build_surface()
    plan, compliance = surface.plan, surface.compliance
    away = np.hypot(plan[:, 0] - centres[:, 0, None], plan[:, 1] - centres[:, 1, None])  # (k, n)
    cover = np.clip((radii[:, None] - away) / CELL_MM + 0.25, 0.0, 1.0)  # a pad's rim grips less
    owner, held = cover.argmax(axis=0), cover.max(axis=0)
    nodes = np.flatnonzero(held > 0.01)
    k = owner[nodes]
    arm = plan[nodes] - centres[k]
    turn, drag = motions[k, 2], motions[k, :2]
    wanted = np.column_stack(
        [
            drag[:, 0] - turn * arm[:, 1],
            drag[:, 1] + turn * arm[:, 0],
            depths[k] * (1.0 - 0.5 * np.minimum(away[k, nodes] / radii[k], 1.0) ** 2),  # [Hertz]
        ]
    )
    wanted[:, 2] *= -1.0
    dofs = (3 * nodes[:, None] + np.arange(3)).ravel()
    matrix = compliance[np.ix_(dofs, dofs)]
    matrix[np.diag_indices_from(matrix)] += np.repeat(surface.skin / held[nodes], 3)
    moved = np.linalg.solve(matrix, wanted.ravel()) @ compliance[dofs]  # symmetric: rows are near
    field = np.vstack([moved.reshape(-1, 3), np.zeros(3)])
    field[:, 2] *= -1.0
    return field


def _read(field: Floats, points: Floats) -> Floats:
    """Returns the field at points (n, 2) mm by cubic (Catmull-Rom) interpolation, (n, 3) mm."""
    grid = build_surface().grid
    place = np.clip(points / CELL_MM + N_SIDE // 2, 1.0, N_SIDE - 2.001)
    first = place.astype(np.intp)
    u = (place - first)[:, :, None]
    weights = np.concatenate(
        [
            0.5 * (-(u**3) + 2 * u**2 - u),
            0.5 * (3 * u**3 - 5 * u**2 + 2),
            0.5 * (-3 * u**3 + 4 * u**2 + u),
            0.5 * (u**3 - u**2),
        ],
        axis=2,
    )  # (n, 2, 4)
    around = first[:, :, None] + np.arange(-1, 3)
    nodes = grid[around[:, 1, :, None], around[:, 0, None, :]]
    rows = (weights[:, 0, None, None, :] @ field[nodes])[:, :, 0]  # (n, 4, 3)
    read: Floats = (weights[:, 1, None, :] @ rows)[:, 0]
    return read


def _plan() -> tuple[Floats, NDArray[np.intp], NDArray[np.intp]]:
    """Returns the nodes (n, 2) mm of the bricks seen from above, the four of each, and the grid."""
    half = N_SIDE // 2
    ticks = CELL_MM * (np.arange(N_SIDE) - half)
    middle = ticks[:-1] + 0.5 * CELL_MM
    rows, columns = np.nonzero(np.hypot(middle[:, None], middle) <= RADIUS_MM + 0.2 * CELL_MM)
    corners = np.stack([rows, rows, rows + 1, rows + 1], axis=1)
    across = np.stack([columns, columns + 1, columns + 1, columns], axis=1)
    used, cells = np.unique(corners * N_SIDE + across, return_inverse=True)
    grid = np.full(N_SIDE * N_SIDE, len(used), np.intp)
    grid[used] = np.arange(len(used))
    plan = np.column_stack([ticks[used % N_SIDE], ticks[used // N_SIDE]])
    return plan, cells.reshape(-1, 4), grid.reshape(N_SIDE, N_SIDE)


def _height(r: Floats) -> Floats:
    """Returns the height of the dome in mm: a spherical cap on a flat ring."""
    sphere = (RADIUS_MM**2 + RISE_MM**2) / (2.0 * RISE_MM)
    cap = np.sqrt(sphere**2 - np.minimum(r, RADIUS_MM) ** 2) - (sphere - RISE_MM)
    height: Floats = RIM_MM + cap
    return height


def _stiffen(corners: Floats) -> Floats:
    """Returns the stiffness (e, 24, 24) of bricks (e, 8, 3) mm, four corners below, four above.

    The shear modulus µ is 1, for only ratios matter. 2 µ ε:ε is integrated at eight points; λ
    (div u)² takes the mean of the brick.
    """
    signs = np.array(
        [(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], float
    )
    bulk = 2.0 * POISSON_RATIO / (1.0 - 2.0 * POISSON_RATIO)  # λ
    shear = np.zeros((len(corners), 8, 3, 8, 3))
    mean = np.zeros((len(corners), 8, 3))
    volume = np.zeros(len(corners))
    for point in signs / math.sqrt(3.0):
        factor = 1.0 + signs * point  # (8, 3)
        slope = (
            0.125
            * signs
            * np.stack(
                [
                    factor[:, 1] * factor[:, 2],
                    factor[:, 0] * factor[:, 2],
                    factor[:, 0] * factor[:, 1],
                ],
                axis=1,
            )
        )
        jacobian = np.einsum("as,eac->esc", slope, corners)
        weight = np.linalg.det(jacobian)
        gradient = np.einsum("ecs,as->eac", np.linalg.inv(jacobian), slope)
        shear += np.einsum("e,eai,ebi,cd->eacbd", weight, gradient, gradient, np.eye(3))
        shear += np.einsum("e,ead,ebc->eacbd", weight, gradient, gradient)
        mean += weight[:, None, None] * gradient
        volume += weight
    shear += bulk * np.einsum("eac,ebd->eacbd", mean / volume[:, None, None], mean)
    return shear.reshape(len(corners), 24, 24)
