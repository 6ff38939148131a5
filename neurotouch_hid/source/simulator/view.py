"""The picture in front of the sensor between two knots, and its light."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.simulator.gel import KNOT_US, GelMotion
from neurotouch_hid.source.simulator.kernels.optics import Lamps
from neurotouch_hid.source.simulator.optics import find_ring
from neurotouch_hid.source.simulator.sensor import TICK_US, USUAL_LIGHT
from neurotouch_hid.source.simulator.setup import Setup

N_KNOTS = 8  # kept; an interval needs four
N_PIXELS = SENSOR_WIDTH_PX * SENSOR_HEIGHT_PX


class View:
    """The picture and the light of a set-up over time.

    Args:
        motion: the gel.
        setup: what else is in the picture, and its light.
    """

    def __init__(self, motion: GelMotion, setup: Setup) -> None:
        self._motion, self._setup = motion, setup
        self._reach = _find_reach(setup.config.camera.rig, find_ring(setup.config.gel.layout))
        self._outlines: deque[tuple[int, NDArray[np.float64]]] = deque(maxlen=N_KNOTS)
        self._shades: deque[tuple[int, NDArray[np.float32]]] = deque(maxlen=N_KNOTS)

    def outline(self, index: int) -> NDArray[np.float64]:
        """Returns what is in the picture at a knot, (n, 6) as of ``CameraModel.outline``."""
        knot = self._motion.knot(index)
        if not self._setup.marks:
            return knot.outline
        for known, outline in self._outlines:
            if known == index:
                return outline
        untouched = self._motion.untouched
        rows = [mark(index * KNOT_US, knot, untouched) for mark in self._setup.marks]
        outline = np.concatenate([knot.outline, *rows])
        self._outlines.append((index, outline))
        return outline

    def light(self, index: int) -> Lamps:
        """Returns the light of the interval that begins at a knot."""
        if not self._setup.lamps and not self._setup.shades:
            return USUAL_LIGHT
        n = KNOT_US // TICK_US
        ends_us = index * KNOT_US + TICK_US * np.arange(1.0, n + 1)
        gain, leak = np.ones(n), np.zeros(n)
        for lamp in self._setup.lamps:
            share, through = lamp(ends_us)
            gain *= share
            leak += through
        shade = np.stack([self._shade(index), self._shade(index + 1)])
        return Lamps(True, np.maximum(gain, 0.0), np.maximum(leak, 0.0), self._reach, shade)

    def _shade(self, index: int) -> NDArray[np.float32]:
        for known, shade in self._shades:
            if known == index:
                return shade
        shade = np.ones(N_PIXELS, np.float32)
        for cast in self._setup.shades:
            shade *= cast(index * KNOT_US, self._motion.knot(index))
        self._shades.append((index, shade))
        return shade


def _find_reach(rig: Rig, ring_mm: float) -> NDArray[np.float32]:
    """Returns where light comes through: within the rim, 1, and 0 where the housing is."""
    y, x = np.mgrid[:SENSOR_HEIGHT_PX, :SENSOR_WIDTH_PX]
    far_mm = np.hypot(x - rig.centre_px[0], y - rig.centre_px[1]) / rig.px_per_mm
    return np.asarray(np.clip(ring_mm - far_mm, 0.0, 1.0), np.float32).ravel()
