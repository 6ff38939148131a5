"""Warming up compiles everything that a run then needs."""

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, warm_up


def test_warm_up_takes_a_gel_through_every_stage():
    line = Pipeline.build(load_profile("default"), GestureConfig())
    warm_up(line)
    seen = line.rest.detector.stats()
    assert seen.n_references == 1  # the drawn gel is found, so tracker and gesture have run
    assert line.tracker.stats().n_events > 0
