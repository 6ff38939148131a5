"""Cuts any stream of events and frames into equal slices of sensor time."""

from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.events import join_events
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.recording import Batch
from neurotouch_hid.source.partial import cut

MAX_SILENCE_US = 10_000_000
"""Longer times without any event are skipped instead of filled with empty slices: a camera has
noise events all the time, so such a hole is a paused recording or a reset clock, and a jump of
hours must not become millions of packets. The slices after it stay on the same grid."""
_SLICES_AHEAD: Final = 16
"""So many slices of a recording are read one right after the other: its code and data are still in
the processor's caches then. Read one by one, between two steps, each takes twice as long."""
_EVENTS_AHEAD: Final = 1 << 16
"""No more events are read ahead: 1 MB."""


class Slicer:
    """Cuts packets of ``slice_us`` µs; each begins where the last one ended.

    A slice is complete when an event at or after its end has arrived, or when ``reach`` gives a
    later time of the sensor's clock. A frame goes into the slice in which its exposure ended; one
    that arrives after that slice was delivered goes into the next. ``gap`` is 0: a slicer does not
    count lost events.

    Args:
        slice_us: length of a slice.
        begin_us: where the first slice begins; at the first stamp without.

    Attributes:
        part_us: slices come in parts of this length; None: they come whole. A slice or part whose
            end has been asked for keeps it.
    """

    def __init__(self, slice_us: int, begin_us: int | None = None) -> None:
        if slice_us <= 0:
            raise ValueError("a slice has at least 1 µs")
        self._slice_us = slice_us
        self.part_us: int | None = None
        self._begin_us = self._origin_us = begin_us
        self._end_us: int | None = None  # of the slice that is being filled, or of its part
        self._parts: list[NDArray[np.void]] = []
        self._frames: list[Frame] = []

    def find_end(self) -> int:
        """Returns the end of the slice that is being filled, or of its part; it has begun."""
        if self._end_us is None:
            begin_us, origin_us = self._begin_us, self._origin_us
            assert begin_us is not None and origin_us is not None  # noqa: S101, PT018 - it began
            left_us = self._slice_us - (begin_us - origin_us) % self._slice_us
            self._end_us = begin_us + min(self.part_us or left_us, left_us)
        return self._end_us

    def push(self, events: NDArray[np.void], frames: Iterable[Frame] = ()) -> Iterator[EventPacket]:
        """Takes a batch and yields the slices that it completes.

        Args:
            events: (n,) EVENT_DTYPE, ascending in ``t`` and not older than those before. Packets
                are views of it, so it must not be written to afterwards.
            frames: those that arrived with the events.
        """
        self._frames.extend(frames)
        if not len(events):
            return
        t = events["t"]
        if self._begin_us is None:
            self._begin(min([int(t[0]), *(f.exposure_end_us for f in self._frames)]))
        position, last_us = 0, int(t[-1])
        while (end_us := self.find_end()) <= last_us:
            stop = position + int(t[position:].searchsorted(end_us))
            yield self._cut(events[position:stop], end_us)
            position = stop
            if not self._parts:
                self._skip_silence(int(t[position]))
        if position < len(events):
            self._parts.append(events[position:])

    def reach(self, now_us: int) -> Iterator[EventPacket]:
        """Yields the slices that end at or before ``now_us``; no later event is older."""
        if self._begin_us is None:
            if not self._frames:
                return
            self._begin(min(f.exposure_end_us for f in self._frames))
        while (end_us := self.find_end()) <= now_us:
            yield self._cut(np.empty(0, EVENT_DTYPE), end_us)
            self._skip_silence(now_us)

    def partial(self, now_us: int, most: int) -> EventPacket | None:
        """Returns the events so far of the slice being filled; the whole slice follows at its end.

        Args:
            now_us: no later event is older.
            most: largest number of events to copy.

        Returns:
            The partial slice; None if ``now_us`` is in another slice or there are more events.
        """
        begin_us = self._begin_us
        if begin_us is None or not begin_us < now_us < (end_us := self.find_end()):
            return None
        if sum(map(len, self._parts)) > most:
            return None
        if len(self._parts) > 1:
            self._parts = [join_events(self._parts)]
        events = self._parts[0] if self._parts else np.empty(0, EVENT_DTYPE)
        return cut(EventPacket(begin_us, end_us, events), now_us)

    def flush(self) -> Iterator[EventPacket]:
        """Yields the remaining slices at the end of the stream, the last one in full length."""
        stamps = [f.exposure_end_us for f in self._frames]
        stamps += [int(part["t"][-1]) for part in self._parts]
        if not stamps:
            return
        if self._begin_us is None:
            self._begin(min(stamps))
        while self._parts or self._frames:
            yield self._cut(np.empty(0, EVENT_DTYPE), self.find_end())
            if self._frames and not self._parts:
                self._skip_silence(min(f.exposure_end_us for f in self._frames))

    def _begin(self, at_us: int) -> None:
        self._begin_us = self._origin_us = at_us

    def _cut(self, tail: NDArray[np.void], end_us: int) -> EventPacket:
        """Returns the packet up to ``end_us``: the parts kept so far and ``tail``."""
        parts = [*self._parts, tail] if len(tail) else self._parts
        events = parts[0] if len(parts) == 1 else join_events(parts)
        frames: list[Frame] = []
        if self._frames:
            frames = [f for f in self._frames if f.exposure_end_us < end_us]
            frames.sort(key=lambda f: f.exposure_end_us)
            self._frames = [f for f in self._frames if f.exposure_end_us >= end_us]
        begin_us = self._begin_us
        assert begin_us is not None  # noqa: S101 - a slice that ends has begun
        self._begin_us, self._end_us = end_us, None
        self._parts = []
        return EventPacket(begin_us, end_us, events, tuple(frames))

    def _skip_silence(self, next_us: int) -> None:
        """Skips to the slice of ``next_us`` after a silence longer than ``MAX_SILENCE_US``."""
        assert self._begin_us is not None  # noqa: S101 - a packet was cut before
        if next_us - self._begin_us <= MAX_SILENCE_US:
            return
        next_us = min([next_us, *(f.exposure_end_us for f in self._frames)])
        if next_us - self._begin_us > MAX_SILENCE_US:
            self._begin_us += (next_us - self._begin_us) // self._slice_us * self._slice_us
            self._end_us = None


def slice_recording(batches: Iterable[Batch], slice_us: int) -> Iterator[EventPacket]:
    """Yields all slices of a recording, the last one included.

    One that breaks off is sliced up to the break; then its error is raised.

    Args:
        batches: what a ``Recording`` gives.
        slice_us: length of a slice.

    Raises:
        RecordingError: as reading the recording.
    """
    slicer = Slicer(slice_us)
    broken: RecordingError | None = None
    ahead, n_events = list[EventPacket](), 0
    try:
        for events, frames in batches:
            ahead.extend(slicer.push(events, frames))
            if frames:  # those that come long before the next event do not wait for it
                ahead.extend(slicer.reach(max(frame.exposure_end_us for frame in frames)))
            n_events += len(events)
            if len(ahead) >= _SLICES_AHEAD or n_events >= _EVENTS_AHEAD:
                yield from ahead
                ahead, n_events = [], 0
    except RecordingError as error:
        broken = error
    yield from ahead
    yield from slicer.flush()
    if broken is not None:
        raise broken
