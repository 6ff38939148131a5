"""Events of a real gel's picture: its own dots, and the edge and skin of the finger between them.

Runs where the clip is; the clip is no part of the project.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from neurotouch_hid.messages import RestField
from neurotouch_hid.tracker import MarkerTracker
from tests.tracker.real_picture import FRAME_US, GEL, make_events

pytest.importorskip("eventcv")


N_SHORT = 90
"""Pictures of a shorter clip, after which 5 to 37 % of the dots were once off."""


@pytest.mark.parametrize("contrast", [1.0, 0.35])
def test_events_alone_follow_a_real_picture_to_its_end(contrast):
    path = Path(os.environ.get("NEUROTOUCH_SHARED_DATA", "../shared/data")) / "gelsight-mini.avi"
    if not path.exists():
        pytest.skip(f"the real gel's clip {path} is not here (folder: NEUROTOUCH_SHARED_DATA)")
    real = make_events(path, contrast=contrast)
    tracker = MarkerTracker(gel=GEL)
    tracker.anchor(RestField(0, real.dots_px[0].astype(np.float32)))
    errors, n_returns = [], 0
    for packet in real.packets:
        field = tracker.update(packet)
        back = tracker.find_return() if tracker.is_frameless else None
        if back is not None:
            tracker.anchor(back)
            n_returns += 1
        index, rest_us = divmod(packet.t_end_us, FRAME_US)
        if not rest_us:
            errors.append(np.hypot(*(field.position_px - real.dots_px[index]).T))
    assert n_returns >= 2
    assert np.median(errors) < 0.8
    assert (np.array(errors) > 2.0).mean() < 0.01
    assert not (errors[N_SHORT - 1] > 2.0).any()
    assert not (errors[-1] > 2.0).any()
