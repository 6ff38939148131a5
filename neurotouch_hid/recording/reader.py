"""Reads the events and frames of an AEDAT4 file in order of time, a batch at a time."""

import heapq
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.recording.container import check_recording, packet_sizes

Batch = tuple[NDArray[np.void], tuple[Frame, ...]]
"""Events ((n,) EVENT_DTYPE, ascending) and the frames whose exposure ended before the last one."""

MAX_LAG_US = 500_000
"""Largest distance of frames from their events in the file; beyond it, two passes read the file.
A camera delivers a frame some 20 ms after its exposure; half a second of events is 16 MB at most.
"""
TOLERATED_STEP_BACK_US = 10_000
"""Smaller steps back are rounding between packets; the events keep the later stamp."""
MAX_STAMP_US = 1 << 62
"""Stamps beyond this are damage: differences of smaller ones fit 64 bits."""
_RESOLUTION = (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX)

_Item = NDArray[np.void] | Frame


class Recording:
    """An AEDAT4 file by any writer; iterating reads it from the start, in bounded memory.

    A file that breaks off or is damaged yields everything up to there, then raises.

    Args:
        path: the file.

    Attributes:
        path: the file.
        has_frames: there is a stream of frames.

    Raises:
        RecordingError: not a readable AEDAT4 file of a DAVIS-346 with events.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        check_recording(self.path)
        decoder = self._open()
        with decoder:
            tracks = {track.data_type: track for track in reversed(decoder.tracks())}
            table = decoder.file_data_definitions()
        self.has_frames = "frame" in tracks
        if "events" not in tracks:
            raise RecordingError(
                f"'{self.path}' has no stream of events.",
                hint="Record with the events switched on.",
            )
        for kind in ("events", "frame"):
            if kind in tracks and tuple(tracks[kind].dimensions) != _RESOLUTION:
                width, height = tracks[kind].dimensions
                raise RecordingError(
                    f"'{self.path}' is {width}×{height}, not the 346×260 of a DAVIS-346.",
                    hint="Only recordings of a DAVIS-346 can be used.",
                )
        self._ids = {track.id: kind for kind, track in tracks.items()}
        self._apart = self._is_apart(table)

    def __iter__(self) -> Iterator[Batch]:
        items: Iterator[_Item]
        if self._apart:
            items = heapq.merge(self._read({"events"}), self._read({"frame"}), key=_end_us)
        else:
            items = _sort_nearby(self._read({"events", "frame"}))
        frames: list[Frame] = []
        n_events = 0
        for item in items:
            if isinstance(item, Frame):
                frames.append(item)
                continue
            yield item, tuple(frames)
            n_events += len(item)
            frames.clear()
        if not n_events:
            raise RecordingError(
                f"'{self.path}' has no events.", hint="Check the camera's cable and event output."
            )
        if frames:
            yield np.empty(0, EVENT_DTYPE), tuple(frames)

    def _open(self) -> Any:
        # Imported here: it takes 0.15 s, and only recordings need it.
        from faery.extension import aedat  # noqa: PLC0415

        try:
            return aedat.Decoder(self.path)
        except RuntimeError as error:
            raise RecordingError(
                f"'{self.path}' is cut off or damaged ({error}).",
                hint="Copy it again from its origin.",
            ) from error

    def _is_apart(self, table: list[Any]) -> bool:
        """Returns True if the table has an entry later in the file than the reader would wait for.

        Raises:
            RecordingError: the table shows that the stamps of a stream go back.
        """
        apart = False
        newest = dict.fromkeys(self._ids, -MAX_STAMP_US)
        for entry in table:
            if self._ids.get(entry.track_id) in {"events", "frame"} and entry.end_t:
                self._check_order(newest[entry.track_id], entry.start_t)
                apart = apart or entry.end_t < max(newest.values()) - MAX_LAG_US
                newest[entry.track_id] = max(newest[entry.track_id], entry.end_t)
        return apart

    def _check_order(self, before_us: int, t_us: int) -> None:
        if t_us < before_us - TOLERATED_STEP_BACK_US:
            raise RecordingError(
                f"{self.path}: the stamps go back from {before_us} to {t_us} µs.",
                hint="The camera's clock was reset while recording; cut the recording there.",
            )

    def _read(self, kinds: set[str]) -> Iterator[_Item]:
        """Gives the items of these kinds in the order of the file, checked."""
        guard = packet_sizes(self.path)
        next(guard)
        first_us: int | None = None
        last_us = frame_us = -MAX_STAMP_US
        with self._open() as decoder:
            while True:
                next(guard, None)
                try:
                    track, packet = next(decoder)
                except StopIteration:
                    return
                except RuntimeError as error:
                    raise self._broken(error, first_us, last_us) from error
                kind = self._ids.get(track.id)
                if kind not in kinds:
                    continue
                if kind == "frame":
                    frame = self._frame(packet)
                    self._check_order(frame_us, frame.exposure_end_us)
                    frame_us = frame.exposure_end_us
                    yield frame
                elif len(packet):
                    events = self._events(packet)
                    first_us = int(events["t"][0]) if first_us is None else first_us
                    last_us = int(events["t"][-1])
                    yield events

    def _broken(self, error: RuntimeError, first_us: int | None, last_us: int) -> RecordingError:
        if "overflow" in str(error):
            return RecordingError(
                f"'{self.path}' has an event outside the 346×260 pixels of a DAVIS-346.",
                hint="The file is damaged or of another camera.",
            )
        what = "is cut off" if "fill whole buffer" in str(error) else "is damaged"
        where = (
            "before its first event"
            if first_us is None
            else f"{(last_us - first_us) / 1e6:.3f} s after its first event"
        )
        return RecordingError(
            f"'{self.path}' {what} {where}.", hint="Copy it again from its origin."
        )

    def _events(self, packet: NDArray[np.void]) -> NDArray[np.void]:
        """Returns our records of the library's events, checked to be in the picture and ascending.

        The library refuses events outside the picture and lifts a stamp before its predecessor's
        to that one, so only the table and the frames can show wrong stamps.
        """
        events = np.zeros(len(packet), EVENT_DTYPE)
        t = events["t"]
        t[:] = packet["t"].view(np.int64)
        events["x"] = packet["x"]
        events["y"] = packet["y"]
        events["p"] = packet["on"].view(np.uint8) != 0
        if int(t[-1]) >= MAX_STAMP_US:
            raise RecordingError(f"'{self.path}' has an impossible stamp ({int(t[-1])} µs).")
        return events

    def _frame(self, packet: Any) -> Frame:
        try:
            pixels = packet.pixels
        except ValueError as error:  # fewer bytes than width × height
            raise RecordingError(f"'{self.path}' has a damaged frame ({error}).") from error
        if pixels.dtype != np.uint8 or pixels.shape[:2] != _RESOLUTION[::-1]:
            size = "×".join(str(n) for n in pixels.shape[1::-1])
            raise RecordingError(
                f"'{self.path}' has a frame of {size} pixels ({pixels.dtype}), "
                "not 346×260 of 8 bit."
            )
        if pixels.ndim == 3:  # a colour camera: the gel is black and white
            pixels = pixels[..., :3].mean(axis=2).astype(np.uint8)
        begin, end = (_signed(t) for t in (packet.exposure_start_t, packet.exposure_end_t))
        if begin == 0 and end == 0:
            begin = end = _signed(packet.t)
        if max(abs(begin), abs(end)) > MAX_STAMP_US:
            raise RecordingError(
                f"'{self.path}' has a frame with an impossible stamp ({begin} µs)."
            )
        return Frame(np.array(pixels), begin, max(begin, end))


def _signed(stamp: int) -> int:
    return stamp - (1 << 64) if stamp >= 1 << 63 else stamp


def _end_us(item: _Item) -> int:
    return item.exposure_end_us if isinstance(item, Frame) else int(item["t"][-1])


def _sort_nearby(items: Iterator[_Item]) -> Iterator[_Item]:
    """Yields items in order of their end, if each is within ``MAX_LAG_US`` of its place."""
    heap: list[tuple[int, int, _Item]] = []
    newest = -MAX_STAMP_US
    broken: RecordingError | None = None
    try:
        for n, item in enumerate(items):
            end = _end_us(item)
            newest = max(newest, end)
            heapq.heappush(heap, (end, n, item))
            while heap[0][0] <= newest - MAX_LAG_US:
                yield heapq.heappop(heap)[2]
    except RecordingError as error:  # data read before the break is still good
        broken = error
    while heap:
        yield heapq.heappop(heap)[2]
    if broken is not None:
        raise broken
