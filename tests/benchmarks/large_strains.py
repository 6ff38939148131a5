"""Plays gestures on a dome that strains without limit, and says how exactly they are recognised.

Run by hand; a gesture takes some ten seconds:

    python tests/benchmarks/large_strains.py            all variants of the gel
    python tests/benchmarks/large_strains.py flat 4     one, with four gestures of each kind

The gel is neo-Hookean: bricks whose volume change is taken at their middle, so that nearly
incompressible silicone does not lock; the base is bonded, soft fingertips stick. It shares no code
with the recogniser, nor with the simulator. Its unit of force is that of the shear modulus, 1.
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from neurotouch_hid.geometry import PAPER_GEL, Rig  # noqa: E402
from neurotouch_hid.gesture import GestureRecognizer  # noqa: E402
from neurotouch_hid.messages import MarkerField  # noqa: E402

CELL_MM, N_SIDE = 3.0, 23
LAYERS = (0.0, 0.3, 0.57, 0.8, 1.0)  # shares of the height
CORNERS = np.array(
    [(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], float
)
STEP_MM = 0.8  # of a finger, between two equilibria
SHARES = np.linspace(0.125, 1.0, 8)  # of a gesture, at which the field is kept
SINK_MM = 100.0  # from lens to gel: what sinks grows
NOISE_PX = 0.12
RIG = Rig((171.0, 128.0), 2.5, 0.03)


@dataclass(frozen=True)
class Gel:
    """Height of the rim, and of the middle over it, mm; Poisson's ratio; how tips grip."""

    rim_mm: float
    rise_mm: float
    poisson_ratio: float
    grip: float


GELS = {
    "dome": Gel(4.0, 17.0, 0.48, 3.0),
    "rigid-tips": Gel(4.0, 17.0, 0.48, 40.0),
    "flat": Gel(3.0, 8.0, 0.48, 3.0),
    "soft-tips": Gel(4.0, 17.0, 0.495, 1.0),
}


@dataclass(frozen=True)
class Finger:
    """Where it sticks, mm; its radius; how far it drags (2,), turns (rad) and presses."""

    centre: np.ndarray
    radius: float
    drag: np.ndarray
    turn: float
    depth: float


