"""Finds the tremor of a hand while it holds a movement."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

BAND_HZ: Final = (3.0, 12.0)
"""Parkinsonian 3 to 8 Hz, essential 4 to 12 Hz, physiological 8 to 12 Hz."""

DRIFT_HZ: Final = 1.5
"""How far a tremor wanders about its own frequency: counted in with it."""

LEAST_MM: Final = 0.1
LEAST_S: Final = 2.0


@dataclass(frozen=True, slots=True)
class Tremor:
    """A tremor.

    Attributes:
        frequency_hz: its peak.
        amplitude_mm: of the swing about it, 1.5 Hz to each side.
    """

    frequency_hz: float
    amplitude_mm: float


def find_tremor(mm: NDArray[np.float64], step_us: int) -> Tremor | None:
    """Returns the tremor of a hold, or None if there is none or it was too short to tell.

    Args:
        mm: (n,) how far the hand was, equally spaced, in mm.
        step_us: the time from one to the next.
    """
    n = len(mm)
    if n * step_us < LEAST_S * 1e6:
        return None
    window = np.hanning(n)
    trend = np.polynomial.Polynomial.fit(np.arange(n), mm, 2)(np.arange(n))
    spectrum = np.abs(np.fft.rfft((mm - trend) * window)) ** 2
    power = 2.0 * spectrum / (n * (window**2).sum())  # its sum is the variance
    frequency_hz = np.fft.rfftfreq(n, step_us * 1e-6)
    inside = (frequency_hz >= BAND_HZ[0]) & (frequency_hz <= BAND_HZ[1])
    if not inside.any():
        return None
    peak_hz = float(frequency_hz[inside][power[inside].argmax()])
    near = np.abs(frequency_hz - peak_hz) <= DRIFT_HZ
    amplitude_mm = float(np.sqrt(2.0 * power[near].sum()))
    others = inside & ~near
    floor = float(power[others].mean()) if others.any() else 0.0
    if amplitude_mm < LEAST_MM or power[inside].max() < 4.0 * floor:
        return None
    return Tremor(peak_hz, amplitude_mm)
