"""What the live line is measured with: the hand's own events, and as many more as wanted."""

import numpy as np
import pytest

from neurotouch_hid.evaluation.speed.workload import DenseSource, LoopScene, load_scene
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame, GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline

SLICE_US = 4_000
MARKER_PX = (200.0, 100.0)


def make_packet(k, n=5):
    events = np.zeros(n, EVENT_DTYPE)
    events["t"] = k * SLICE_US + np.arange(n) * 10
    events["x"], events["y"], events["p"] = 10 * k + np.arange(n), 7, True
    frame = Frame(np.zeros((260, 346), np.uint8), k * SLICE_US + 5, k * SLICE_US + 9)
    return EventPacket(k * SLICE_US, (k + 1) * SLICE_US, events, (frame,))


PACKETS = tuple(make_packet(k) for k in range(3))
SCENE = LoopScene(PACKETS, np.full((3, 1, 2), MARKER_PX, np.float32))


@pytest.mark.parametrize(("events_per_s", "n"), [(None, 5), (1e6, 4_000), (12e6, 48_000), (5e2, 2)])
def test_slices_in_turn_have_ascending_stamps_and_the_wanted_events(events_per_s, n):
    played = list(DenseSource(SCENE, 0.028, events_per_s))
    assert len(played) == 7
    for k, packet in enumerate(played):
        assert (packet.t_begin_us, packet.t_end_us) == (k * SLICE_US, (k + 1) * SLICE_US)
        t = packet.events["t"]
        assert len(t) == n
        assert (np.diff(t) >= 0).all()
        assert ((t >= packet.t_begin_us) & (t < packet.t_end_us)).all()
        own = packet.events[packet.events["y"] == 7]
        wanted = PACKETS[k % 3].events["x"]
        assert list(own["x"]) == list(wanted[np.arange(min(n, 5)) * 5 // min(n, 5)])
        assert own["p"].all()
        assert packet.frames[0].exposure_end_us == packet.t_begin_us + 9
    assert (PACKETS[0].events["t"] < SLICE_US).all()  # what is played from stays as it was


def test_what_is_added_lies_evenly_about_the_markers():
    packet = next(iter(DenseSource(SCENE, 0.004, 6e6)))
    added = packet.events[packet.events["y"] != 7]
    off_px = np.column_stack([added["x"], added["y"]]) - MARKER_PX
    assert np.abs(off_px).max() <= 5
    np.testing.assert_allclose(off_px.mean(axis=0), 0.0, atol=0.1)
    assert 0.4 < added["p"].mean() < 0.6


def test_a_gel_at_rest_stays_at_rest_under_any_load():
    line = Pipeline.build(load_profile("default"), GestureConfig())
    for packet in DenseSource(load_scene("rest", SLICE_US, 100_000), 1.0, 1e6):
        assert line.advance(packet).gesture.kind is GestureKind.NONE
    line.close()
