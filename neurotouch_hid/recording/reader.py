"""Recordings in: the events and frames of an AEDAT4 file in order of time, a batch at a time.

The file is walked twice side by side, once for its events and once for its frames, so no packet
waits for another one, however far apart they are in the file. What one slice can hold is bounded,
too: a camera gives so many events and frames in a moment, and more are damage.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.events import copy_events
from neurotouch_hid.messages import EVENT_DTYPE, Frame
from neurotouch_hid.recording.container import Container, DamageError
from neurotouch_hid.recording.header import Stream
from neurotouch_hid.recording.kernels import events as kernels
from neurotouch_hid.recording.sensor import DAVIS346, LARGEST_PX
from neurotouch_hid.recording.unpacking import (
    MAX_STAMP_US,
    UnfitError,
    unpack_events,
    unpack_frame,
)

Batch = tuple[NDArray[np.void], tuple[Frame, ...]]
"""Events ((n,) EVENT_DTYPE, ascending), and frames. No event of a later batch is older than the end
of these frames' exposures."""

TOLERATED_STEP_BACK_US: Final = 10_000
"""Smaller steps back are rounding between packets; the events keep the later stamp."""
MOST_WAITING: Final = 64
"""So many frames go out without waiting for the next event: 6 MB."""

Item = TypeVar("Item")

_PIECE: Final = 1 << 16
"""Events of a batch, at most: 1 MB."""


class Recording:
    """An AEDAT4 file by any writer; iterating reads it from the start, in bounded memory.

    A file that breaks off or is damaged yields everything up to there, then raises.

    Args:
        path: the file.

    Attributes:
        path: the file.
        has_frames: there is a stream of frames.
        simulation: where simulated data come from; None if they are not marked as simulated.
        size_px: width and height of the sensor whose pixels the events name.

    Raises:
        RecordingError: not a readable AEDAT4 file with events.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        with Container(self.path) as file:
            streams, self.simulation = file.header.streams, file.header.simulation
        self._events = _find(streams, "EVTS")
        self._frames = _find(streams, "FRME")
        if self._events is None:
            raise RecordingError(
                f"'{self.path}' has no stream of events.",
                hint="Record with the events switched on.",
            )
        self.size_px = self._check_size(streams[self._events].size)
        if self.size_px != DAVIS346.size_px:
            self._frames = None  # only those of a DAVIS-346 are read
        self.has_frames = self._frames is not None
        if self._frames is not None:
            self._check_size(streams[self._frames].size, DAVIS346.size_px)

    def _check_size(
        self, size: tuple[int, int] | None, wanted: tuple[int, int] | None = None
    ) -> tuple[int, int]:
        """Returns the size of a sensor's picture, if it is one that can be read."""
        if size is None:
            raise RecordingError(
                f"'{self.path}' is of unknown size.",
                hint="Its header must name width and height of the sensor.",
            )
        if wanted not in (None, size):
            raise RecordingError(
                f"'{self.path}' has frames of {size[0]}×{size[1]}, not the 346×260 of its events.",
                hint="Record it again.",
            )
        if not all(2 <= side <= LARGEST_PX for side in size):
            raise RecordingError(
                f"'{self.path}' is {size[0]}×{size[1]}, no sensor's size.",
                hint=f"From 2 to {LARGEST_PX} pixels can be read.",
            )
        return size

    def __iter__(self) -> Iterator[Batch]:
        with _Reading(self.path, self._events, self._frames, self.size_px) as reading:
            frames = reading.frames()
            frame = next(frames, None)
            for piece in reading.events():
                events, waiting = piece, list[Frame]()
                while frame is not None and frame.exposure_end_us <= events["t"][-1]:
                    waiting.append(frame)
                    frame = next(frames, None)
                    if len(waiting) == MOST_WAITING:
                        end_us = max(each.exposure_end_us for each in waiting)
                        before = int(np.searchsorted(events["t"], end_us))
                        yield events[:before], tuple(waiting)
                        events = events[before:]
                        waiting = []
                yield events, tuple(waiting)
            if not reading.has_events:
                raise reading.damage or RecordingError(
                    f"'{self.path}' has no events.",
                    hint="Check the camera's cable and event output.",
                )
            while frame is not None:
                yield np.empty(0, EVENT_DTYPE), (frame,)
                frame = next(frames, None)
            if damage := reading.damage:
                raise damage


def _find(streams: dict[int, Stream], kind: str) -> int | None:
    """Returns the number of the first stream of a kind."""
    return next((number for number, stream in streams.items() if stream.kind == kind), None)


