"""Measures the speed of decoding the camera's bytes on this machine."""

import time

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.davis.decoder import Decoder

TRANSFER_BYTES = 8_192
N_US = 200_000
EVENTS_PER_US = 5
"""5 million events/s: each µs brings its time word, and a row and a column word for each event."""


def measure_decoding() -> NDArray[np.float64]:
    """Returns events a second from bytes to events, for each transfer of a busy stream."""
    data = _make_stream()
    decoder, rates = Decoder(synced=True), []
    decoder.decode(data[:TRANSFER_BYTES])  # compiles or loads the kernels
    for begin in range(TRANSFER_BYTES, len(data), TRANSFER_BYTES):
        begun = time.perf_counter()
        events, _ = decoder.decode(data[begin : begin + TRANSFER_BYTES])
        rates.append(len(events) / (time.perf_counter() - begun))
    return np.array(rates)


def _make_stream() -> bytes:
    """Returns a stream of events all over the sensor, with wraps of the clock."""
    rng = np.random.default_rng(0)
    words = np.empty((N_US, 1 + 2 * EVENTS_PER_US), "<u2")
    low = np.arange(1, N_US + 1) % 0x8000
    words[:, 0] = np.where(low, 0x8000 | low, 0x7001)
    shape = (N_US, EVENTS_PER_US)
    words[:, 1::2] = 0x1000 | rng.integers(SENSOR_WIDTH_PX, size=shape)
    words[:, 2::2] = 0x2000 | rng.integers(2, size=shape) << 12
    words[:, 2::2] |= rng.integers(SENSOR_HEIGHT_PX, size=shape).astype("<u2")
    return words.tobytes()
