"""Pictures for the camera, at a fixed rate, there before it is plugged in."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

PERIOD_US = 8_000


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """Grey pictures, again from the first when the last is over.

    Attributes:
        pictures: (n, h, w) uint8.
        period_us: time from one to the next.
    """

    pictures: NDArray[np.uint8]
    period_us: int = PERIOD_US

    def find(self, t_us: int) -> NDArray[np.uint8]:
        """Returns the picture at a time since its begin: (h, w) uint8."""
        picture: NDArray[np.uint8] = self.pictures[t_us // self.period_us % len(self.pictures)]
        return picture
