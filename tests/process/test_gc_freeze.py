"""Python looks for garbage without holding the line up."""

import gc

from neurotouch_hid.process.gc_freeze import freeze_gc
from neurotouch_hid.process.realtime import realtime_priority


class Loop:
    def __init__(self) -> None:
        self.me = self


def test_what_was_there_before_is_not_looked_through():
    usual = gc.get_threshold()
    many = [[] for _ in range(2_000)]
    with freeze_gc():
        assert gc.get_freeze_count() > len(many)
        assert len(gc.get_objects()) < len(many)
        assert gc.get_threshold()[0] < len(many)
    assert gc.get_threshold() == usual
    assert gc.get_freeze_count() == 0


def test_new_garbage_is_found():
    with freeze_gc():
        for _ in range(10_000):
            Loop()
        left = sum(isinstance(each, Loop) for each in gc.get_objects())
    assert left < 2_000


def test_whoever_hurries_has_short_collections():
    with realtime_priority():
        assert gc.get_freeze_count() > 0
    assert gc.get_freeze_count() == 0
