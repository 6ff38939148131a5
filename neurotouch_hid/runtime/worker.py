"""Processes frames beside the pipeline: frames in, results out; the pipeline never waits."""

import threading
from collections import deque
from typing import NamedTuple, Protocol

from neurotouch_hid.messages import EventPacket, Frame, RestField
from neurotouch_hid.tracker import BlobFinder, Blobs, RestDetector

WATCHED_PACKETS = 64  # with events, that wait until the gel is found; 64 ms of them or more


class FrameResult(NamedTuple):
    """The result of a frame.

    Attributes:
        rest: the places of all markers, if the gel is at rest.
        searched: a frame that still has to correct the tracker, and its blobs; None if the
            tracker processes the frames of the camera itself.
    """

    rest: RestField | None
    searched: tuple[Frame, Blobs] | None = None


class FrameExchange(Protocol):
    """Takes frames from the pipeline and gives it the newest result."""

    detector: RestDetector

    def exchange(self, packet: EventPacket) -> FrameResult | None:
        """Hands over the frames of ``packet``; returns the newest result not yet taken, or None."""

    def close(self) -> None:
        """Stops; repeating is harmless."""


class InlineRest:
    """Detects rest in the pipeline itself: the same packets always give the same results."""

    def __init__(self, detector: RestDetector) -> None:
        self.detector = detector

    def exchange(self, packet: EventPacket) -> FrameResult | None:
        """Processes every frame of ``packet`` and returns the result of the newest one.

        Before the first frame it draws frames from events: a recording may have no frames at all.
        """
        if not packet.frames:
            drawn = self.detector.watch(packet)
            return None if drawn is None else FrameResult(drawn.rest, (drawn.frame, drawn.blobs))
        rest = None
        for frame in packet.frames:
            rest = self.detector.update(frame)
        return None if rest is None else FrameResult(rest)

    def close(self) -> None:
        """Does nothing: there is nothing to stop."""


class ThreadedRest:
    """Processes frames in a thread.

    Both directions keep one item; the newest wins, and neither side waits. Each direction is a
    deque of length one: ``append`` and ``pop`` are atomic, so the pipeline
    needs no lock. Before the first frame, packets queue up for the thread, which sums their events.

    Args:
        detector: decides for every frame whether the gel is at rest.
        finder: the blob finder of ``detector``; nobody else may use it.
    """

    def __init__(self, detector: RestDetector, finder: BlobFinder) -> None:
        self.detector = detector
        self._finder = finder
        self._frames: deque[Frame] = deque(maxlen=1)
        self._results: deque[FrameResult] = deque(maxlen=1)
        self._packets: deque[EventPacket] = deque(maxlen=WATCHED_PACKETS)
        self._wake = threading.Event()
        self._stopped = False
        self._thread = threading.Thread(target=self._work, name="rest", daemon=True)
        self._thread.start()

    def exchange(self, packet: EventPacket) -> FrameResult | None:
        """Takes the result that is ready, if any, and hands over the newest frame of ``packet``.

        In this order, so that no result belongs to the frame that is handed over in the same call.
        """
        result = self._results.pop() if self._results else None
        if packet.frames:
            self._frames.append(packet.frames[-1])
            self._wake.set()
        elif self.detector.is_watching:
            self._packets.append(packet)
            self._wake.set()
        return result

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
                self._results.append(FrameResult(rest, (frame, blobs)))
            while self._packets:
                drawn = self.detector.watch(self._packets.popleft())
                if drawn is not None:
                    searched = (drawn.frame, drawn.blobs.copy())
                    self._results.append(FrameResult(drawn.rest, searched))
