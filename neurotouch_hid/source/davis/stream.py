"""One run of a camera: from its start until it fails or nobody wants it any more."""

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Final

from neurotouch_hid.errors import CameraError
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source.davis.camera import Camera
from neurotouch_hid.source.davis.config import DavisConfig
from neurotouch_hid.source.davis.decoder import Decoder, DecoderStats
from neurotouch_hid.source.davis.transport import CameraGoneError, StreamHaltedError
from neurotouch_hid.source.partial import SHORTEST_US
from neurotouch_hid.source.slicer import Slicer

PUMP_S: Final = 0.05
"""The end is noticed within this time."""
AWAKE_US: Final = 600
"""So long before a slice ends data is read as it comes; what comes before waits till then, since to
wake up for each transfer takes half as much processor time again. In this time what has waited is
read, in 0.4 ms at 5 million events/s, and a thread that is woken late is there."""
MOST_HEAD: Final = 8_000
"""Events of a slice that are handed over before its end, at 4 ms 2 million a second. To copy more
makes the slice as much later as the line is quicker with it."""
MOST_REST_US: Final = 4_000
"""At 70 MB/s, 12 million events/s, this fills a fourth of the transfers."""
CALM_REST_US: Final = 8_000
"""The same while nothing happens: this saves a third of its work, and the first motion is seen
4 ms later on average. At 12 million events/s it fills half of the transfers."""
SNAP_S: Final = 0.25
"""How often a camera that rests is asked for a frame: so seldom that an idle pipeline uses each."""
COUNT_S: Final = 1.0
"""How often the camera is asked how much it has dropped."""
SILENCE_S: Final = 2.0
"""A camera sends a time word at least every 33 ms: one that is silent for so long has failed."""
FAULTS_S: Final = 5.0
MAX_STALLS: Final = 3
"""So many within FAULTS_S, and the camera has failed."""
MAX_FAULTS: Final = 200
"""The same for transfers that fail: more than all that are under way."""


