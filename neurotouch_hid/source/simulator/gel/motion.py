"""Positions of all markers over time: the script's fingers through the gel's elasticity."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.messages import GestureKind, Truth
from neurotouch_hid.source.simulator.config import GelConfig
from neurotouch_hid.source.simulator.field_table import FieldTable
from neurotouch_hid.source.simulator.gel import solid
from neurotouch_hid.source.simulator.kernels import gel as kernels
from neurotouch_hid.source.simulator.knot import Dots, Knot, Pose, make_dots
from neurotouch_hid.source.simulator.optics import CameraModel
from neurotouch_hid.source.simulator.script import Grasp, Play

KNOT_US = 4_000  # fast enough for the quickest hand: 210 mm/s is 0.84 mm a knot
LABEL_FLOOR_MM = 0.3  # below it a person labels no gesture
PROBE_REACH = 0.7  # where in a patch its deformation is probed, share of its radius
UNDONE_US = 100_000  # how fast a touch undoes what was left of the last one
N_HISTORY = 1024  # knots kept, about four seconds


class GelMotion:
    """Knots of a script, computed in order and remembered for a few seconds.

    The state at a moment never depends on the order of the calls. A call for a moment that is no
    longer remembered computes the script again from its start.
    """

    def __init__(
        self,
        script: Play,
        camera: CameraModel,
        gel: GelConfig,
        dots: Dots | None = None,
        mount: Sequence[Callable[[int], Pose]] = (),
    ) -> None:
        self._script, self._camera, self._gel, self._mount = script, camera, gel, mount
        self._dots = dots or make_dots(gel.layout)
        self._n = gel.layout.n_markers
        self.untouched = self._lie(self._dots.points_mm)
        self._restart()

    def knot(self, index: int) -> Knot:
        """Returns the gel at ``index * KNOT_US``; negative indices are at rest."""
        if index < 0:
            return self._place(self.untouched, index * KNOT_US)
        if index < self._next - len(self._history):
            self._restart()
        while index >= self._next:
            self._history.append(self._compute(self._next))
            self._next += 1
        return self._history[index - self._next]

    def truth(self, t_us: int) -> Truth:
        """Returns the truth at ``t_us``."""
        index, rest_us = divmod(t_us, KNOT_US)
        u = rest_us / KNOT_US
        weights = np.array(
            [-(u**3) + 2 * u**2 - u, 3 * u**3 - 5 * u**2 + 2, -3 * u**3 + 4 * u**2 + u, u**3 - u**2]
        )
        knots = [self.knot(index + k) for k in (-1, 0, 1, 2)]
        markers = np.tensordot(0.5 * weights, [knot.outline[:, :2] for knot in knots], 1)
        here, after = knots[1], knots[2]
        contacts, seen, moved = here.contacts_px, here.seen_mm, here.moved_mm
        if len(after.contacts_px) == len(contacts):
            contacts = (1 - u) * contacts + u * after.contacts_px
            seen = (1 - u) * seen + u * after.seen_mm
            moved = (1 - u) * moved + u * after.moved_mm
        felt = seen >= LABEL_FLOOR_MM
        return Truth(
            t_us,
            here.kind if felt.any() else GestureKind.NONE,
            contacts[felt],
            float(moved[felt].mean()) if felt.any() else 0.0,
            markers.astype(np.float32),
        )

    def _restart(self) -> None:
        self._history: deque[Knot] = deque(maxlen=N_HISTORY)
        self._next = 0
        self._grip: _Grip | None = None
        self._residue = Residue(self._gel.residue, self._n)
        self._rest = self.untouched

    def _compute(self, index: int) -> Knot:
        at_us = index * KNOT_US
        found = self._script.find(at_us)
        if found is None:
            if self._grip is not None and self._gel.residue:
                self._rest = self._lie(self._dots.points_mm + self._residue.lift())
            self._grip = None
            return self._place(self._rest, at_us)
        grasp, t_us = found
        if self._grip is None or self._grip.grasp is not grasp:
            self._grip = _Grip(grasp, self._camera, self._dots.points_mm, self._gel.layout)
        moved = self._grip.move(t_us, self._gel)
        if self._gel.residue:
            markers = moved[: self._n, :2]
            markers += self._residue.add(markers - self._dots.points_mm)
        probes = self._camera.project(moved[self._n :])
        contacts, seen_px, moved_px = self._grip.summarise(probes)
        scale = self._camera.rig.px_per_mm
        outline = self._draw(moved[: self._n])
        knot = Knot(outline, grasp.kind, contacts, seen_px / scale, moved_px / scale)
        return self._place(knot, at_us)

    def _lie(self, points_mm: NDArray[np.float64]) -> Knot:
        """Returns the gel with no finger on it and its markers at (n, 2) mm."""
        outline = self._draw(np.column_stack([points_mm, np.zeros(self._n)]))
        return Knot(outline, GestureKind.NONE, np.empty((0, 2)), np.empty(0), np.empty(0))

    def _draw(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        outline = self._camera.outline(points_mm)
        outline[:, 2:5] /= self._dots.size[:, None] ** 2
        outline[:, 5] *= self._dots.brightness
        return outline

    def _place(self, knot: Knot, t_us: int) -> Knot:
        """Moves a gel in the picture as its mount has moved."""
        if not self._mount:
            return knot
        poses = [pose(t_us) for pose in self._mount]
        x, y, turn = (sum(parts) for parts in zip(*poses, strict=True))
        rig = self._camera.rig
        cos, sin = math.cos(turn), math.sin(turn)
        turned = np.array([[cos, sin], [-sin, cos]])
        centre = np.array(rig.centre_px)
        shift = centre + rig.to_px(np.array([[x, y]]))[0] - centre
        outline = knot.outline.copy()
        outline[:, :2] = (outline[:, :2] - centre) @ turned + shift
        contacts = (knot.contacts_px - centre) @ turned + shift
        return replace(knot, outline=outline, contacts_px=contacts)


class FieldMotion(GelMotion):
    """Knots of a table of displacements: it moves the markers itself, without fingers."""

    def __init__(
        self,
        table: FieldTable,
        camera: CameraModel,
        gel: GelConfig,
        dots: Dots,
        mount: Sequence[Callable[[int], Pose]] = (),
    ) -> None:
        self._table, self._weights = table, table.spread(dots.points_mm)
        super().__init__(table, camera, gel, dots, mount)

    def _compute(self, index: int) -> Knot:
        at_us = index * KNOT_US
        moved_mm = self._weights @ self._table.measure(at_us)
        return self._place(self._lie(self._dots.points_mm + moved_mm), at_us)


class Residue:
    """Remainder of the markers' motion in a gel that does not come back all the way.

    Each marker keeps a share of its largest motion. The next touch undoes it.

    Args:
        share: of the largest motion.
        n: number of markers.
    """

    def __init__(self, share: float, n: int) -> None:
        self._share = share
        self._kept = np.zeros((n, 2))
        self._largest = np.zeros((n, 2))

    def add(self, motion: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns what comes on top of an elastic motion, (n, 2) mm each, one knot later."""
        size, before = np.hypot(*motion.T), np.hypot(*self._largest.T)
        self._largest = np.where((size > before)[:, None], motion, self._largest)
        self._kept *= 1.0 - KNOT_US / UNDONE_US
        way_back = 1.0 - size / np.maximum(np.maximum(size, before), 1e-9)
        more: NDArray[np.float64] = self._share * way_back[:, None] * self._largest
        return self._kept + more

    def lift(self) -> NDArray[np.float64]:
        """Returns what stays when the last finger has left, (n, 2) mm."""
        self._kept = self._kept + self._share * self._largest
        self._largest = np.zeros_like(self._kept)
        return self._kept.copy()


