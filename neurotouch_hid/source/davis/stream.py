"""Streams from one camera, from its start until it fails or the source is closed."""

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Final

from neurotouch_hid.errors import CameraError
from neurotouch_hid.events import join_events
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source.camera_errors import CameraGoneError
from neurotouch_hid.source.davis.camera import Camera
from neurotouch_hid.source.davis.config import DavisConfig
from neurotouch_hid.source.davis.decoder import Decoder, DecoderStats
from neurotouch_hid.source.davis.stream_check import StreamCheck
from neurotouch_hid.source.davis.transport import ANY_TIME, LOOK_US, StreamHaltedError
from neurotouch_hid.source.partial import SHORTEST_US
from neurotouch_hid.source.sensor_map import make_middle_map
from neurotouch_hid.source.slice_pacer import Calm
from neurotouch_hid.source.slicer import Slicer

PUMP_S: Final = 0.05
"""The longest time until the end of the stream is noticed."""
PARTIAL_US: Final = 600
"""Time before the end of a slice at which its partial slice is due. It is enough to read the
waiting data, in 0.4 ms at 5 million events/s, even if the thread wakes late."""
MAX_PARTIAL_EVENTS: Final = 8_000
"""Largest number of events in a partial slice: at 4 ms, 2 million events/s. Copying more would
delay the slice by as much as the pipeline gains."""
MOST_REST_US: Final = 4_000
"""At 70 MB/s, 12 million events/s, this fills a fourth of the transfers."""
IDLE_FRAME_S: Final = 0.25
"""How often an idle camera is asked for a frame: an idle pipeline uses each of them."""
COUNT_S: Final = 1.0
"""Interval at which the camera's count of dropped events is read."""
SILENCE_S: Final = 2.0
"""A camera sends a time word at least every 33 ms: one that is silent this long has failed."""
FAULTS_S: Final = 5.0
MAX_STALLS: Final = 3
"""With this many within FAULTS_S, the camera has failed."""
MAX_FAULTS: Final = 200
"""The same for failed transfers: more than all that are in flight."""


