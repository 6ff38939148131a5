"""Positions of all markers over time: the script's fingers through the gel's elasticity."""

import math
from collections import deque
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import GEL_RADIUS_MM, LATTICE_MM, N_MARKERS, NEIGHBOURS
from neurotouch_hid.messages import GestureKind, Truth
from neurotouch_hid.source.simulator.gel import solid
from neurotouch_hid.source.simulator.kernels import gel as kernels
from neurotouch_hid.source.simulator.optics import CameraModel
from neurotouch_hid.source.simulator.script import Grasp, Play

KNOT_US = 4_000  # fast enough for the quickest hand: 210 mm/s is 0.84 mm a knot
LABEL_FLOOR_MM = 0.3  # below it a person labels no gesture
PROBE_REACH = 0.7  # where in a patch its deformation is probed, share of its radius
N_HISTORY = 1024  # knots kept, about four seconds

Elasticity = Literal["half-space", "solid"]
ELASTICITIES: tuple[Elasticity, ...] = get_args(Elasticity)


@dataclass(frozen=True, slots=True)
class GelConfig:
    """Settings of the gel's elasticity.

    Attributes:
        lag: share of the motion that follows late; silicone loses about a tenth of its work.
        lag_us: time constant of that share.
        elasticity: closed forms of a half space (``kernels``) or the solid dome of finite elements
            (``solid``); they share no code.
    """

    lag: float = 0.1
    lag_us: int = 120_000
    elasticity: Elasticity = "half-space"


@dataclass(frozen=True, slots=True, eq=False)
class Knot:
    """The gel at one of the equally spaced moments.

    Attributes:
        outline: (177, 6) float64, see ``CameraModel.outline``.
        kind: of the stroke at work, NONE at rest.
        contacts_px: (k, 2) float64, place of the largest deformation of each finger.
        seen_mm: (k,) float64, how far that place has moved in the image since rest.
        moved_mm: (k,) float64, how far the finger's middle has moved; this is the intensity. With
            the place of the largest deformation, the error of the paper's method would be 2 mm;
            with the middle it is 1.6 mm, and on real hands 1 mm [NT, "Results"].
    """

    outline: NDArray[np.float64]
    kind: GestureKind
    contacts_px: NDArray[np.float64]
    seen_mm: NDArray[np.float64]
    moved_mm: NDArray[np.float64]


class GelMotion:
    """Knots of a script, computed in order and remembered for a few seconds.

    The state at a moment never depends on the order of the calls. A call for a moment that is no
    longer remembered computes the script again from its start.
    """

    def __init__(self, script: Play, camera: CameraModel, px_per_mm: float, gel: GelConfig) -> None:
        self._script, self._camera, self._gel = script, camera, gel
        self._px_per_mm = px_per_mm
        at_rest = camera.outline(np.column_stack([LATTICE_MM, np.zeros(N_MARKERS)]))
        self._rest = Knot(at_rest, GestureKind.NONE, np.empty((0, 2)), np.empty(0), np.empty(0))
        self._restart()

    def knot(self, index: int) -> Knot:
        """Returns the gel at ``index * KNOT_US``; negative indices are at rest."""
        if index < 0:
            return self._rest
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

    def _compute(self, index: int) -> Knot:
        found = self._script.find(index * KNOT_US)
        if found is None:
            self._grip = None
            return self._rest
        grasp, t_us = found
        if self._grip is None or self._grip.grasp is not grasp:
            self._grip = _Grip(grasp, self._camera)
        moved = self._grip.move(t_us, self._gel)
        outline = self._camera.outline(moved[:N_MARKERS])
        probes = self._camera.project(moved[N_MARKERS:])
        contacts, seen_px, moved_px = self._grip.summarise(probes)
        scale = self._px_per_mm
        return Knot(outline, grasp.kind, contacts, seen_px / scale, moved_px / scale)


class _Grip:
    """The fingers of one grasp on the gel, from the moment they touch."""

    def __init__(self, grasp: Grasp, camera: CameraModel) -> None:
        self.grasp = grasp
        fingers = grasp.fingers
        probes = [_probes(finger.contact_mm, finger.radius_mm) for finger in fingers]
        self._points = np.concatenate([LATTICE_MM, *probes])
        self._centres = np.array([finger.contact_mm for finger in fingers])
        self._radii = np.array([finger.radius_mm for finger in fingers])
        self._mobility = _mobility(grasp)
        self._late = np.column_stack([self._points, np.zeros(len(self._points))])
        self._rest_px = camera.project(self._late[N_MARKERS:])

    def move(self, t_us: int, gel: GelConfig) -> NDArray[np.float64]:
        """Returns markers, then probes, (n, 3) mm, one knot after the last call."""
        state = self.grasp.move(t_us)
        motions, depths = state[:, :3].copy(), state[:, 3].copy()
        given = (self._points, self._centres, self._radii, motions, depths)
        if gel.elasticity == "solid":
            moved = solid.deform(*given)
        else:
            moved = np.empty_like(self._late)
            kernels.move_points(*given, NEIGHBOURS, self._mobility, moved)
        self._late += (moved - self._late) * (1.0 - math.exp(-KNOT_US / gel.lag_us))
        moved += gel.lag * (self._late - moved)
        return moved

    def summarise(
        self, probes_px: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Returns the place of each finger's largest deformation, (k, 2) px.

        Also how far that place and the finger's middle have moved, (k,) each.
        """
        shape = (len(self.grasp.fingers), -1)
        far = np.linalg.norm(probes_px - self._rest_px, axis=1).reshape(shape)
        # A soft maximum: the patch's centre where it moves as one, its outer side where it turns.
        weights = (far + 1e-6) ** 8
        weights /= weights.sum(axis=1, keepdims=True)
        contacts = (weights[:, :, None] * probes_px.reshape(*shape, 2)).sum(axis=1)
        return contacts, (weights * far).sum(axis=1), far[:, 0]


def _mobility(grasp: Grasp) -> NDArray[np.float64]:
    """Returns how freely each marker moves, (177,) float64: 0 under a finger, low at the rim."""
    mobility: NDArray[np.float64] = np.maximum(
        1.0 - (np.hypot(*LATTICE_MM.T) / GEL_RADIUS_MM) ** 2, 0.0
    )
    for finger in grasp.fingers:
        away = np.hypot(*(LATTICE_MM - finger.contact_mm).T)
        mobility[away <= finger.radius_mm] = 0.0
    return mobility


def _probes(contact_mm: tuple[float, float], radius_mm: float) -> NDArray[np.float64]:
    angles = np.arange(6) * math.pi / 3.0
    ring = PROBE_REACH * radius_mm * np.column_stack([np.cos(angles), np.sin(angles)])
    return contact_mm + np.concatenate([np.zeros((1, 2)), ring])
