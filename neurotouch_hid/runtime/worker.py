"""What frames show, found beside the line: frames in and answers out, and the line never waits."""

import threading
from collections import deque
from typing import NamedTuple, Protocol

from neurotouch_hid.messages import EventPacket, Frame, RestField
from neurotouch_hid.tracker import BlobFinder, Blobs, RestDetector

WATCHED_PACKETS = 64  # with events, that wait until the gel is found; 0.6 s of them


class FrameResult(NamedTuple):
    """What was seen of the gel.

    Attributes:
        rest: where all markers are, if the gel is at rest.
        searched: a frame by which the tracker is yet to be corrected, and its blobs, which nobody
            else has; None if events showed the gel, or if the tracker looks at frames itself.
    """

    rest: RestField | None
    searched: tuple[Frame, Blobs] | None = None


class FrameExchange(Protocol):
    """Where the line hands over frames and takes the newest answer."""

    detector: RestDetector

    def exchange(self, packet: EventPacket) -> FrameResult | None:
        """Hands over the frames of ``packet``; returns the newest answer not yet taken, or None."""

    def close(self) -> None:
        """Stops working."""


class InlineRest:
    """Detects rest in the line itself: the same packets give the same answers, always."""

    def __init__(self, detector: RestDetector) -> None:
        self.detector = detector

    def exchange(self, packet: EventPacket) -> FrameResult | None:
        """Looks at every frame of ``packet`` and returns the answer to the newest one.

        Before the first frame, the events are looked at: a recording may have no frames at all.
        """
        rest = None if packet.frames else self.detector.watch(packet)
        for frame in packet.frames:
            rest = self.detector.update(frame)
        return None if rest is None else FrameResult(rest)

    def close(self) -> None:
        """Nothing to stop."""


class ThreadedRest:
    """Looks at frames in a thread. Both mailboxes hold one letter, the newest wins, nobody waits.

    A queue is a deque of length one: ``append`` and ``pop`` are atomic, the line takes no lock.
    Before the first frame, packets queue up for the thread, which adds up their events.

    Args:
        detector: says of every frame whether the gel is at rest.
        finder: the one that ``detector`` uses; nobody else does.
    """

    def __init__(self, detector: RestDetector, finder: BlobFinder) -> None:
        self.detector = detector
        self._finder = finder
        self._frames: deque[Frame] = deque(maxlen=1)
        self._sights: deque[FrameResult] = deque(maxlen=1)
        self._packets: deque[EventPacket] = deque(maxlen=WATCHED_PACKETS)
        self._wake = threading.Event()
        self._stopped = False
        self._thread = threading.Thread(target=self._work, name="rest", daemon=True)
        self._thread.start()

    def exchange(self, packet: EventPacket) -> FrameResult | None:
        """Takes the answer that is ready, if any, and posts the newest frame of ``packet``.

        In this order, so that no answer is to the very frame that is handed over with it.
        """
        sight = self._sights.pop() if self._sights else None
        if packet.frames:
            self._frames.append(packet.frames[-1])
            self._wake.set()
        elif self.detector.is_watching:
            self._packets.append(packet)
            self._wake.set()
        return sight

    def close(self) -> None:
        """Ends the thread."""
        self._stopped = True
        self._wake.set()
        self._thread.join()

    def _work(self) -> None:
        while True:
            self._wake.wait()
            self._wake.clear()
            if self._stopped:
                return
            if self._frames:
                self._packets.clear()
                frame = self._frames.pop()
                rest = self.detector.update(frame)
                blobs = self._finder.find(frame.pixels).copy()  # the next search overwrites them
                self._sights.append(FrameResult(rest, (frame, blobs)))
            while self._packets:
                rest = self.detector.watch(self._packets.popleft())
                if rest is not None:
                    self._sights.append(FrameResult(rest))
