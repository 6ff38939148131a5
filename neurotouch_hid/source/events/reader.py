"""Makes slices of the library's packets."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import CameraError
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.source.events.library import Picture, Ring
from neurotouch_hid.source.sensor_map import SensorMap
from neurotouch_hid.source.slicer import Slicer
from neurotouch_hid.source.view import View

MAX_JUMP_US: Final = 1_000_000
"""The camera's clock may gain or lose so much on the host's at once."""
_NEAR_LIMIT: Final = 0.95
"""Share of a camera's limit from which on it has probably dropped events."""
_LEAST_US: Final = 1_000
"""Shorter packets say nothing about the rate."""


class ClockJumpError(CameraError):
    """The camera's times make no sense."""


class PacketReader:
    """Brings events to the canonical picture and cuts them into slices.

    Args:
        view: the map from the camera's picture.
        slice_us: length of a slice.
        begin_us: the stream's time at the camera's first.
        put: takes the slices; returns the length of the parts in which the next ones come, or
            None.
        max_events_per_s: the camera drops events beyond; 0 if it does not.
        keeps_size: the slices are in the camera's own pixels.
        clock_s: the host's clock.

    Attributes:
        end_us: end of the last slice.
        n_events: events of the camera so far.
        n_shown: those that the canonical picture got.
        n_lost: buffers and parts that were lost so far, and times that went back.
        limited_us: time during which the camera was at its limit, and dropped events.
    """

    def __init__(
        self,
        view: View,
        slice_us: int,
        begin_us: int,
        put: Callable[[EventPacket], int | None],
        *,
        max_events_per_s: int = 0,
        keeps_size: bool = False,
        clock_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self._map = SensorMap(view, begin_us, keeps_size=keeps_size)
        self._slicer = Slicer(slice_us, begin_us)
        self._put, self._clock_s = put, clock_s
        self._limit = _NEAR_LIMIT * 1e-6 * max_events_per_s
        self._shift_us: int | None = None
        self._lead_us = 0.0
        self._dropped = self._gap = 0
        self.end_us = begin_us
        self.n_events = self.n_shown = self.n_lost = self.limited_us = 0

    def note_lost(self, n: int) -> None:
        """Counts what is missing before the next packet; the next slice says so."""
        self.n_lost += n
        self._gap += n

    def read(self, ring: Ring, packet: Any) -> None:
        """Takes a packet, and hands over the slices that it completes.

        Raises:
            ClockJumpError: its times make no sense.
        """
        events = packet.polarity_events
        now_us = self._check_clock(ring.current_t, events)
        self._count_lost(ring, packet)
        frames = self._map.map_frames(
            make_frame(picture, self._shift_us or 0) for picture in getattr(packet, "frames", ())
        )
        n_back, begun = self._map.n_back, False
        if events is not None and len(events):
            self._note_rate(events)
            for part in self._map.map_events(_rename(events), self._shift_us or 0):
                self._deliver(self._slicer.push(part, () if begun else frames))
                self.n_shown += len(part)
                begun = True
        if not begun:
            self._deliver(self._slicer.push(_NOTHING, frames))
        self.note_lost(self._map.n_back - n_back)
        self._map.last_us = max(self._map.last_us, now_us)  # no later event is older
        self._deliver(self._slicer.reach(now_us))

    def _check_clock(self, current_us: int, events: NDArray[np.void] | None) -> int:
        """Returns the stream's time of the camera's, whose first is the origin."""
        host_us = 1e6 * self._clock_s()
        if self._shift_us is None:
            first_us = current_us
            if events is not None and len(events):
                first_us = min(first_us, int(events["t"][0]))
            self._shift_us = self.end_us - first_us
            self._lead_us = current_us - host_us
        gained_us = current_us - host_us - self._lead_us
        if gained_us > MAX_JUMP_US or (now_us := current_us + self._shift_us) < (
            self._map.last_us - MAX_JUMP_US
        ):
            raise ClockJumpError(
                f"The camera's clock jumped by {1e-6 * gained_us:.0f} s; the camera is started "
                "again."
            )
        # The camera's clock lags while data waits, so it is compared with its greatest lead.
        self._lead_us += max(0.0, gained_us)
        return now_us

    def _count_lost(self, ring: Ring, packet: Any) -> None:
        overflows = packet.polarity_events_overflow_indices
        n = 0 if overflows is None else len(overflows)
        dropped = ring.dropped_packets
        n += dropped - self._dropped if dropped >= self._dropped else dropped
        self._dropped = dropped
        self.note_lost(n)

    def _note_rate(self, events: NDArray[np.void]) -> None:
        self.n_events += len(events)
        length_us = int(events["t"][-1]) - int(events["t"][0])
        if self._limit and length_us >= _LEAST_US and len(events) >= self._limit * length_us:
            self.limited_us += length_us

    def _deliver(self, packets: Iterator[EventPacket]) -> None:
        for packet in packets:
            self.end_us = packet.t_end_us
            self._slicer.part_us = self._put(
                replace(packet, gap=self._gap) if self._gap else packet
            )
            self._gap = 0


def load_kernels(view: View, *, has_frames: bool) -> None:
    """Compiles or loads what the first packet of a camera needs, so that none waits for it."""
    sensor_map = SensorMap(view)
    sensor_map.map_events(_rename(_ANY_EVENT))
    if has_frames:
        sensor_map.map_frames([Frame(np.zeros((view.height_px, view.width_px), np.uint8), 0, 0)])


def make_frame(picture: Picture, shift_us: int) -> Frame:
    """Returns a frame of the library's, whose values have 10 bits, shifted left by 6.

    The eight bits are rounded as this package's own driver rounds them.
    """
    end_us = picture.t if picture.exposure_end_t is None else picture.exposure_end_t
    begin_us = end_us if picture.exposure_start_t is None else picture.exposure_start_t
    light = np.minimum(((picture.pixels >> 6) + 3) >> 2, 255).astype(np.uint8)
    return Frame(light, begin_us + shift_us, end_us + shift_us)


def _rename(events: NDArray[np.void]) -> NDArray[np.void]:
    """Returns the library's events with our name of the polarity; nothing is copied."""
    dtype = events.dtype
    fields: dict[str, Any] = dict(dtype.fields or {})
    renamed = {
        "names": ["p" if name == "on" else name for name in fields],
        "formats": [field[0] for field in fields.values()],
        "offsets": [field[1] for field in fields.values()],
        "itemsize": dtype.itemsize,
    }
    return events.view(np.dtype(renamed))  # type: ignore[call-overload]


_NOTHING: Final = np.empty(0, EVENT_DTYPE)
_ANY_EVENT: Final = np.zeros(1, [("t", "<u8"), ("x", "<u2"), ("y", "<u2"), ("on", "?")])
"""An event as the library has them: nothing is between the fields."""
