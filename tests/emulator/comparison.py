"""Whether a driver has seen what the camera was shown, event for event."""

import numpy as np

from tests.emulator.host import list_events


def assert_same(answer, packets):
    """Compare what ``drivers`` wrote with the packets, but for the origin of time."""
    shown = np.array(list_events(packets)).T
    events = answer["events"]
    n_frames = len(answer["times"])
    assert events.shape == shown.shape, f"{events.shape[-1]} events, {n_frames} frames"
    shift = events[0, 0] - shown[0, 0]
    assert np.array_equal(events[0] - shift, shown[0])
    for column, name in ((1, "x"), (2, "y"), (3, "polarity")):
        assert np.array_equal(events[column], shown[column]), name
    frames = [frame for packet in packets for frame in packet.frames]
    times = np.array([(frame.exposure_begin_us, frame.exposure_end_us) for frame in frames])
    assert np.array_equal(answer["times"] - shift, times)
    assert np.array_equal(answer["pixels"], np.array([frame.pixels for frame in frames]))
