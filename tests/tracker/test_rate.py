"""The length of a slice changes the tracks only by rounding."""

import numpy as np

from neurotouch_hid.source import open_source
from neurotouch_hid.tracker import MarkerTracker, RestDetector


def follow(slice_us):
    """Returns positions at every 20 ms of the first 0.8 s of a push."""
    rest, tracker = RestDetector(), MarkerTracker()
    positions = {}
    with open_source("sim:push", slice_us=slice_us, speed="max") as source:
        for packet in source:
            for frame in packet.frames:
                answer = rest.update(frame)
                if answer is not None:
                    tracker.anchor(answer)
            markers = tracker.update(packet)
            if packet.t_end_us % 20_000 == 0:
                positions[packet.t_end_us] = markers.position_px
            if packet.t_end_us >= 800_000:
                return positions
    raise AssertionError


def test_slices_of_any_length_give_the_same_tracks():
    long, middle, short = follow(10_000), follow(4_000), follow(1_000)
    assert list(long) == list(middle) == list(short)
    for t_us in list(long)[10:]:  # the first rest position is known at the end of a slice
        assert np.nanmax(np.abs(long[t_us] - middle[t_us])) < 0.5
        assert np.nanmax(np.abs(long[t_us] - short[t_us])) < 0.5
        assert np.isfinite(long[t_us]).all()
