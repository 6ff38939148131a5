"""Motion of the whole gel in its mount: bumps, creep, vibration."""

import math

from neurotouch_hid.source.simulator.knot import Pose
from neurotouch_hid.source.simulator.script import rise
from neurotouch_hid.source.simulator.setup import Setup

BUMP_AT = 0.3  # share of the play
BUMP_US = 50_000
RINGING, RINGING_HZ, RINGING_US = 0.25, 18.0, 120_000
"""A bumped stand rings; after a few of these times it is still."""
FAN_HZ = 24.0  # a case fan of 1,440 turns a minute
BEAT_HZ = 2.0  # 120 beats a minute
BEAT_US = 90_000
BASS_HZ = 55.0


def bump(setup: Setup, mm: float) -> Setup:
    """Moves the gel by ``mm`` mm in 50 ms, in a random direction; it rings and stays there."""
    way = setup.random("bump").uniform(-math.pi, math.pi)
    at_us = BUMP_AT * setup.duration_us

    def pose(t_us: int) -> Pose:
        since_us = t_us - at_us
        if since_us <= 0:
            return 0.0, 0.0, 0.0
        turn = 2e-6 * math.pi * RINGING_HZ * since_us
        ringing = math.exp(-since_us / RINGING_US) * math.sin(turn)
        size = mm * (rise(since_us, BUMP_US) + RINGING * ringing)
        return size * math.cos(way), size * math.sin(way), 0.0

    return setup.plus(mount=pose)


def creep(setup: Setup, mm: float) -> Setup:
    """Moves the gel evenly, by ``mm`` mm until the end of the play, and no further."""
    way = setup.random("creep").uniform(-math.pi, math.pi)

    def pose(t_us: int) -> Pose:
        size = mm * min(max(t_us / setup.duration_us, 0.0), 1.0)
        return size * math.cos(way), size * math.sin(way), 0.0

    return setup.plus(mount=pose)


def turn(setup: Setup, degrees: float) -> Setup:
    """Turns the gel evenly, clockwise by ``degrees``° until the end of the play."""

    def pose(t_us: int) -> Pose:
        return 0.0, 0.0, math.radians(degrees) * min(max(t_us / setup.duration_us, 0.0), 1.0)

    return setup.plus(mount=pose)


def fan(setup: Setup, mm: float) -> Setup:
    """Shakes the gel by ``mm`` mm to either side at 24 Hz all the time."""
    way = setup.random("fan").uniform(-math.pi, math.pi)

    def pose(t_us: int) -> Pose:
        size = mm * math.sin(2e-6 * math.pi * FAN_HZ * t_us)
        return size * math.cos(way), size * math.sin(way), 0.0

    return setup.plus(mount=pose)


def music(setup: Setup, mm: float) -> Setup:
    """Shakes the gel by ``mm`` mm at 55 Hz with each beat, two a second."""
    way = setup.random("music").uniform(-math.pi, math.pi)

    def pose(t_us: int) -> Pose:
        since_us = t_us % (1e6 / BEAT_HZ)
        size = mm * math.exp(-since_us / BEAT_US) * math.sin(2e-6 * math.pi * BASS_HZ * t_us)
        return size * math.cos(way), size * math.sin(way), 0.0

    return setup.plus(mount=pose)
