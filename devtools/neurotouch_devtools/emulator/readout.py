"""A frame as runs of words with due times, the way the camera's logic reads it out."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import Frame

Words = NDArray[np.uint16]


class Special(IntEnum):
    """Words with code 0."""

    TIMESTAMP_RESET = 1
    FRAME_START_GLOBAL = 8
    FRAME_START_ROLLING = 9
    FRAME_END = 10
    RESET_COLUMN = 11
    SIGNAL_COLUMN = 12
    COLUMN_END = 13
    EXPOSURE_BEGIN = 14
    EXPOSURE_END = 15


SAMPLE_CODE = 0x4000
ROI_HIGH_CODE, ROI_LOW_CODE = 0x5100, 0x5200
EXPOSURE_CODE = 0x6000

COLUMN_US = 20
"""Time to read a column. That of a real camera is unknown; here a full frame takes 10 ms, well
below the 25 ms that 40 frames a second allow."""

_RESET_LEVEL = 1023
"""The ADC's value of a reset pixel; each pixel's own differs a little, as on every real sensor."""
_SPREAD = 3


@dataclass(frozen=True, slots=True)
class Region:
    """The part of the picture that is read, in image pixels, all four inclusive."""

    start_x: int
    start_y: int
    end_x: int
    end_y: int


@dataclass(slots=True, eq=False)
class Readout:
    """A frame on its way out: runs of words with their due times.

    Attributes:
        t_us: (k,) int64, scene time at which each run is due, ascending.
        end: (k,) int64, the index after each run's last word.
        dated: (k,) bool, the run begins with a time word.
        words: all words.
        next: the first run that has not been sent.
    """

    t_us: NDArray[np.int64]
    end: NDArray[np.int64]
    dated: NDArray[np.bool_]
    words: Words
    next: int = 0

    @property
    def done(self) -> bool:
        """True if everything has been sent."""
        return self.next == len(self.t_us)

    @property
    def n_words_left(self) -> int:
        """Upper bound of the words still to be sent, including those for time."""
        n_sent = int(self.end[self.next - 1]) if self.next else 0
        return len(self.words) - n_sent + 2 * (len(self.t_us) - self.next)


def _nothing() -> Readout:
    none = np.zeros(0, np.int64)
    return Readout(none, none, np.zeros(0, np.bool_), np.zeros(0, np.uint16))


NO_READOUT = _nothing()


def read_out(
    frame: Frame,
    region: Region,
    *,
    orientation: int,
    exposure_cycles: int,
    begin_us: int,
    global_shutter: bool = True,
    halved: bool = False,
) -> Readout:
    """Returns a frame's words: start, exposure, region, reset and signal columns, end.

    Every value v of 0 to 255 is sent as a difference of 4 v between reset and signal: both ways to
    get 8 bits from the ADC's 10, ``ceil(d / 4)`` (dv-processing) and ``d >> 2``, give v again.

    Args:
        frame: pixels and times.
        region: the region to read.
        orientation: value of the register: swap, flip of the column and of the row counter.
        exposure_cycles: value of the three exposure words.
        begin_us: scene time at which the readout of the reset columns begins.
        global_shutter: value of the start word; the order of the columns does not change.
        halved: all samples are half as large.
    """
    reset, signal = _samples(frame, region, orientation)
    if halved:
        reset, signal = reset // 2, reset // 2 - (reset - signal) // 2
    n_columns = len(reset)
    start = Special.FRAME_START_GLOBAL if global_shutter else Special.FRAME_START_ROLLING
    head = [start, *_exposure_words(exposure_cycles), *_region_words(region)]
    before = np.linspace(begin_us, frame.exposure_begin_us, n_columns + 1)[1:].astype(np.int64)
    after = frame.exposure_end_us + COLUMN_US * np.arange(1, n_columns + 1)
    runs = [
        (np.array([begin_us]), np.array([head]), True),
        (before, _columns(Special.RESET_COLUMN, reset), False),
        (np.array([frame.exposure_begin_us]), np.array([[Special.EXPOSURE_BEGIN]]), True),
        (np.array([frame.exposure_end_us]), np.array([[Special.EXPOSURE_END]]), True),
        (after, _columns(Special.SIGNAL_COLUMN, signal), False),
        (after[-1:], np.array([[Special.FRAME_END]]), True),
    ]
    return Readout(
        t_us=np.concatenate([t for t, _, _ in runs]).astype(np.int64),
        end=np.cumsum(np.concatenate([np.full(len(w), w.shape[1]) for _, w, _ in runs])),
        dated=np.concatenate([np.full(len(t), dated) for t, _, dated in runs]),
        words=np.concatenate([w.ravel() for _, w, _ in runs]).astype(np.uint16),
    )


def readout_us(region: Region, orientation: int) -> int:
    """Returns the time of one readout of a region's columns."""
    swap = orientation & 0b100
    n_columns = region.end_y - region.start_y + 1 if swap else region.end_x - region.start_x + 1
    return n_columns * COLUMN_US


def _samples(
    frame: Frame, region: Region, orientation: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Returns reset and signal samples, (columns, rows), as the chip reads them."""
    rows, columns = np.mgrid[region.start_y : region.end_y + 1, region.start_x : region.end_x + 1]
    reset = _RESET_LEVEL - (7 * rows + 3 * columns) % _SPREAD
    signal = np.maximum(reset - 4 * frame.pixels[rows, columns].astype(np.int64), 1)
    if not orientation & 0b100:
        reset, signal = reset.T, signal.T
    if orientation & 0b010:
        reset, signal = reset[::-1], signal[::-1]
    if orientation & 0b001:
        reset, signal = reset[:, ::-1], signal[:, ::-1]
    return reset, signal


def _columns(start: Special, samples: NDArray[np.int64]) -> NDArray[np.int64]:
    edge = np.ones((len(samples), 1), np.int64)
    return np.hstack([start * edge, SAMPLE_CODE | samples, Special.COLUMN_END * edge])


def _exposure_words(cycles: int) -> list[int]:
    return [EXPOSURE_CODE | cycles >> shift & 0x3FF for shift in (0, 10, 20)]


def _region_words(region: Region) -> list[int]:
    words = []
    for value in (region.start_x, region.start_y, region.end_x, region.end_y):
        words += [ROI_HIGH_CODE | value >> 8, ROI_LOW_CODE | value & 0xFF]
    return words
