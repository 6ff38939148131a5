"""Compiled loops that count events for the search for flicker, and remove those of flicker."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import kernel

BIN_US = 500
SAMPLES = 16  # of the events in a bin; enough to see a rhythm
N_RUNS = 4  # runs of events of one polarity after which a pixel's flicker is measured again
CLOCK_SHIFT = 6  # a pixel's clock ticks every 64 µs
LONGEST = (N_RUNS * 11_000) >> CLOCK_SHIFT  # ticks of so many runs with a lamp of 45 Hz
SILENT = LONGEST // 2  # ticks; light moves a pixel up and down at least once in this time
REMEMBERED = 20_000.0  # events by which a pixel's thresholds are compared: they never change
MOTION = 2  # events that remain of N_RUNS runs: the picture moves, which tells less of thresholds
MOTION_WEIGHT = 0.125  # of such events
EVEN = 4.0  # events of each polarity that a new pixel counts as having made
WHOLE = 0.999  # an event, but for rounding

PIXEL: Final = np.dtype(
    [
        ("since", "u4"),
        ("n_off", "u2"),
        ("n_on", "u2"),
        ("n_runs", "u1"),
        ("is_on", "?"),
        ("rises", "?"),
        ("n_left", "i2"),
        ("last", "u2"),
        ("sum_off", "f4"),
        ("sum_on", "f4"),
        ("step", "f4"),
        ("width", "f4"),
        ("place", "f4"),
        ("moved", "f4"),
    ],
    align=True,
)
"""The flicker of one pixel.

- ``since``: when the counts began, in ticks of the pixel's clock.
- ``n_off``, ``n_on``: events since then of each polarity.
- ``n_runs``: how often the polarity has changed since then.
- ``is_on``: polarity of the last event.
- ``rises``: the range has last moved up.
- ``n_left``: by how many events the range has moved since ``since``.
- ``last``: when the last event came, in the same ticks, modulo 4.2 s.
- ``sum_off``, ``sum_on``: older events of each polarity. In the long run a pixel brightens as much
  as it darkens, so their ratio is that of its thresholds.
- ``step``: how far an OFF event goes, in ON events.
- ``width``: how far the light takes the pixel up and down, in ON events: its range.
- ``place``: where the pixel is in that range.
- ``moved``: how far the range has moved beyond what the remaining events tell, in ON events.
"""


@kernel
def count_events(
    events: NDArray[np.void], begin_us: int, end_us: int, bins: NDArray[np.float64]
) -> None:
    """Adds a sample of the events of a slice to their bins of time.

    Args:
        events: (m,) EVENT_DTYPE.
        begin_us: start of the slice.
        end_us: its end. Bins that begin in the slice are emptied first.
        bins: (2, k) float64, OFF and ON events, a ring.
    """
    m, k = len(events), bins.shape[1]
    first, last = -(-begin_us // BIN_US), -(-end_us // BIN_US)
    for b in range(max(first, last - k), last):
        bins[0, b % k] = bins[1, b % k] = 0.0
    step = 1 + m // (max(last - first, 1) * SAMPLES)
    for i in range(0, m, step):
        e = events[np.uint64(i)]
        bins[np.uint64(e.p), (e.t // BIN_US) % k] += step


@kernel
def measure_imbalance(bins: NDArray[np.float64]) -> float:
    """Returns by how much one polarity prevails in each bin, -1 to 1, beyond chance."""
    total = off = 0.0
    for b in range(bins.shape[1]):
        n = bins[0, b] + bins[1, b]
        total += n
        off += abs(bins[1, b] - bins[0, b]) - np.sqrt(n)
    return off / total if total else 0.0


@kernel
def remove_flicker(
    events: NDArray[np.void], pixels: NDArray[np.void], least: float, out: NDArray[np.void]
) -> int:
    """Copies the events that are not flicker.

    Flicker takes a pixel up and down through the same range each time. Events within that range are
    dropped. Beyond it the range moves, because the picture has changed; one event remains for each
    event by which it has moved.

    Args:
        events: (m,) EVENT_DTYPE.
        pixels: (260 * 346,) ``PIXEL``, updated.
        least: the smallest range of a pixel, in ON events. A motion takes pixels that have not
            flickered to where they do, and the range is not known until ``N_RUNS`` runs later.
        out: (m or more,) EVENT_DTYPE, written.

    Returns:
        The number of events written.
    """
    n = np.uint64(0)
    for k in range(len(events)):
        e = events[np.uint64(k)]
        s = pixels[np.uint64(e.y) * np.uint64(SENSOR_WIDTH_PX) + np.uint64(e.x)]
        now = np.uint16((e.t >> CLOCK_SHIFT) & 0xFFFF)
        if s.is_on != e.p:
            if least > 0.0 and np.uint16(now - s.last) > SILENT:  # light does not move it now
                s.place = max(s.width, np.float32(least)) if e.p else np.float32(0.0)
                s.moved = np.float32(0.0)
            s.is_on = e.p
            s.n_runs += 1
            if s.n_runs >= N_RUNS:
                _measure(e.t, s)
        s.last = now
        if e.p:
            s.n_on += 1
            s.place += np.float32(1.0)
        else:
            s.n_off += 1
            s.place -= s.step
        width = max(s.width, np.float32(least))
        inside = min(max(s.place, np.float32(0.0)), width)
        if s.place != inside:
            s.rises = s.place > inside
        s.moved += s.place - inside
        s.place = inside
        out[n] = e
        moved = s.moved if e.p else -s.moved
        if moved >= WHOLE:
            s.moved -= np.float32(1.0) if e.p else np.float32(-1.0)
            s.n_left += 1 if e.p else -1
        n += np.uint64(moved >= WHOLE or width == 0.0)
    return int(n)


@kernel(inline="always")
def _measure(t_us: int, s: Any) -> None:
    """Updates the range of a pixel by its last runs."""
    now = np.uint32((t_us >> CLOCK_SHIFT) & 0xFFFFFFFF)
    weight = np.float32(MOTION_WEIGHT if abs(s.n_left) >= MOTION else 1.0)
    s.sum_on, s.sum_off = s.sum_on + weight * s.n_on, s.sum_off + weight * s.n_off
    if s.sum_on + s.sum_off >= REMEMBERED:
        s.sum_on, s.sum_off = np.float32(0.5) * s.sum_on, np.float32(0.5) * s.sum_off
    s.step = np.float32((s.sum_on + EVEN) / (s.sum_off + EVEN))
    if np.uint32(now - s.since) < LONGEST:  # without flicker, runs last longer
        width = np.float32((s.n_on + s.n_off * s.step) / N_RUNS)
        if s.rises:  # a pixel at the top of its range remains there, as one at the bottom does
            s.place += width - s.width
        s.width = width
        s.place = min(max(s.place, np.float32(0.0)), s.width)
    s.since, s.n_on, s.n_off, s.n_runs, s.n_left = now, 0, 0, 0, 0
