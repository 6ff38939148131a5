"""Makes pictures of the gel from events, for a camera that sends none."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig, fit_rig
from neurotouch_hid.messages import (
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
)
from neurotouch_hid.tracker.blobs import BlobFinder
from neurotouch_hid.tracker.kernels import event_camera as kernels
from neurotouch_hid.tracker.lattice import LatticeConfig, _fit_model, find_lattice

_PERIOD_US = 40_000  # from one picture to the next
_FADE_US = 2_000_000.0  # time constant with which noise fades while the gel is at rest
_NOISE = 5.0  # times the noise: a pixel has changed
_LEAST_NOISE = 0.3  # events
_LEAST_CHANGED = 200  # pixels that a touch changes
_BACK_SHARE = 0.15  # of them that are still changed after the gel has come back
_STUCK_US = 1_500_000  # the gel was touched at first if it stays elsewhere for as long
_MAX_BLOBS = 700  # more is noise
_GREY = 8.0  # grey levels of an event in the picture of what was darkened
_LEAST_FOUND = 120
_RATIO = 10.0  # how much brighter than the gel a marker is drawn
_SIGMA_MM = 0.45  # of a spot
_FULL = 0.8  # of the depth of a spot that its marker has left
_SPOT_GATE_MM = 2.4


class EventCamera:
    def __init__(self, rig: Rig | None = None, near_rad: float = 0.0) -> None:
        self._rig, self._near_rad = rig, near_rad
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        self._net, self._low, self._most, self._smooth, self._before, self._rest = (
            np.zeros(shape, np.float32) for _ in range(6)
        )
        self._finder = BlobFinder()
        self._next_us: int | None = None
        self._most_changed = 0
        self._still_us = 0
        self._log_per_event = 0.0
        self.position_px: NDArray[np.float64] | None = None
        self.n_found = 0

    @property
    def is_found(self) -> bool:
        return self.position_px is not None

    def update(self, packet: EventPacket) -> Frame | None:
        frame = None
        t_us = packet.t_begin_us
        if self._next_us is None:
            self._next_us = t_us + _PERIOD_US
        if t_us >= self._next_us:
            self._next_us = t_us + _PERIOD_US
            kernels.smooth(self._net, self._smooth)
            if self.position_px is None:
                self._search()
            if self.position_px is not None:
                frame = self._expose(t_us)
        kernels.add_events(packet.events, self._net, self._low)
        return frame

    def settle(self) -> None:
        """Lets noise fade, because the gel is at rest."""
        self._net *= math.exp(-_PERIOD_US / _FADE_US)

    def _expose(self, t_us: int) -> Frame:
        pixels = np.empty(self._net.shape, np.uint8)
        kernels.expose(self._smooth, self._rest, self._log_per_event, pixels)
        pixels.setflags(write=False)
        return Frame(pixels, t_us, t_us)

    def _search(self) -> None:
        smooth = self._smooth
        limit = _NOISE * max(1.48 * float(np.median(np.abs(smooth))), _LEAST_NOISE)
        changed = int((np.abs(smooth) > limit).sum())
        moving = int((np.abs(smooth - self._before) > limit).sum())
        self._before[:] = smooth
        if changed >= self._most_changed:
            self._most_changed = changed
            self._most[:] = smooth
        if self._most_changed < _LEAST_CHANGED:
            for each in (self._net, self._low):
                each *= math.exp(-_PERIOD_US / _FADE_US)
            return
        self._still_us = self._still_us + _PERIOD_US if moving < 0.02 * self._most_changed else 0
        if changed <= _BACK_SHARE * self._most_changed:
            self._find()
        elif self._still_us < _STUCK_US:
            return
        if self.position_px is None:
            self._restart()

    def _restart(self) -> None:
        for each in (self._net, self._low):
            each[:] = 0.0
        self._most_changed = self._still_us = 0

    def _find(self) -> None:
        """Finds the markers by the spots that they have left."""
        off = np.empty_like(self._low)
        kernels.smooth(self._low, off)
        off *= -1.0
        off_px = self._find_spots(off)
        lattice = find_lattice(off_px, LatticeConfig(), self._rig, near_rad=self._near_rad)
        self.n_found = 0 if lattice is None else lattice.n_found
        if lattice is None or self.n_found < _LEAST_FOUND:
            return
        on_px = self._find_spots(self._most)
        px_per_mm = fit_rig(lattice.position_px).px_per_mm
        index = np.rint(lattice.position_px).astype(np.intp)
        x = np.clip(index[:, 0], 1, SENSOR_WIDTH_PX - 2)
        y = np.clip(index[:, 1], 1, SENSOR_HEIGHT_PX - 2)
        depth = off[y, x]
        full = float(np.percentile(depth, 97))
        self._log_per_event = math.log1p(_RATIO) / full
        position = lattice.position_px.copy()
        sigma = _SIGMA_MM * px_per_mm
        to_on = on_px[None, :, :] - position[:, None, :]
        apart = np.hypot(to_on[..., 0], to_on[..., 1])
        nearest = apart.argmin(axis=1)
        good = lattice.blob >= 0
        for i in np.flatnonzero(good):
            s = apart[i, nearest[i]]
            if depth[i] > _FULL * full:
                continue
            if s > _SPOT_GATE_MM * px_per_mm:
                good[i] = False
                continue
            position[i] += _lead(s, sigma) / s * to_on[i, nearest[i]]
        self.debug = lattice, depth, full, off_px, on_px, position.copy(), good
        model = _fit_model(position, np.where(good, np.arange(len(good)), -1))
        off_model = np.hypot(*(position - model).T)
        good &= off_model < 1.2
        position = np.where(good[:, None], 0.5 * (position + model), model)
        self.position_px = position
        kernels.draw_rest(position, sigma, _RATIO, self._log_per_event, self._rest)

    def _find_spots(self, picture: NDArray[np.float32]) -> NDArray[np.float64]:
        above = picture - np.median(picture)
        pixels = np.clip(kernels.BLACK_DN + _GREY * above, 0, 255).astype(np.uint8)
        return self._finder.find(pixels).centroid_px.copy()


_STEPS = np.linspace(1e-3, 6.0, 200)


def _offset(d: float) -> float:
    away = 0.5 * math.erfc(d / 2.0 / math.sqrt(2.0))
    return d * away / (1.0 - 2.0 * away)


_OFFSETS = np.array([_offset(float(d)) for d in _STEPS])
_APARTS = _STEPS + 2.0 * _OFFSETS


def _lead(apart_px: float, sigma_px: float) -> float:
    """Returns how far a marker at rest is ahead of its dark spot, px."""
    s = apart_px / sigma_px
    if s <= _APARTS[0]:
        return apart_px / 2.0
    return float(np.interp(s, _APARTS, _OFFSETS)) * sigma_px
