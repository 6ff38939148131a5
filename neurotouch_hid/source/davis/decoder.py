"""From the camera's bytes, cut anywhere, to events and frames."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.events import copy_events
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.source.davis import kernels


@dataclass(frozen=True, slots=True)
class Layout:
    """How the addresses of a camera lie in the picture; it says so itself.

    Attributes:
        columns: of the DVS, as the chip counts: limits X words.
        rows: of the DVS, as the chip counts: limits row words.
        swap_events: a row word is an x.
        swap_frames: columns of a frame are rows of the picture.
        flip_columns: a frame's columns come last to first.
        flip_rows: the samples of a column come last to first.
        mirrored: turn the whole picture round, left to right.
    """

    columns: int = SENSOR_HEIGHT_PX
    rows: int = SENSOR_WIDTH_PX
    swap_events: bool = True
    swap_frames: bool = True
    flip_columns: bool = False
    flip_rows: bool = False
    mirrored: bool = False

    def pack(self) -> NDArray[np.int64]:
        """The same as the kernel takes it."""
        layout = np.zeros(kernels.N_LAYOUT, np.int64)
        layout[kernels.DVS_COLUMNS], layout[kernels.DVS_ROWS] = self.columns, self.rows
        layout[kernels.DVS_SWAP], layout[kernels.APS_SWAP] = self.swap_events, self.swap_frames
        layout[kernels.FLIP_COLUMNS] = self.flip_columns
        layout[kernels.FLIP_ROWS] = self.flip_rows
        layout[kernels.MIRRORED] = self.mirrored
        return layout


@dataclass(frozen=True, slots=True)
class DecoderStats:
    """What was malformed so far, in words if nothing else is said.

    Attributes:
        bad_rows: row addresses outside the sensor.
        bad_columns: events outside the sensor.
        orphans: events without a row.
        backward: times that did not go on.
        unknown: words that mean nothing.
        resets: times the camera's clock started again after the start.
        bad_frames: frames that were cut off or had missing or surplus samples.
    """

    bad_rows: int = 0
    bad_columns: int = 0
    orphans: int = 0
    backward: int = 0
    unknown: int = 0
    resets: int = 0
    bad_frames: int = 0


class Decoder:
    """Decodes one camera's stream; any cut of the bytes gives the same result.

    Args:
        layout: how its addresses lie.
        origin_us: the stream's time at the camera's time 0.
        synced: whether words count from the first on; else from the timestamp reset on.
    """

    def __init__(
        self, layout: Layout | None = None, *, origin_us: int = 0, synced: bool = False
    ) -> None:
        self._layout = (layout or Layout()).pack()
        self._state = np.zeros(kernels.N_STATE, np.int64)
        self._state[kernels.SYNCED] = synced
        self._state[[kernels.ORIGIN, kernels.NOW]] = origin_us
        self._state[[kernels.Y, kernels.KIND]] = -1
        self._counters = np.zeros(kernels.N_COUNTERS, np.int64)
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        self._reset = np.zeros(shape, np.int16)
        self._pixels = np.zeros(shape, np.uint8)
        self._events = np.empty(0, EVENT_DTYPE)
        self._odd = b""

    @property
    def is_synced(self) -> bool:
        """True once the camera's clock is known."""
        return bool(self._state[kernels.SYNCED])

    @property
    def now_us(self) -> int:
        """The time of the last word; all later events are not older."""
        return int(self._state[kernels.NOW])

    @property
    def n_resets(self) -> int:
        """Times the camera's clock started again after the start."""
        return int(self._counters[kernels.RESETS])

    def stats(self) -> DecoderStats:
        """What was malformed so far."""
        return DecoderStats(*map(int, self._counters))

    def decode(self, data: bytes) -> tuple[NDArray[np.void], list[Frame]]:
        """What the next bytes of the stream hold.

        Returns:
            (n,) EVENT_DTYPE, ascending in ``t``, and the frames completed in them.
        """
        if self._odd:
            data = self._odd + data
        self._odd = data[len(data) & ~1 :]
        words = np.frombuffer(data, "<u2", len(data) // 2)
        if len(self._events) < len(words):
            self._events = np.empty(len(words), EVENT_DTYPE)
        position = n = 0
        frames: list[Frame] = []
        while position < len(words):
            position, n, whole = kernels.decode(
                words,
                position,
                self._layout,
                self._state,
                self._counters,
                self._events,
                n,
                self._reset,
                self._pixels,
            )
            if whole:
                frames.append(self._copy_frame())
        return copy_events(self._events[:n]), frames

    def forget(self) -> None:
        """Start afresh in mid-stream: bytes are missing; row, frame and odd byte are unknown."""
        self._odd = b""
        self._counters[kernels.BAD_FRAMES] += self._state[kernels.IN_FRAME]
        self._state[kernels.IN_FRAME] = 0
        self._state[kernels.Y] = -1

    def _copy_frame(self) -> Frame:
        begin_us = int(self._state[kernels.EXPOSURE_BEGIN_US])
        return Frame(self._pixels.copy(), begin_us, int(self._state[kernels.EXPOSURE_END_US]))
