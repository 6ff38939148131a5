"""Rest detection beside the line: frames in and answers out, without the line ever waiting."""

import threading
from collections import deque
from typing import Protocol

from neurotouch_hid.messages import EventPacket, Frame, RestField
from neurotouch_hid.tracker import RestDetector

WATCHED_PACKETS = 64  # with events, that wait until the gel is found; 0.6 s of them


class RestExchange(Protocol):
    """Where the line hands over frames and takes the newest answer."""

    detector: RestDetector

    def exchange(self, packet: EventPacket) -> RestField | None:
        """Hands over the frames of ``packet``; returns the newest answer not yet taken, or None."""

    def close(self) -> None:
        """Stops working."""


class InlineRest:
    """Detects rest in the line itself: the same packets give the same answers, always."""

    def __init__(self, detector: RestDetector) -> None:
        self.detector = detector

    def exchange(self, packet: EventPacket) -> RestField | None:
        """Looks at every frame of ``packet`` and returns the answer to the newest one.

        Before the first frame, the events are looked at: a recording may have no frames at all.
        """
        answer = None if packet.frames else self.detector.watch(packet)
        for frame in packet.frames:
            answer = self.detector.update(frame)
        return answer

    def close(self) -> None:
        """Nothing to stop."""


class ThreadedRest:
    """Detects rest in a thread. Both mailboxes hold one letter, the newest wins, nobody waits.

    A mailbox is a deque of length one: ``append`` and ``pop`` are atomic, the line takes no lock.
    Before the first frame, packets queue up for the thread, which adds up their events.
    """

    def __init__(self, detector: RestDetector) -> None:
        self.detector = detector
        self._frames: deque[Frame] = deque(maxlen=1)
        self._answers: deque[RestField] = deque(maxlen=1)
        self._packets: deque[EventPacket] = deque(maxlen=WATCHED_PACKETS)
        self._wake = threading.Event()
        self._stopped = False
        self._thread = threading.Thread(target=self._work, name="rest", daemon=True)
        self._thread.start()

    def exchange(self, packet: EventPacket) -> RestField | None:
        """Posts the newest frame of ``packet`` and takes the answer that is ready, if any."""
        if packet.frames:
            self._frames.append(packet.frames[-1])
            self._wake.set()
        elif self.detector.is_watching:
            self._packets.append(packet)
            self._wake.set()
        return self._answers.pop() if self._answers else None

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
                self._answer(self.detector.update(self._frames.pop()))
            while self._packets:
                self._answer(self.detector.watch(self._packets.popleft()))

    def _answer(self, rest: RestField | None) -> None:
        if rest is not None:
            self._answers.append(rest)