class _Reading(Closing):
    """One reading of a file: two walks, and the first damage that one of them meets."""

    def __init__(
        self, path: Path, events: int | None, frames: int | None, size_px: tuple[int, int]
    ) -> None:
        self._path, self._size_px = path, size_px
        self._events, self._frames = events, frames
        self._file = Container(path)
        self._end: float = float("inf")  # position of the damage: the other walk ends there, too
        self._damage: RecordingError | str = ""
        self._first_us: int | None = None
        self._last_us = -1
        self._frame_us = -MAX_STAMP_US
        # A DAVIS-346 gives at most 12 events/µs and 40 frames/s, a larger sensor more events.
        per_us = 20 if size_px == DAVIS346.size_px else 200
        self._event_rate = _Rate(most=1_000_000, per_us=per_us)
        self._frame_rate = _Rate(most=MOST_WAITING, per_us=0.001)

    def events(self) -> Iterator[NDArray[np.void]]:
        """Gives the events, none of the arrays empty."""
        return self._walk(self._events, self._take_events)

    def frames(self) -> Iterator[Frame]:
        """Gives the frames."""
        return self._walk(self._frames, self._take_frame)

    @property
    def has_events(self) -> bool:
        """True once an event has come."""
        return self._first_us is not None

    @property
    def damage(self) -> RecordingError | None:
        """The damage that has ended the walks; None so far."""
        if isinstance(self._damage, RecordingError) or not self._damage:
            return self._damage or None
        where = "before its first event"
        if self._first_us is not None:
            where = f"{(self._last_us - self._first_us) / 1e6:.3f} s after its first event"
        return RecordingError(
            f"'{self._path}' {self._damage} {where}.", hint="Copy it again from its origin."
        )

    def close(self) -> None:
        """Closes the file."""
        self._file.close()

    def _walk(
        self, stream: int | None, take: Callable[[bytes | memoryview], Iterator[Item]]
    ) -> Iterator[Item]:
        position = 0
        try:
            for position, data in self._file.walk(stream):
                if position >= self._end:
                    return
                yield from take(data)
        except DamageError as error:
            self._stop(error.position, error.what)
        except UnfitError as error:
            self._stop(position, RecordingError(f"'{self._path}' has {error}."))
        except ValueError:
            self._stop(position, "is damaged")
        except RecordingError as error:
            self._stop(position, error)

    def _stop(self, position: int, damage: RecordingError | str) -> None:
        if position < self._end:
            self._end, self._damage = position, damage

    def _take_events(self, data: bytes | memoryview) -> Iterator[NDArray[np.void]]:
        packet = unpack_events(data)
        for begin in range(0, len(packet), _PIECE):
            yield self._check_events(packet[begin : begin + _PIECE])

    def _check_events(self, given: NDArray[np.void]) -> NDArray[np.void]:
        """Returns our own records of some events: in the picture and ascending."""
        events = copy_events(given)
        is_outside, *stamps_us, before_us, after_us, last_us = kernels.check_events(
            events.view(np.int64), *self._size_px, self._last_us, TOLERATED_STEP_BACK_US
        )
        if is_outside:
            raise RecordingError(
                f"'{self._path}' has an event outside its {self._size_px[0]}×"
                f"{self._size_px[1]} pixels.",
                hint="The file is damaged or of another camera.",
            )
        for impossible in stamps_us:
            if not 0 <= impossible < MAX_STAMP_US:
                raise RecordingError(f"'{self._path}' has an impossible stamp ({impossible} µs).")
        self._check_order(before_us, after_us)
        self._require(self._event_rate.allows(len(events), last_us), "events")
        if self._first_us is None:
            self._first_us = int(events["t"][0])
        self._last_us = last_us
        return events

    def _take_frame(self, data: bytes | memoryview) -> Iterator[Frame]:
        frame = unpack_frame(data)
        end_us = frame.exposure_end_us
        self._check_order(self._frame_us, end_us)
        self._require(self._frame_rate.allows(1, end_us), "frames")
        self._frame_us = end_us
        yield frame

    def _check_order(self, before_us: int, t_us: int) -> None:
        if t_us < before_us - TOLERATED_STEP_BACK_US:
            raise RecordingError(
                f"{self._path}: the stamps go back from {before_us} to {t_us} µs.",
                hint="The camera's clock was reset while recording; cut the recording there.",
            )

    def _require(self, is_possible: bool, what: str) -> None:
        if not is_possible:
            raise RecordingError(
                f"'{self._path}' has more {what} in one moment than any camera gives.",
                hint="It is damaged, or made to harm.",
            )


class _Rate:
    """Limit of what can come in a moment: a leaky bucket that must not run over.

    Args:
        most: how much it holds.
        per_us: how much flows out in each µs.
    """

    def __init__(self, most: int, per_us: float) -> None:
        self._most = most
        self._per_us = per_us
        self._level = 0.0
        self._t_us = -MAX_STAMP_US

    def allows(self, n: int, t_us: int) -> bool:
        """Adds ``n`` items at ``t_us``; returns whether a camera can give so many."""
        gone_us = max(0, t_us - self._t_us)
        self._level = max(0.0, self._level - self._per_us * gone_us) + n
        self._t_us = max(self._t_us, t_us)
        return self._level <= self._most