class _Grip:
    """The fingers of one grasp on the gel, from the moment they touch."""

    def __init__(
        self, grasp: Grasp, camera: CameraModel, points_mm: NDArray[np.float64], gel: Gel
    ) -> None:
        self.grasp, self._neighbours = grasp, gel.neighbours
        fingers = grasp.fingers
        self._labelled = np.array([finger.labelled for finger in fingers])
        probes = [_probes(finger.contact_mm, finger.radius_mm) for finger in fingers]
        self._points = np.concatenate([points_mm, *probes])
        self._centres = np.array([finger.contact_mm for finger in fingers])
        self._radii = np.array([finger.radius_mm for finger in fingers])
        self._mobility = _mobility(grasp, points_mm, gel.radius_mm)
        self._size = gel.rim_mm / PAPER_GEL.rim_mm
        self._late = np.column_stack([self._points, np.zeros(len(self._points))])
        self._rest_px = camera.project(self._late[len(points_mm) :])

    def move(self, t_us: int, gel: GelConfig) -> NDArray[np.float64]:
        """Returns markers, then probes, (n, 3) mm, one knot after the last call."""
        state = self.grasp.move(t_us)
        motions, depths = state[:, :3].copy(), state[:, 3] / self._size
        motions[:, :2] /= self._size
        points, centres, radii = (
            lengths / self._size for lengths in (self._points, self._centres, self._radii)
        )
        given = (points, centres, radii, motions, depths)
        if gel.elasticity == "solid":
            moved = solid.deform(*given)
        else:
            moved = np.empty_like(self._late)
            kernels.move_points(*given, self._neighbours, self._mobility, moved)
        moved *= self._size  # elasticity knows no unit of length
        self._late += (moved - self._late) * (1.0 - math.exp(-KNOT_US / gel.lag_us))
        moved += gel.lag * (self._late - moved)
        return moved

    def summarise(
        self, probes_px: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Returns the place of each labelled finger's largest deformation, (k, 2) px.

        Also how far that place and the finger's middle have moved, (k,) each.
        """
        shape = (len(self.grasp.fingers), -1)
        far = np.linalg.norm(probes_px - self._rest_px, axis=1).reshape(shape)
        # A soft maximum: the patch's centre where it moves as one, its outer side where it turns.
        weights = (far + 1e-6) ** 8
        weights /= weights.sum(axis=1, keepdims=True)
        contacts = (weights[:, :, None] * probes_px.reshape(*shape, 2)).sum(axis=1)
        chosen = self._labelled
        return contacts[chosen], (weights * far).sum(axis=1)[chosen], far[chosen, 0]


def _mobility(
    grasp: Grasp, points_mm: NDArray[np.float64], radius_mm: float
) -> NDArray[np.float64]:
    """Returns how freely each marker moves, (n,) float64: 0 under a finger, low at the rim."""
    mobility: NDArray[np.float64] = np.maximum(1.0 - (np.hypot(*points_mm.T) / radius_mm) ** 2, 0.0)
    for finger in grasp.fingers:
        away = np.hypot(*(points_mm - finger.contact_mm).T)
        mobility[away <= finger.radius_mm] = 0.0
    return mobility


def _probes(contact_mm: tuple[float, float], radius_mm: float) -> NDArray[np.float64]:
    angles = np.arange(6) * math.pi / 3.0
    ring = PROBE_REACH * radius_mm * np.column_stack([np.cos(angles), np.sin(angles)])
    return contact_mm + np.concatenate([np.zeros((1, 2)), ring])