class Dome:
    """The bricks of a gel; ``deform`` moves their nodes to equilibrium."""

    def __init__(self, gel):
        half = N_SIDE // 2
        ticks = CELL_MM * (np.arange(N_SIDE) - half)
        middle = ticks[:-1] + 0.5 * CELL_MM
        inside = np.hypot(middle[:, None], middle) <= PAPER_GEL.radius_mm + 0.2 * CELL_MM
        rows, columns = np.nonzero(inside)
        corners = np.stack([rows, rows, rows + 1, rows + 1], 1) * N_SIDE
        corners += np.stack([columns, columns + 1, columns + 1, columns], 1)
        used, cells = np.unique(corners, return_inverse=True)
        cells = cells.reshape(-1, 4)
        self.plan = np.column_stack([ticks[used % N_SIDE], ticks[used // N_SIDE]])
        self.node = np.full(N_SIDE * N_SIDE, -1)
        self.node[used] = np.arange(len(used))
        n, self.grip = len(used), gel.grip
        sphere = (PAPER_GEL.radius_mm**2 + gel.rise_mm**2) / (2.0 * gel.rise_mm)
        r = np.minimum(np.hypot(*self.plan.T), PAPER_GEL.radius_mm)
        height = gel.rim_mm + np.sqrt(sphere**2 - r**2) - (sphere - gel.rise_mm)
        places = np.concatenate([np.column_stack([self.plan, s * height]) for s in LAYERS])
        self.bricks = np.concatenate(
            [np.hstack([cells + k * n, cells + (k + 1) * n]) for k in range(len(LAYERS) - 1)]
        )
        self.volumetric = 2.0 * gel.poisson_ratio / (1.0 - 2.0 * gel.poisson_ratio)
        self.points = [self._slopes(places, p) for p in CORNERS / math.sqrt(3.0)]
        self.middle = self._slopes(places, np.zeros(3))[0]
        self.volume = sum(weight for _, weight in self.points)
        dofs = (3 * self.bricks[:, :, None] + np.arange(3)).reshape(len(self.bricks), 24)
        self.dofs = dofs.ravel()
        self.at = np.repeat(dofs, 24, axis=1).ravel(), np.tile(dofs, (1, 24)).ravel()
        self.n_dofs, self.free = 3 * len(places), np.arange(3 * n, 3 * len(places))
        self.top = np.arange((len(LAYERS) - 1) * n, len(LAYERS) * n)

    def _slopes(self, places, point):
        factor = 1.0 + CORNERS * point
        others = np.stack([factor[:, 1] * factor[:, 2], factor[:, 0] * factor[:, 2],
                           factor[:, 0] * factor[:, 1]], axis=1)  # fmt: skip
        jacobian = np.einsum("as,eac->esc", 0.125 * CORNERS * others, places[self.bricks])
        slopes = np.einsum("ecs,as->eac", np.linalg.inv(jacobian), 0.125 * CORNERS * others)
        return slopes, np.linalg.det(jacobian)

    def _resist(self, u):
        """The forces of the gel against a displacement, and their slope."""
        moved = u.reshape(-1, 3)[self.bricks]
        force = np.zeros((len(self.bricks), 8, 3))
        slope = np.zeros((len(self.bricks), 8, 3, 8, 3))
        for gradient, weight in self.points:  # of µ/2 (tr C - 3) - µ ln J
            f = np.eye(3) + np.einsum("eac,eai->eic", gradient, moved)
            inverse = np.linalg.inv(f)
            stress = f - inverse.transpose(0, 2, 1)
            tangent = np.einsum("ejk,eli->eijkl", inverse, inverse)
            tangent += np.einsum("ik,jl->ijkl", np.eye(3), np.eye(3))
            force += np.einsum("e,eic,eac->eai", weight, stress, gradient)
            slope += np.einsum(
                "e,eaj,ebl,eijkl->eaibk", weight, gradient, gradient, tangent, optimize=True
            )
        f = np.eye(3) + np.einsum("eac,eai->eic", self.middle, moved)  # of λ/2 (ln J)²
        inverse, grown = np.linalg.inv(f), self.volumetric * np.log(np.linalg.det(f))
        tangent = self.volumetric * np.einsum("eji,elk->eijkl", inverse, inverse)
        tangent -= np.einsum("e,ejk,eli->eijkl", grown, inverse, inverse)
        force += np.einsum("e,eci,eac->eai", self.volume * grown, inverse, self.middle)
        slope += np.einsum(
            "e,eaj,ebl,eijkl->eaibk", self.volume, self.middle, self.middle, tangent, optimize=True
        )
        total = np.zeros(self.n_dofs)
        np.add.at(total, self.dofs, force.ravel())
        shape = (self.n_dofs, self.n_dofs)
        return total, sparse.csr_matrix((slope.ravel(), self.at), shape=shape)

    def deform(self, fingers):
        """Where the nodes of the surface go at each of SHARES: (8, n, 3) mm."""
        away = np.array([np.hypot(*(self.plan - finger.centre).T) for finger in fingers])
        radii = np.array([finger.radius for finger in fingers])[:, None]
        hold = np.clip((radii - away) / CELL_MM + 0.5, 0.0, 1.0)
        owner, hold = hold.argmax(axis=0), hold.max(axis=0)
        held = np.flatnonzero(hold > 0.01)
        spring = np.zeros(self.n_dofs)
        at = (3 * self.top[held][:, None] + np.arange(3)).ravel()
        spring[at] = np.repeat(self.grip * CELL_MM * hold[held], 3)
        furthest = max(
            max(math.hypot(*finger.drag), abs(finger.turn) * finger.radius) for finger in fingers
        )
        n_between = max(1, math.ceil(SHARES[0] * furthest / STEP_MM))
        u, wanted, fields = np.zeros(self.n_dofs), np.zeros(self.n_dofs), []
        for k in range(n_between * len(SHARES)):
            share = (k + 1) / (n_between * len(SHARES))
            wanted[at] = self._place(fingers, owner[held], held, share).ravel()
            for _ in range(25):
                force, slope = self._resist(u)
                force += spring * (u - wanted)
                if np.abs(force[self.free]).max() < 1e-3:
                    break
                matrix = (slope + sparse.diags(spring))[self.free][:, self.free].tocsc()
                options = {"SymmetricMode": True}
                solver = splu(matrix, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
                by = solver.solve(-force[self.free])
                u[self.free] += min(1.0, 1.0 / max(np.abs(by).max(), 1e-9)) * by
            else:
                raise ArithmeticError("no equilibrium")
            if (k + 1) % n_between == 0:
                fields.append(u.reshape(-1, 3)[self.top].copy())
        return np.array(fields)

    def _place(self, fingers, owner, held, share):
        wanted = np.zeros((len(held), 3))
        for m, (k, i) in enumerate(zip(owner, held, strict=True)):
            finger, arm = fingers[k], self.plan[i] - fingers[k].centre
            wanted[m, :2] = share * finger.drag + rotate(arm, share * finger.turn) - arm
            flat = 1.0 - 0.5 * min(math.hypot(*arm) / finger.radius, 1.0) ** 2
            wanted[m, 2] = -finger.depth * min(1.0, 4.0 * share) * flat
        return wanted

    def read(self, field, points):
        """The displacement of points (m, 2) of the surface, (m, 3) mm."""
        place = points / CELL_MM + N_SIDE // 2
        first = place.astype(int)
        (a, b), found = (place - first).T, np.zeros((len(points), 3))
        for di, wx in ((0, 1.0 - a), (1, a)):
            for dj, wy in ((0, 1.0 - b), (1, b)):
                node = self.node[(first[:, 1] + dj) * N_SIDE + first[:, 0] + di]
                found += np.where(node < 0, 0.0, wx * wy)[:, None] * field[node]
        return found


def rotate(arm, angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])


def draw(kind, rng):
    """The fingers of a random gesture."""
    radius, depth = rng.uniform(5.0, 7.5), rng.uniform(0.5, 3.0)
    size, angle = rng.uniform(2.5, 9.0), rng.uniform(-math.pi, math.pi)
    way = np.array([math.cos(angle), math.sin(angle)])
    if kind == "push":
        end = rng.normal(0.0, 8.0, 2)
        end *= min(1.0, 18.0 / math.hypot(*end))
        return [Finger(end - size * way, radius, size * way, rng.normal(0.0, 0.1), depth)]
    n = 3 if rng.random() < 0.35 else 2
    middle, spread = rng.normal(0.0, 4.0, 2), rng.uniform(7.5 if n == 2 else 9.0, 13.0)
    fingers = []
    for k in range(n):
        arm, part = rotate(spread * way, 2.0 * math.pi * k / n), rng.uniform(0.7, 1.0)
        turn = rng.normal(0.0, 0.05)
        if kind == "twist":
            angle = part * min(size / spread, 0.6)
            drag, turn = rotate(arm, angle) - arm, angle * rng.uniform(0.5, 1.0)
        elif kind == "pinch":
            drag = -part * min(size, spread - 0.8 * radius) / spread * arm
        else:
            drag = part * min(size, max(21.0 - math.hypot(*(middle + arm)), 2.0)) / spread * arm
        fingers.append(Finger(middle + arm, radius, drag, turn, part * depth))
    return fingers


def play(dome, fingers, rng):
    """Shares of slices with the right count; true and told intensity, mm; distance, mm."""
    fields = dome.deform(fingers)
    seen = np.array([dome.read(field, PAPER_GEL.points_mm) for field in fields])
    seen = np.concatenate([np.zeros((1, *seen.shape[1:])), seen])
    moved = dome.read(fields[-1], np.array([finger.centre for finger in fingers]))[:, :2]
    contacts = moved + [finger.centre for finger in fingers]
    rest_px = RIG.to_px(PAPER_GEL.points_mm).astype(np.float32)
    recognizer, noise, told, use = GestureRecognizer(), np.zeros((177, 2)), [], np.ones(177, bool)
    for t_us in range(10_000, 650_001, 10_000):
        share = 0.5 - 0.5 * math.cos(math.pi * min(max((t_us - 100_000) / 300_000, 0.0), 1.0))
        k = min(int(8 * share), 7)
        field = seen[k] + (8 * share - k) * (seen[k + 1] - seen[k])
        sunk = np.clip(-field[:, 2:], -5.0, 8.0)
        noise = 0.7 * noise + rng.normal(0.0, NOISE_PX * math.sqrt(0.51), noise.shape)
        px = RIG.to_px((PAPER_GEL.points_mm + field[:, :2]) * (1.0 + sunk / SINK_MM)) + noise
        gesture = recognizer.update(MarkerField(t_us, rest_px, px.astype(np.float32), use))
        if t_us > 450_000:
            told.append(gesture)
    near = [
        np.hypot(*(g.contacts_mm - c).T).min() for g in told for c in contacts if len(g.contacts_mm)
    ]
    return (
        np.mean([len(g.contacts_mm) == len(fingers) for g in told]),
        np.mean(np.hypot(*moved.T)),
        np.mean([g.intensity_mm for g in told]),
        np.mean(near),
    )


def main():
    names = sys.argv[1:2] or list(GELS)
    n = int(sys.argv[2]) if len(sys.argv) > 2 else 6
    print("| gel | gesture | count | told of true (median) | MAE mm | distance mm |")
    for name in names:
        dome, rng = Dome(GELS[name]), np.random.default_rng(1)
        for kind in ("push", "pinch", "zoom", "twist"):
            rows = np.array([play(dome, draw(kind, rng), rng) for _ in range(n)])
            true, told = rows[:, 1], rows[:, 2]
            print(
                f"| {name} | {kind} | {100 * rows[:, 0].mean():.0f} % | "
                f"{np.median(told / true):.2f} | {np.abs(told - true).mean():.2f} | "
                f"{rows[:, 3].mean():.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
