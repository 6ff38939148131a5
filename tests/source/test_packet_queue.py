"""What waits between the camera's thread and the line."""

import numpy as np

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket
from neurotouch_hid.source.packet_queue import PacketQueue

TOO_LONG_S = 10_000.0


def make(k, *, is_partial=False):
    return EventPacket(k, k + 1, np.zeros(5, EVENT_DTYPE), is_partial=is_partial)


def test_a_head_is_only_for_a_line_that_has_nothing_else_to_do():
    queue = PacketQueue(2)
    queue.offer(head := make(0, is_partial=True))
    assert queue.take(0) is head
    queue.put(whole := make(0))
    queue.offer(make(1, is_partial=True))
    assert queue.take(0) is whole
    assert queue.take(0) is None


def test_a_head_that_was_not_taken_in_time_is_forgotten():
    queue = PacketQueue(1)
    queue.offer(make(0, is_partial=True))
    queue.put(whole := make(0))
    assert queue.take(0) is whole
    assert whole.gap == 0
    assert queue.take(0) is None


def test_a_queue_is_empty_when_all_was_taken():
    queue = PacketQueue(2)
    assert queue.is_empty
    queue.put(make(0))
    assert not queue.is_empty
    queue.take(0)
    assert queue.is_empty


def test_slices_that_come_at_once_find_room():
    queue = PacketQueue(2)
    queue.make_room(4)
    for k in range(5):
        queue.put(make(k))
    assert [queue.take(0).t_begin_us for _ in range(4)] == [1, 2, 3, 4]
    assert queue.take(0) is None


def test_a_reader_that_is_told_not_to_wait_takes_what_is_there_first():
    queue = PacketQueue(2)
    queue.put(whole := make(0))
    queue.wake()
    assert queue.take(TOO_LONG_S) is whole
    assert queue.take(TOO_LONG_S) is None
    queue.put(whole)
    assert queue.take(TOO_LONG_S) is whole
