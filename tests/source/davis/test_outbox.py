"""What waits between the camera's thread and the line."""

import numpy as np

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket
from neurotouch_hid.source.davis.outbox import Outbox


def make(k, *, is_begin=False):
    return EventPacket(k, k + 1, np.zeros(5, EVENT_DTYPE), is_begin=is_begin)


def test_a_begin_is_only_for_a_line_that_has_nothing_else_to_do():
    outbox = Outbox(2)
    outbox.offer(begin := make(0, is_begin=True))
    assert outbox.take(0) is begin
    outbox.put(whole := make(0))
    outbox.offer(make(1, is_begin=True))
    assert outbox.take(0) is whole
    assert outbox.take(0) is None


def test_a_begin_that_was_not_taken_in_time_is_forgotten():
    outbox = Outbox(1)
    outbox.offer(make(0, is_begin=True))
    outbox.put(whole := make(0))
    assert outbox.take(0) is whole
    assert whole.gap == 0
    assert outbox.take(0) is None
