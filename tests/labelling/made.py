"""Moments without a recording."""

import numpy as np

from neurotouch_hid.labelling.look_through import Moments
from neurotouch_hid.labelling.track import Track


def make_track(kinds, contacts) -> Track:
    track = Track.of_size(len(kinds))
    for k, (kind, points) in enumerate(zip(kinds, contacts, strict=True)):
        if kind >= 0:
            track.set(k, kind, 2.0 if kind else 0.0, np.reshape(points, (-1, 2)))
    return track


def make_moments(kinds, contacts, *, confidence=1.0, peak_mm=0.5, view=None) -> Moments:
    """Moments every 40 ms, of a gel with four dots that all are seen; no pictures."""
    n = len(kinds)
    return Moments(
        5_000 + 40_000 * np.arange(n),
        np.zeros(n, np.int32),
        make_track(kinds, contacts),
        np.full(n, confidence, np.float32),
        np.ones((n, 4, 2), np.float32),
        np.ones((n, 4), bool),
        np.full(n, peak_mm, np.float32),
        np.tile(np.float32([10.0, 20.0]), (n, 1)),
        2.5,
        None,
        view,
        is_simulated=False,
    )
