"""A simulated subject for the pointing test: it shows that the test works, nothing about people."""

import math
from collections import deque
from typing import Final

import numpy as np

from neurotouch_hid.evaluation.people.pointing import Pointing
from neurotouch_hid.messages import Gesture, GestureKind, no_gesture
from neurotouch_hid.profile import Mapping

SLICE_US: Final = 10_000
DELAY_SLICES: Final = 15
"""It sees the pointer 150 ms late, about as late as people do."""

LEAST_MM: Final = 2.0
MOST_MM: Final = 8.0
MM_PER_PX: Final = 0.018
"""Push for each px that is left; a larger one would overshoot, because the subject sees late."""

NOISE: Final = 0.1
"""Deviation of a push as a share of it: the noise of muscles grows with their force."""

AIM: Final = 0.12
"""Deviation of its estimate of a target's middle, as a share of the target's width."""

FASTEST_MM_S: Final = 60.0
GIVE_UP_US: Final = 60_000_000


class Subject:
    """Pushes towards the target as long as it sees the pointer outside.

    Args:
        seed: of the noise.
    """

    def __init__(self, seed: int = 0) -> None:
        self._rng = np.random.default_rng(seed)
        self._seen: deque[tuple[float, float]] = deque(maxlen=DELAY_SLICES)
        self._mm = (0.0, 0.0)
        self._aim = (0.0, 0.0)

    def push(self, test: Pointing, t_us: int) -> Gesture:
        """Returns the gesture of its hand at this moment."""
        width_px, (x, y) = test.target
        x, y = x + self._aim[0] * width_px, y + self._aim[1] * width_px
        self._seen.append((x - test.pointer_px[0], y - test.pointer_px[1]))
        left_x, left_y = self._seen[0]
        left_px = math.hypot(left_x, left_y)
        wanted_mm = 0.0
        if left_px > 0.2 * width_px:
            wanted_mm = min(LEAST_MM + MM_PER_PX * left_px, MOST_MM)
        wanted_mm *= 1.0 + NOISE * float(self._rng.standard_normal())
        goal = (wanted_mm * left_x / max(left_px, 1.0), wanted_mm * left_y / max(left_px, 1.0))
        gap_mm = math.dist(goal, self._mm)
        share = min(1.0, FASTEST_MM_S * SLICE_US * 1e-6 / gap_mm) if gap_mm > 0.0 else 1.0
        self._mm = (
            self._mm[0] + share * (goal[0] - self._mm[0]),
            self._mm[1] + share * (goal[1] - self._mm[1]),
        )
        mm = math.hypot(*self._mm)
        if mm < 0.2:
            return no_gesture(t_us)
        contact = np.array([self._mm])
        return Gesture(t_us, GestureKind.PUSH, contact, np.zeros((1, 2)), mm, self._mm)

    def lift(self) -> None:
        """Lifts the hand, forgets all it has seen and aims again."""
        self._seen.clear()
        self._mm = (0.0, 0.0)
        x, y = self._rng.normal(0.0, AIM, 2)
        self._aim = (float(x), float(y))


def perform_pointing(test: Pointing, mapping: Mapping, seed: int = 0) -> None:
    """Runs the whole test with a simulated subject and a mapping; it gives up after a minute."""
    subject, t_us, begun_us = Subject(seed), 0, 0
    while not test.is_over and t_us - begun_us < GIVE_UP_US:
        if not test.is_running:
            subject.lift()
            for _ in range(30):  # at rest, as people are before they begin
                t_us += SLICE_US
                test.update(mapping.update(no_gesture(t_us)))
            test.begin()
            t_us += SLICE_US
            test.update(mapping.update(no_gesture(t_us)))
            begun_us = t_us
        t_us += SLICE_US
        test.update(mapping.update(subject.push(test, t_us)))
