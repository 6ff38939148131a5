"""How strong the gesture is."""

import numpy as np
from numpy.typing import NDArray


def measure_intensity(displacement_mm: NDArray[np.float64]) -> float:
    """Mean displacement of the markers around the contacts, mm.

    [NT, "Gesture Classification and Intensity Prediction"], in millimetres of the gel.

    Args:
        displacement_mm: (n, 2) float64 mm, the markers of A(t_k); 0 where there are none.
    """
    if not len(displacement_mm):
        return 0.0
    return float(np.linalg.norm(displacement_mm, axis=1).mean())
