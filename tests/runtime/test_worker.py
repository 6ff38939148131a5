"""Rest detection beside the line: same answers as in the line, and nobody waits."""

import threading

import numpy as np

from neurotouch_hid.messages import EventPacket, Frame, GelProblem, RestField
from neurotouch_hid.runtime.worker import InlineRest, ThreadedRest
from neurotouch_hid.tracker import BlobFinder, RestDetector
from tests.waiting import wait_until


class SlowDetector(RestDetector):
    """Looks at each frame only when it may go on; answers with the frame's moment."""

    def __init__(self, finder: BlobFinder) -> None:
        super().__init__(finder=finder)
        self.go = threading.Semaphore(0)
        self.seen: list[int] = []

    def update(self, frame: Frame) -> RestField | None:
        self.go.acquire()
        self.seen.append(frame.t_us)
        answer = super().update(frame)
        return None if answer is None else RestField(frame.t_us, answer.position_px)


def look_beside() -> ThreadedRest:
    finder = BlobFinder()
    return ThreadedRest(RestDetector(finder=finder), finder)


def empty(packet: EventPacket) -> EventPacket:
    return EventPacket(packet.t_begin_us, packet.t_end_us, packet.events[:0])


def test_thread_answers_as_the_line_does(push):
    inline, beside = InlineRest(RestDetector()), look_beside()
    framed = [packet for packet in push.packets if packet.frames]
    try:
        for packet in framed[:10]:
            expected = inline.exchange(packet)
            answer = beside.exchange(packet)
            assert answer is None
            wait_until(lambda: beside._results)
            answer = beside.exchange(empty(packet))
            assert answer is not None
            assert answer.rest.t_us == expected.rest.t_us
            assert (answer.rest.position_px == expected.rest.position_px).all()
            frame, found = answer.searched
            assert frame is packet.frames[-1]
            blobs = BlobFinder().find(frame.pixels)
            for name in ("centroid_px", "begin", "members"):
                assert np.array_equal(getattr(found, name), getattr(blobs, name))
    finally:
        beside.close()


def test_line_never_waits_and_the_newest_frame_wins(push):
    finder = BlobFinder()
    detector = SlowDetector(finder)
    beside = ThreadedRest(detector, finder)
    framed = [packet for packet in push.packets if packet.frames][:5]
    try:
        beside.exchange(framed[0])
        wait_until(lambda: not beside._frames)  # the thread has taken it and hangs on it
        for packet in framed[1:]:
            assert beside.exchange(packet) is None  # returns although the detector hangs
        detector.go.release(2)
        wait_until(lambda: len(detector.seen) == 2)
        assert detector.seen == [framed[0].frames[-1].t_us, framed[-1].frames[-1].t_us]
        wait_until(lambda: beside._results)
        assert beside.exchange(empty(framed[-1])) is not None
        assert beside.exchange(empty(framed[-1])) is None  # taken once
    finally:
        detector.go.release(10)
        beside.close()


def test_an_answer_never_comes_with_the_frame_that_it_is_to(push, monkeypatch):
    beside = look_beside()
    packet = next(packet for packet in push.packets if packet.frames)
    wake = beside._wake.set

    def wake_and_lose_the_core() -> None:
        wake()
        wait_until(lambda: beside._results)

    try:
        monkeypatch.setattr(beside._wake, "set", wake_and_lose_the_core)
        assert beside.exchange(packet) is None
        monkeypatch.undo()
        assert beside.exchange(empty(packet)) is not None
    finally:
        beside.close()


def test_thread_draws_the_gel_from_events_alone(push):
    frameless = [EventPacket(p.t_begin_us, p.t_end_us, p.events) for p in push.packets]
    inline, beside = InlineRest(RestDetector()), look_beside()
    try:
        for packet in frameless:
            expected = inline.exchange(packet)
            searched = None if expected is None else expected.searched[1].copy()
            beside.exchange(packet)
            wait_until(
                lambda: not beside._packets
            )  # as slow as a camera; a fast one loses the rest
            if expected is None:
                continue
            wait_until(lambda: beside._results)
            answer = beside._results.pop()
            assert (answer.searched[0].pixels == expected.searched[0].pixels).all()
            assert (answer.searched[1].centroid_px == searched.centroid_px).all()
            assert (answer.rest is None) == (expected.rest is None)
        assert beside.detector.gel.problem is GelProblem.EVENTS_ONLY
        assert inline.detector.gel == beside.detector.gel
    finally:
        beside.close()