class Stream:
    """Starts a camera that has been set up, reads it, and hands over its slices.

    Args:
        camera: the camera.
        config: how it was set up.
        slice_us: length of a slice.
        put: takes the slices or their parts, and a partial slice shortly before the end of each
            whole one; returns the length of the parts in which the next ones come, or None.
        find_calm: returns what is expected if nothing happens and a few frames a second are enough;
            else None.
        before: the stream that this one continues, later by the time between them.

    Attributes:
        end_us: end of the last slice.
        heard_s: when data last came, ``time.monotonic``.
        n_faults: transfers that failed so far, also in the streams before.
        n_dropped: events that the camera dropped so far, likewise.

    Raises:
        CameraError: the camera does not start.
    """

    def __init__(
        self,
        camera: Camera,
        config: DavisConfig,
        slice_us: int,
        put: Callable[[EventPacket], int | None],
        find_calm: Callable[[], Calm | None],
        before: "Stream | None" = None,
    ) -> None:
        self._camera, self._config, self._slice_us = camera, config, slice_us
        self._put, self._find_calm = put, find_calm
        self._chunks: list[bytes] = []
        camera.start(config, self._chunks.append)
        self._begun_s = self.heard_s = time.monotonic()
        self.end_us = self.n_faults = self.n_dropped = self._gap = 0
        if before is not None:
            away_us = int(1e6 * (self.heard_s - before.heard_s))
            slices_away = -(-before.end_us // slice_us) + away_us // slice_us + 1
            self.end_us = slices_away * slice_us
            self.n_faults, self.n_dropped = before.n_faults, before.n_dropped
            self._gap = 1  # at least
        layout = camera.layout._replace(mirrored=config.mirrored)
        self._decoder = Decoder(layout, origin_us=self.end_us, is_colour=camera.is_colour)
        self._map = make_middle_map(layout.width_px, layout.height_px, self.end_us)
        self._slicer = Slicer(slice_us, self.end_us)
        self._stream_check = StreamCheck(self.end_us, self._begun_s)
        self._is_idle = False
        self._paced_s = self._retry_s = 0.0
        self._stats = self._decoder.stats()
        self._n_impossible = 0
        self._partial_us = -1
        self._faults_s: deque[float] = deque(maxlen=MAX_FAULTS)
        self._stalls_s: deque[float] = deque(maxlen=MAX_STALLS)

    def stats(self) -> DecoderStats:
        """Returns counts of malformed data so far."""
        return self._decoder.stats()

    def run(self, closing: threading.Event) -> None:
        """Plays until ``closing``.

        Raises:
            CameraError: the camera is gone, or has failed, or its stream is out of step.
        """
        asked_s = rest_until_s = self._begun_s
        time_word, most_noise = ANY_TIME, 0
        while not closing.is_set():
            looked_s, end_us = time.monotonic(), self.end_us
            try:
                self._pump(rest_until_s, time_word, most_noise)
            finally:  # data from before the failure is good
                now_s = time.monotonic()
                self._read(now_s)
            if self._decoder.now_us >= self._find_due():  # whole slices are on their way
                self._deliver_partial()
            self._check(looked_s)
            if self.end_us > end_us:  # a slice: its last word has just come
                self._pace_camera(now_s)
            has_woken = most_noise > 0 and now_s < rest_until_s
            rest_us, time_word, most_noise = self._find_need(has_woken=has_woken)
            rest_until_s = now_s + 1e-6 * rest_us
            if now_s - asked_s >= COUNT_S:
                asked_s = now_s
                self._count_dropped()

    def _count_dropped(self) -> None:
        """Reads the camera's count; a camera that sends but does not answer is asked later."""
        try:
            dropped = self._camera.count_dropped()
        except CameraGoneError:
            raise
        except CameraError:
            return
        self.n_dropped += dropped
        self._gap += dropped

    def _pace_camera(self, now_s: float) -> None:
        """Sets the camera idle while nothing happens, and ends idling at the first activity.

        A camera that does not answer but still sends is asked again later.
        """
        may_idle = self._find_calm() is not None
        is_due = may_idle and self._config.frames and now_s - self._paced_s >= IDLE_FRAME_S
        if now_s < self._retry_s or (may_idle == self._is_idle and not is_due):
            return
        try:
            if may_idle == self._is_idle:
                self._camera.request_frame()
            elif may_idle:
                self._camera.enter_idle(self._config)
            else:
                self._camera.leave_idle(self._config)
        except CameraGoneError:
            raise
        except CameraError:
            self._retry_s = now_s + IDLE_FRAME_S
            return
        self._is_idle, self._paced_s = may_idle, now_s

    def _find_need(self, *, has_woken: bool) -> tuple[int, int, int]:
        """Returns how long after the last word no data is needed, and up to which time then.

        Reading each transfer as it comes would take half as much processor time again. While
        nothing happens, slices are joined, so Python need not come for each of them.

        Args:
            has_woken: more than noise has ended the last rest, so the slice is needed at its end.

        Returns:
            The time of rest in µs; the time word; and how many events in ``LOOK_US`` may be noise,
            0 if the rest does not end before.
        """
        calm = self._find_calm() if self._is_idle and not has_woken else None
        if calm is not None:
            rest_us = calm.until_us + self._slice_us - self._decoder.now_us
            return rest_us, ANY_TIME, round(calm.n_events * LOOK_US / self._slice_us)
        due_us = self._find_due()
        rest_us = due_us - self._decoder.now_us
        if rest_us > MOST_REST_US:
            return MOST_REST_US, ANY_TIME, 0
        return rest_us, self._decoder.find_word(due_us), 0

    def _find_due(self) -> int:
        """Returns when the next slice is due, or the partial slice before it."""
        due_us = self._slicer.find_end()
        has_partial = self._partial_us != self.end_us and due_us - self.end_us >= SHORTEST_US
        return due_us - PARTIAL_US if has_partial else due_us

    def _pump(self, rest_until_s: float, time_word: int, most_noise: int) -> None:
        try:
            self._camera.transport.pump(PUMP_S, rest_until_s, time_word, most_noise)
        except StreamHaltedError:
            self._stalls_s.append(time.monotonic())
            if _are_many(self._stalls_s):
                raise
            self._camera.transport.queue(self._chunks.append)

    def _read(self, now_s: float) -> None:
        """Decodes the data that has arrived; an empty chunk marks missing data."""
        while self._chunks:
            n = self._chunks.index(b"") if b"" in self._chunks else len(self._chunks)
            if n:
                self.heard_s = now_s
                self._decode(b"".join(self._chunks[:n]), now_s)
            if n < len(self._chunks):
                self._decoder.forget()
                self._gap += 1
                self.n_faults += 1
                self._faults_s.append(now_s)
            del self._chunks[: n + 1]

    def _decode(self, data: bytes, now_s: float) -> None:
        events, frames = self._decoder.decode(data)
        if self._map is not None:
            events = join_events(self._map.map_events(events))
            frames = self._map.map_frames(frames)
        stats, now_us = self._decoder.stats(), self._decoder.now_us
        if stats is not self._stats:
            self._gap += stats.n_lost - self._stats.n_lost
            self._stats, self._n_impossible = stats, stats.n_impossible
        self._stream_check.check(len(data) // 2, self._n_impossible, now_us, now_s)
        for packet in self._slicer.push(events, frames):
            self._deliver(packet)
        for packet in self._slicer.reach(now_us):
            self._deliver(packet)

    def _deliver(self, packet: EventPacket) -> None:
        self.end_us = packet.t_end_us
        self._slicer.part_us = self._put(replace(packet, gap=self._gap) if self._gap else packet)
        self._gap = 0

    def _deliver_partial(self) -> None:
        """Delivers the partial slice of the next slice, once for each."""
        self._partial_us = self.end_us
        partial = self._slicer.partial(self._decoder.now_us, MAX_PARTIAL_EVENTS)
        if partial is not None:
            self._put(replace(partial, gap=self._gap))

    def _check(self, looked_s: float) -> None:
        """Ends a run that has failed.

        The camera counts as silent only if a read that began late enough found nothing: on a busy
        machine, time also passes between two reads.

        Args:
            looked_s: when the last read began.
        """
        if looked_s - self.heard_s > SILENCE_S:
            raise CameraError("The camera sends nothing.")
        if not self._decoder.is_synced and looked_s - self._begun_s > SILENCE_S:
            raise CameraError("The camera does not set its clock.")
        if self._faults_s and _are_many(self._faults_s):
            raise CameraError("The camera's USB link fails again and again.")


def _are_many(times_s: deque[float]) -> bool:
    """Returns True if the list is full and spans at most FAULTS_S."""
    return len(times_s) == times_s.maxlen and times_s[-1] - times_s[0] < FAULTS_S
