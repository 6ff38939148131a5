"""Finds the gel without frames: the first touch moves all markers, and events draw them twice."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, EventPacket, RestField
from neurotouch_hid.tracker.blobs import BlobFinder
from neurotouch_hid.tracker.lattice import Lattice, LatticeConfig, find_lattice

_FADE_US = 300_000.0  # time constant; events from before a touch fade out
_SEARCH_US = 40_000  # as often as frames would come
_LEAST_NOISE = 0.3  # events per pixel
_MAX_BLOBS = 700  # more is noise
_MIN_FOUND = 120  # markers of each polarity; the smooth model fills in the others
_MAX_APART_PX = 7.0  # distance of ON and OFF spot for nearly all markers: size plus motion
_LEAD_PX = 1.8  # largest distance from a marker's centre to its ON or OFF spot
_BLACK, _NOISE_LEVEL = 20.0, 3.0  # grey levels of no event and of the deviation of the noise


class EventFrame:
    """Adds up polarities until they show the markers.

    A bright marker that moves a little leaves a spot of ON events where it goes and one of OFF
    events where it was. If both spots of nearly all markers are close together, no marker has moved
    far. Its place at rest is then half way between them, to about half a pixel.

    Attributes:
        n_found: markers that the events show so far.
    """

    def __init__(self, rig: Rig | None = None, near_rad: float = 0.0) -> None:
        self._rig, self._near_rad = rig, near_rad
        self._finder = BlobFinder()
        self._net: NDArray[np.float64] = np.zeros((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX))
        self._next_us: int | None = None
        self.n_found = 0

    def update(self, packet: EventPacket) -> RestField | None:
        """Returns all markers at rest, as soon as events show them; before that None."""
        self._add(packet)
        if self._next_us is None:
            self._next_us = packet.t_begin_us + _SEARCH_US
        if packet.t_end_us < self._next_us:
            return None
        self._next_us = packet.t_end_us + _SEARCH_US
        smooth = _smooth(self._net)
        noise = max(1.48 * float(np.median(np.abs(smooth))), _LEAST_NOISE)
        on, off = (self._find(sign * smooth / noise) for sign in (1.0, -1.0))
        self.n_found = min(0 if lattice is None else lattice.n_found for lattice in (on, off))
        if on is None or off is None or self.n_found < _MIN_FOUND:
            return None
        moved = on.position_px - off.position_px
        apart = np.hypot(*moved.T)
        if np.percentile(apart, 98) > _MAX_APART_PX:
            return None
        lead = np.minimum(0.5, _LEAD_PX / np.maximum(apart, 1e-9))
        position = off.position_px + lead[:, None] * moved
        return RestField(packet.t_end_us, position.astype(np.float32))

    def _add(self, packet: EventPacket) -> None:
        self._net *= math.exp((packet.t_begin_us - packet.t_end_us) / _FADE_US)
        events = packet.events
        index = events["y"].astype(np.intp) * SENSOR_WIDTH_PX + events["x"]
        polarity = np.where(events["p"], 1.0, -1.0)
        self._net += np.bincount(index, polarity, self._net.size).reshape(self._net.shape)

    def _find(self, picture: NDArray[np.float64]) -> Lattice | None:
        pixels = np.clip(_BLACK + _NOISE_LEVEL * picture, 0, 255).astype(np.uint8)
        centroid_px = self._finder.find(pixels).centroid_px
        if len(centroid_px) > _MAX_BLOBS:
            return None
        return find_lattice(centroid_px, LatticeConfig(), self._rig, near_rad=self._near_rad)


def _smooth(picture: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the picture, smoothed by a binomial window of 3 x 3."""
    wide = np.pad(picture, 1)
    rows = (wide[:-2] + 2.0 * wide[1:-1] + wide[2:]) / 4.0
    smooth: NDArray[np.float64] = (rows[:, :-2] + 2.0 * rows[:, 1:-1] + rows[:, 2:]) / 4.0
    return smooth
