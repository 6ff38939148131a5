"""Finds light that flickers, and removes its events.

A lamp on the mains or an LED by PWM takes the light of all pixels up and down together, many times
a second. Motion never does: what brightens some pixels darkens others.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.tracker.kernels import flicker as kernels

N_BINS = 512  # a quarter of a second
FEW_BINS = 64  # enough for a first look
LOOK_BINS = 128  # from one look to the next, once all bins are full
LOWEST_HZ = 45.0  # gels, hands and mounts are slower
LEAST_SHARE = 0.15  # of the events; weaker flicker does no harm
LEAST_HZ = 10_000.0  # events per second, neither does less than this
LEAST_IMBALANCE = 0.1  # of polarities in short times; less cannot be so much flicker
CHANCE = 5.0  # standard deviations of a sum of random directions
SINE_SHARE = np.pi / 4.0  # that the sum keeps if the light is a sine
HARMONIC = 0.3  # a lower frequency that has this part of the strongest one may be the true one
NEAR = 0.75  # of the resolution: as far a multiple of the true one may be from the strongest
PAUSE_US = 750_000  # from one look at steady light to the next; looking costs time
LEAST_WIDTH = 1.0  # events, of any pixel, if most events are the light's
PREVAILING = 0.5  # share of the events
FORGET_US = 1_000_000  # light that has been steady for this time does not flicker


@dataclass(frozen=True, slots=True)
class Flicker:
    """Light that goes up and down.

    Attributes:
        hz: how often in a second: 100 or 120 with the mains, other numbers with PWM.
        share: part of all events that it makes, 0 to 1.
        events_hz: number of events that it makes in a second.
    """

    hz: float
    share: float
    events_hz: float

    @property
    def prevails(self) -> bool:
        """True if most events are the light's, so that a new rhythm of a pixel is probably, too."""
        return self.share > PREVAILING


class FlickerFilter:
    """Looks for flicker every second, and removes its events while there is some.

    Args:
        looks_late: leave it to the caller to call ``look`` after each slice, when there is time.

    Attributes:
        flicker: the flicker of the last quarter of a second, None without.
    """

    def __init__(self, *, looks_late: bool = False) -> None:
        self._looks_late = looks_late
        self.flicker: Flicker | None = None
        self._bins = np.zeros((2, N_BINS))
        self._pixels: NDArray[np.void] | None = make_pixels()  # until the first look
        self._out = np.empty(0, EVENT_DTYPE)
        self._end_us: int | None = None
        self._begin_bin = self._next_bin = 0
        self._seen_us = self._resume_us = 0

    def update(self, events: NDArray[np.void], begin_us: int, end_us: int) -> NDArray[np.void]:
        """Returns the events of a slice without those of flicker.

        Args:
            events: (n,) EVENT_DTYPE of the slice.
            begin_us: start of the slice.
            end_us: its end.

        Returns:
            (m,) EVENT_DTYPE: the same array without flicker, else one that is valid until the next
            call.
        """
        if 0 < self._resume_us - begin_us <= PAUSE_US:
            return events
        if self._end_us != begin_us:
            self._restart(begin_us)
        self._end_us = end_us
        kernels.count_events(events, begin_us, end_us, self._bins)
        if not self._looks_late:
            self.look()
        if self._pixels is None:
            return events
        if len(self._out) < len(events):
            self._out = np.empty(2 * len(events), EVENT_DTYPE)
        least = 0.0 if self.flicker is None or not self.flicker.prevails else LEAST_WIDTH
        n = kernels.remove_flicker(events, self._pixels, least, self._out)
        return events if self.flicker is None else self._out[:n]

    def _restart(self, t_us: int) -> None:
        self._bins[:] = 0.0
        self._begin_bin = t_us // kernels.BIN_US
        self._next_bin = self._begin_bin + FEW_BINS

    def look(self) -> None:
        """Updates what is known about flicker, if it is time; that takes half a millisecond."""
        t_us = self._end_us or 0
        now_bin = t_us // kernels.BIN_US
        if now_bin < self._next_bin:
            return
        n, found = min(now_bin - self._begin_bin, N_BINS), None
        self._next_bin = now_bin + (LOOK_BINS if n == N_BINS else FEW_BINS)
        if kernels.measure_imbalance(self._bins) > LEAST_IMBALANCE:
            found = find_flicker(self._bins[:, np.arange(now_bin - n, now_bin) % N_BINS])
        if found is not None:
            self.flicker, self._seen_us = found, t_us
            if self._pixels is None:
                self._pixels = make_pixels()
        elif n == N_BINS and not 0 <= t_us - self._seen_us < FORGET_US:
            self.flicker = self._pixels = None
            self._resume_us = t_us + PAUSE_US


def make_pixels() -> NDArray[np.void]:
    """Returns pixels without flicker."""
    pixels = np.zeros(SENSOR_HEIGHT_PX * SENSOR_WIDTH_PX, kernels.PIXEL)
    pixels["step"] = 1.0
    return pixels


def find_flicker(counts: NDArray[np.float64]) -> Flicker | None:
    """Returns the flicker of some time, None without.

    Args:
        counts: (2, n) float64, OFF and ON events in bins of 0.5 ms.
    """
    n = counts.shape[1]
    window = np.hanning(n)
    total = float((counts * window).sum())
    off, on = np.fft.rfft(counts * window, 2 * N_BINS)
    hz = np.arange(len(on)) * 1e6 / kernels.BIN_US / (2 * N_BINS)
    # Light gives both polarities a rhythm, each at its time. Vibration, and a hand that stops and
    # goes on, give them the same one, though one polarity may be stronger. A sensor that is read
    # out makes events of one polarity.
    apart = np.abs(np.sin(0.5 * np.angle(on * off.conj())))
    size = 2.0 * apart * np.minimum(np.abs(on), np.abs(off))
    size[hz < LOWEST_HZ] = 0.0
    peaks = np.flatnonzero((size[1:-1] >= size[:-2]) & (size[1:-1] > size[2:])) + 1
    if not total or not len(peaks):
        return None
    duration_s, top = n * kernels.BIN_US * 1e-6, peaks[size[peaks].argmax()]
    lower = peaks[size[peaks] >= HARMONIC * size[top]]  # what is left of a motion has no multiple
    off_hz = np.abs(np.rint(hz[top] / hz[lower]) * hz[lower] - hz[top])
    first = lower[off_hz < NEAR / duration_s][0]
    share = min(float(size[top]) / total / SINE_SHARE, 1.0)
    events_hz = share * float(counts.sum()) / duration_s
    if share < max(LEAST_SHARE, CHANCE / np.sqrt(total)) or events_hz < LEAST_HZ:
        return None
    return Flicker(_interpolate(hz, size, int(first)), share, events_hz)


def _interpolate(hz: NDArray[np.float64], size: NDArray[np.float64], peak: int) -> float:
    """Returns the frequency of a peak: the top of a parabola through its logarithms."""
    before, at, after = np.log(np.maximum(size[peak - 1 : peak + 2], 1e-9))
    bend = before - 2.0 * at + after
    shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    return float(hz[peak] + shift * (hz[1] - hz[0]))
