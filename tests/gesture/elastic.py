"""Fields of fingers on an elastic dome, for tests: Mindlin drag and Reissner-Sagoci twist.

Coupled patches (each finger keeps its prescribed motion) under a clamped rim. Nothing here is
shared with the recognizer or the simulator.
"""

from dataclasses import dataclass

import numpy as np

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import GestureKind, MarkerField

POISSON = 0.48
RIM_MM = 31.0
RIM_POWER = 0.37
PATCH_MM = 7.0
RIG = Rig((171.0, 128.0), 2.5, 0.03)


def drag(points, centre, patch=PATCH_MM):
    """(n, 2, 2) response of every point to a unit drag of a sticking patch at the centre."""
    offset = points - centre
    r = np.maximum(np.linalg.norm(offset, axis=1), 1e-9)
    ratio = np.minimum(patch / r, 1.0)
    radial = (2 - POISSON) * np.arcsin(ratio)
    shear = POISSON * ratio * np.sqrt(1 - ratio**2)
    c, s = (offset / r[:, None]).T
    cos2, sin2 = c * c - s * s, 2 * c * s
    gain = 2 / (np.pi * (2 - POISSON))
    response = gain * np.array(
        [[radial + shear * cos2, shear * sin2], [shear * sin2, radial - shear * cos2]]
    )
    response[:, :, r <= patch] = np.eye(2)[:, :, None]
    return response.transpose(2, 0, 1) * _rim(points, centre)[:, None, None]


def twist(points, centre, patch=PATCH_MM):
    """(n, 2) response of every point to a unit clockwise turn (y down) of a patch."""
    offset = points - centre
    r = np.maximum(np.linalg.norm(offset, axis=1), 1e-9)
    ratio = np.minimum(patch / r, 1.0)
    outside = 2 / np.pi * (r * np.arcsin(ratio) - patch * np.sqrt(1 - ratio**2))
    turn = np.where(r <= patch, r, outside) * _rim(points, centre)
    return np.stack([-offset[:, 1], offset[:, 0]], axis=1) / r[:, None] * turn[:, None]


def _rim(points, centre):
    def window(p):
        return np.maximum(1 - (p**2).sum(axis=-1) / RIM_MM**2, 0.0)

    return (window(points) / window(centre)) ** RIM_POWER


def field(centres, motions, turns=None):
    """(177, 2) mm: displacement of every marker when each finger keeps its own motion.

    Args:
        centres: (k, 2) mm, where the fingers stick.
        motions: (k, 2) mm, how far each is dragged.
        turns: (k,) rad, how far each is turned.
    """
    k = len(centres)
    turns = np.zeros(k) if turns is None else turns
    wanted = motions - sum(twist(centres, c) * w for c, w in zip(centres, turns, strict=True))
    coupling = np.concatenate([drag(centres, c) for c in centres], axis=2)
    load = np.linalg.solve(coupling.reshape(2 * k, 2 * k), wanted.reshape(-1)).reshape(k, 2)
    return sum(
        drag(PAPER_GEL.points_mm, c) @ q + twist(PAPER_GEL.points_mm, c) * w
        for c, q, w in zip(centres, load, turns, strict=True)
    )


def markers(displacement_mm, *, t_us=0, noise_px=0.0, rng=None, valid=None):
    """The MarkerField a tracker with that noise would give."""
    rest = RIG.to_px(PAPER_GEL.points_mm)
    position = RIG.to_px(PAPER_GEL.points_mm + displacement_mm)
    if noise_px:
        position = position + rng.normal(0, noise_px, position.shape)
    valid = np.ones(len(rest), bool) if valid is None else valid
    return MarkerField(t_us, rest.astype(np.float32), position.astype(np.float32), valid)


@dataclass(frozen=True)
class Scene:
    kind: GestureKind
    centres: np.ndarray  # (k, 2) mm
    peak: np.ndarray  # (k, 2) mm: motion of each finger in the hold phase
    turn: float  # rad
    strength: np.ndarray  # (k,)
    delay: np.ndarray  # (k,) s

    def at(self, seconds):
        """(177, 2) mm field, (k', 2) mm true contacts, mean displacement in mm."""
        attack, hold, release = 0.25, 0.5, 0.3
        t = seconds - self.delay
        rise = np.clip(t / attack, 0, 1)
        fall = np.clip((t - attack - hold) / release, 0, 1)
        level = _smooth(rise) * (1 - _smooth(fall)) * self.strength
        on = level > 0.02
        if not on.any():
            return np.zeros_like(PAPER_GEL.points_mm), np.zeros((0, 2)), 0.0
        motion = self.peak[on] * level[on, None]
        u = field(self.centres[on], motion, self.turn * level[on])
        return u, self.centres[on] + motion, float(np.linalg.norm(motion, axis=1).mean())


def _smooth(x):
    return x * x * (3 - 2 * x)


def random_scene(rng, kind, *, equal=False):
    """A gesture of one to three unequal fingers, late to one another by up to 80 ms."""
    k = int(rng.integers(1, 3)) if kind is GestureKind.PUSH else int(rng.integers(2, 4))
    k = 1 if kind is GestureKind.PUSH and rng.random() < 0.7 else k
    size = float(np.clip(rng.lognormal(np.log(5.0), 0.5), 1.5, 12.0))
    middle = rng.uniform(-5, 5, 2)
    angle = rng.uniform(0, 2 * np.pi) + np.arange(k) * 2 * np.pi / k + rng.uniform(-0.3, 0.3, k)
    ray = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    strength = np.ones(k) if equal else rng.uniform(0.45, 1.0, k)
    strength /= strength.max()
    delay = 0.2 + (np.zeros(k) if equal else rng.uniform(0, 0.08, k))
    turn = 0.0
    if kind is GestureKind.PUSH:
        centres = middle + (ray * 9.0 if k > 1 else rng.uniform(-10, 10, (1, 2)))
        heading = rng.uniform(0, 2 * np.pi)
        peak = np.tile(size * np.array([np.cos(heading), np.sin(heading)]), (k, 1))
    elif kind is GestureKind.PINCH:
        reach = max(14.0, size + 8.0)
        centres, peak = middle + ray * reach, -ray * size
    elif kind is GestureKind.ZOOM:
        reach = 10.0
        size = min(size, 10.0)
        centres, peak = middle + ray * reach, ray * size
    else:
        reach = 13.0
        turn = size / reach * (1 if kind is GestureKind.TWIST_CW else -1)
        c, s = np.cos(turn), np.sin(turn)
        centres = middle + ray * reach
        peak = ray * reach @ np.array([[c, s], [-s, c]]) - ray * reach
    norm = np.linalg.norm(centres, axis=1, keepdims=True)
    centres = centres * np.minimum(1.0, 24.0 / norm)
    return Scene(kind, centres, peak, turn, strength, delay)
