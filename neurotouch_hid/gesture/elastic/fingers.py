"""The fingers that explain one field."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(slots=True, eq=False)
class Fingers:
    """Fingers that explain one field.

    Attributes:
        centres: (k, 2) mm, on the gel at rest.
        radii: (k,) mm.
        motions: (k, 3): drag x, drag y in mm, sine of the turn.
        press: (k,) mm.
        offset: (3,): mm, mm, rad, what everything moved by.
        residual: (n, 2) mm.
        cost: weighted sum of squares of the residual, mm².
    """

    centres: Floats
    radii: Floats
    motions: Floats
    press: Floats
    offset: Floats
    residual: Floats
    cost: float = 0.0

    def locate(self) -> tuple[Floats, Floats]:
        """Where each finger deforms the gel most: its patch's points weighted by their motion.

        A finger that drags moves all of its patch alike; one that turns with the hand moves the
        outer side more, and there people see the deformation.

        Returns:
            (k, 2) mm on the gel at rest, and (k, 2) mm, how far these points have moved.
        """
        drag, turn = self.motions[:, :2], self.motions[:, 2:]
        square = (drag**2).sum(axis=1, keepdims=True) + 0.5 * (turn * self.radii[:, None]) ** 2
        side = np.column_stack([drag[:, 1], -drag[:, 0]])
        shift = 0.25 * turn * self.radii[:, None] ** 2 * side / np.maximum(square, 1e-6)
        bend = np.sqrt(1.0 - turn**2) - 1.0
        moved = drag + turn * np.column_stack([-shift[:, 1], shift[:, 0]]) + bend * shift
        return self.centres + shift, moved

    def measure(self) -> Floats:
        """How far each finger moves the gel under it, (k,) mm: rms over its patch."""
        square = (self.motions[:, :2] ** 2).sum(axis=1)
        lengths: Floats = np.sqrt(square + 0.5 * (self.motions[:, 2] * self.radii) ** 2)
        return lengths

    @property
    def largest_mm(self) -> float:
        """The largest motion of a finger."""
        return float(self.measure().max(initial=0.0))
