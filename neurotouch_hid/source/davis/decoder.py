"""Decodes the camera's bytes, cut anywhere, into events and frames."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.events import copy_events
from neurotouch_hid.messages import EVENT_DTYPE, Frame
from neurotouch_hid.process.kernel_cache import bind
from neurotouch_hid.source.davis.kernels.decode import (
    BETWEEN_COLUMNS,
    COUNTERS_DTYPE,
    STATE_DTYPE,
    WRAP_US,
    AddressLayout,
    decode,
)
from neurotouch_hid.source.davis.mosaic import Mosaic


class DecoderStats(NamedTuple):
    """Malformed data so far, counted in words unless stated otherwise.

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

    @property
    def n_impossible(self) -> int:
        """Words that no camera sends, whatever else was lost."""
        return self.bad_rows + self.bad_columns + self.unknown

    @property
    def n_lost(self) -> int:
        """Signs that events are lost, or have wrong times."""
        return self.bad_rows + self.bad_columns + self.orphans + self.backward + self.resets


class Decoder:
    """Decodes one camera's stream; any cut of the bytes gives the same result.

    Args:
        layout: how its addresses map to the picture.
        origin_us: the stream's time at the camera's time 0.
        synced: use all words from the first; else skip those before the timestamp reset.
        is_colour: the sensor has a colour filter, whose mosaic is taken out of the frames.

    Attributes:
        is_synced: the camera's clock is known.
        now_us: the time of the last word; all later events are not older.
    """

    def __init__(
        self,
        layout: AddressLayout | None = None,
        *,
        origin_us: int = 0,
        synced: bool = False,
        is_colour: bool = False,
    ) -> None:
        self._layout = layout or AddressLayout()
        self._state = np.zeros(1, STATE_DTYPE)
        self._state["is_synced"] = synced
        self._state["origin_us"] = self._state["now_us"] = origin_us
        self._state["y"], self._state["kind"] = -1, BETWEEN_COLUMNS
        self._clock = self._state["now_us"], self._state["is_synced"]  # views
        self._origin_us = self._state["origin_us"]
        self.now_us, self.is_synced = origin_us, synced
        self._counters, self._stats = np.zeros(1, COUNTERS_DTYPE), DecoderStats()
        shape = (self._layout.height_px, self._layout.width_px)
        self._pixels = np.zeros(shape, np.uint8)
        reset = np.zeros(shape, np.int16)
        self._decode = bind(decode, self._layout, self._state, self._counters, reset, self._pixels)
        self._events = np.empty(0, EVENT_DTYPE)
        self._odd = b""
        self._mosaic = Mosaic() if is_colour else None

    def stats(self) -> DecoderStats:
        """Returns counts of malformed data so far; the same object until one changes."""
        counts = self._counters.item()
        if counts != self._stats:
            self._stats = DecoderStats(*counts)
        return self._stats

    def decode(self, data: bytes) -> tuple[NDArray[np.void], list[Frame]]:
        """Returns the events and frames in the next bytes of the stream.

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
            position, n, whole = self._decode(words, position, self._events, n)
            if whole:
                frames.append(self._copy_frame())
        now_us, is_synced = self._clock
        self.now_us, self.is_synced = now_us.item(), is_synced.item()
        return copy_events(self._events[:n]), frames

    def find_word(self, t_us: int) -> int:
        """Returns the 15 bits that the camera sends of a time."""
        origin_us: int = self._origin_us.item()
        return (t_us - origin_us) % WRAP_US

    def forget(self) -> None:
        """Starts again in mid-stream: bytes are missing; row, frame and odd byte are unknown."""
        self._odd = b""
        self._counters["bad_frames"] += self._state["in_frame"]
        self._state["in_frame"] = False
        self._state["y"] = -1
        self._state["is_cut"] = True

    def _copy_frame(self) -> Frame:
        state = self._state[0]
        begin_us, end_us = int(state["exposure_begin_us"]), int(state["exposure_end_us"])
        pixels = self._pixels.copy()
        if self._mosaic is not None:
            self._mosaic.level(pixels)
        return Frame(pixels, begin_us, end_us)