class Stream:
    """Starts a camera that has been set up, reads it, and hands over its slices.

    Args:
        camera: the camera.
        config: how it was set up.
        slice_us: length of a slice.
        put: takes the slices, and the head of each shortly before its end.
        may_rest: whether nothing happens just now, and a few frames a second will do.
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
        put: Callable[[EventPacket], object],
        may_rest: Callable[[], bool],
        before: "Stream | None" = None,
    ) -> None:
        self._camera, self._config, self._slice_us = camera, config, slice_us
        self._put, self._may_rest = put, may_rest
        self._chunks: list[bytes] = []
        camera.start(config, self._chunks.append)
        self._begun_s = self.heard_s = time.monotonic()
        self.end_us = self.n_faults = self.n_dropped = self._gap = 0
        if before is not None:
            away_us = int(1e6 * (self.heard_s - before.heard_s))
            self.end_us = before.end_us + (away_us // slice_us + 1) * slice_us
            self.n_faults, self.n_dropped = before.n_faults, before.n_dropped
            self._gap = 1  # at least
        layout = replace(camera.layout, mirrored=config.mirrored)
        self._decoder = Decoder(layout, origin_us=self.end_us)
        self._slicer = Slicer(slice_us, self.end_us)
        self._rests = False
        self._paced_s = self._deaf_until_s = 0.0
        self._n_resets = 0
        self._head_us = -1
        self._faults_s: deque[float] = deque(maxlen=MAX_FAULTS)
        self._stalls_s: deque[float] = deque(maxlen=MAX_STALLS)

    def stats(self) -> DecoderStats:
        """What was malformed so far."""
        return self._decoder.stats()

    def run(self, closing: threading.Event) -> None:
        """Plays until ``closing``.

        Raises:
            CameraError: the camera is gone, or has failed.
        """
        asked_s = rest_until_s = self._begun_s
        while not closing.is_set():
            looked_s, end_us = time.monotonic(), self.end_us
            try:
                self._pump(rest_until_s)
            finally:  # what came before it failed is good
                now_s = time.monotonic()
                self._read(now_s)
            self._deliver_head()
            self._check(looked_s)
            if self.end_us > end_us:  # a slice: its last word has just come
                self._pace_camera(now_s)
                rest_until_s = now_s + self._find_rest_s()
            if now_s - asked_s >= COUNT_S:
                asked_s = now_s
                self._count_dropped()

    def _count_dropped(self) -> None:
        """Asks the camera; one that does not answer but goes on sending is asked later again."""
        try:
            dropped = self._camera.count_dropped()
        except CameraGoneError:
            raise
        except CameraError:
            return
        self.n_dropped += dropped
        self._gap += dropped

    def _pace_camera(self, now_s: float) -> None:
        """Lets the camera rest while nothing happens, and wakes it as soon as something does.

        One that does not answer but goes on sending is asked later again.
        """
        may_rest = self._may_rest()
        is_due = may_rest and self._config.frames and now_s - self._paced_s >= SNAP_S
        if now_s < self._deaf_until_s or (may_rest == self._rests and not is_due):
            return
        try:
            if may_rest == self._rests:
                self._camera.snap()
            elif may_rest:
                self._camera.rest(self._config)
            else:
                self._camera.wake(self._config)
        except CameraGoneError:
            raise
        except CameraError:
            self._deaf_until_s = now_s + SNAP_S
            return
        self._rests, self._paced_s = may_rest, now_s

    def _find_rest_s(self) -> float:
        """How long after the last word nothing is needed."""
        if self._rests:
            return 1e-6 * CALM_REST_US
        left_us = self.end_us + self._slice_us - self._decoder.now_us
        return 1e-6 * min(left_us - AWAKE_US, MOST_REST_US)

    def _pump(self, rest_until_s: float) -> None:
        try:
            self._camera.transport.pump(PUMP_S, rest_until_s)
        except StreamHaltedError:
            self._stalls_s.append(time.monotonic())
            if _are_many(self._stalls_s):
                raise
            self._camera.transport.queue(self._chunks.append)

    def _read(self, now_s: float) -> None:
        """Decodes what has come; an empty chunk stands where something is missing."""
        while self._chunks:
            n = self._chunks.index(b"") if b"" in self._chunks else len(self._chunks)
            if n:
                self.heard_s = now_s
                self._decode(b"".join(self._chunks[:n]))
            if n < len(self._chunks):
                self._decoder.forget()
                self._gap += 1
                self.n_faults += 1
                self._faults_s.append(now_s)
            del self._chunks[: n + 1]

    def _decode(self, data: bytes) -> None:
        events, frames = self._decoder.decode(data)
        n_resets = self._decoder.n_resets
        self._gap += n_resets - self._n_resets
        self._n_resets = n_resets
        for packet in self._slicer.push(events, frames):
            self._deliver(packet)
        for packet in self._slicer.reach(self._decoder.now_us):
            self._deliver(packet)

    def _deliver(self, packet: EventPacket) -> None:
        self.end_us = packet.t_end_us
        self._put(replace(packet, gap=self._gap) if self._gap else packet)
        self._gap = 0

    def _deliver_head(self) -> None:
        """Once for each slice, as soon as this is awake for its end."""
        now_us = self._decoder.now_us
        if (
            self._head_us == self.end_us
            or now_us < self.end_us + self._slice_us - AWAKE_US
            or self._slice_us < SHORTEST_US
        ):
            return
        head = self._slicer.head(now_us, MOST_HEAD)
        if head is not None:
            self._head_us = self.end_us
            self._put(replace(head, gap=self._gap))

    def _check(self, looked_s: float) -> None:
        """Ends a run that has failed.

        The camera is silent if a look that began so late finds nothing; on a busy machine time
        may also pass in which nobody looked.

        Args:
            looked_s: when the last look for data began.
        """
        if looked_s - self.heard_s > SILENCE_S:
            raise CameraError("The camera sends nothing.")
        if not self._decoder.is_synced and looked_s - self._begun_s > SILENCE_S:
            raise CameraError("The camera does not set its clock.")
        if _are_many(self._faults_s):
            raise CameraError("The camera's USB link fails again and again.")


def _are_many(times_s: deque[float]) -> bool:
    """True if as many as are kept happened within FAULTS_S."""
    return len(times_s) == times_s.maxlen and times_s[-1] - times_s[0] < FAULTS_S
