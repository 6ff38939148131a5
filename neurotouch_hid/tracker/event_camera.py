"""Draws pictures of the gel from events, for a camera that sends none.

Events tell how much brighter or darker a pixel has become. A marker that moves away leaves a dark
spot at its place at rest, and all these spots together are the lattice. Once it is known, the
markers at rest and the changes since then give the picture at any time.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, Rig, find_median, fit_rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, EventPacket, Frame
from neurotouch_hid.process.kernel_cache import load
from neurotouch_hid.tracker.blobs import BlobConfig, BlobFinder
from neurotouch_hid.tracker.faint_spots import find_faint_spots
from neurotouch_hid.tracker.kernels import event_camera as kernels
from neurotouch_hid.tracker.lattice import Lattice, LatticeFinder
from neurotouch_hid.tracker.smooth_map import assign, fit_model

_PERIOD_US = 40_000  # from one picture to the next
_FADE_US = 2_000_000.0  # time constant with which noise fades while the gel is at rest
_NOISE = 5.0  # times the noise: a pixel has changed
_LEAST_NOISE = 0.3  # events
_LEAST_CHANGED = 150  # pixels that a touch changes
_BACK_SHARE = 0.15  # of them that are still changed after the gel has come back
_MOVING_SHARE = 0.02  # of them that change in a period while something moves
_STILL_US = 80_000  # the gel has come back if nothing moves for as long
_STUCK_US = 1_500_000  # a hand was on the gel at first if nothing moves for as long
_GREY = 2.5  # grey levels of a deviation of the noise in the picture of dark spots
_REMEMBER = 0.9  # of older dark spots, which complete the lattice
_GATE = 0.42  # of the pitch, from a marker to its spot
_RATIO = 10.0  # how much brighter than the gel a marker is drawn
_SIGMA = 0.45  # of a marker, in diameters
_FULL = 0.8  # of the depth of the spot of a marker that has left it
_FAINT = 0.15  # of it; less may be noise
_FULL_SHARE = 97  # percentile of the depths that is certainly full
_SPOT_GATE = (
    0.6  # of the pitch, from the dark to the bright spot of a marker that has moved a little
)
_MODEL_WEIGHT = 1.0  # of a place that the others give, in places seen once
_MAX_OWN = 0.125  # of the pitch, from there; farther off is another spot
_FAINT_WEIGHT = 0.5  # of the middle of a dot that has moved by a fraction of its size
_TOUCHED_SHARE = 0.4  # of the markers that move far enough for a dark spot of their own
_LEAST_SHARE = 0.5  # of the markers that a light touch has to move, so that it shows the gel
_LEAST_LOST = 2  # of their spots have no marker if the lattice is taken one pitch beside its place


@dataclass(frozen=True, slots=True, eq=False)
class _Spots:
    """The spots of markers that have moved.

    Attributes:
        position_px: (n, 2) float64 px, where each was at rest.
        weight: (n,) float64, how surely the spots tell that, 0 to 1.
        px_per_mm: scale.
        full: depth of a dark spot in events.
    """

    position_px: NDArray[np.float64]
    weight: NDArray[np.float64]
    px_per_mm: float
    full: float


class EventCamera:
    """Finds the markers in events, then draws them.

    Args:
        lattice: finds the gel among spots.
        rig: where the gel is known to be; None searches for it.
        near_rad: the turn that is expected, see ``LatticeFinder``.

    Attributes:
        n_found: markers whose dark spots were seen.
        n_learnt: how often the places of the markers at rest were learnt.
    """

    def __init__(
        self, lattice: LatticeFinder, rig: Rig | None = None, near_rad: float = 0.0
    ) -> None:
        self._lattice, self._gel = lattice, lattice.gel
        self._rig, self._near_rad = rig, near_rad
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        self._net, self._low, self._most, self._now, self._before, self._dark, self._rest = (
            np.zeros(shape, np.float32) for _ in range(7)
        )
        self._finder = BlobFinder(BlobConfig(min_clear=0))  # its pictures are smooth already
        self._next_us: int | None = None
        self._most_changed = self._still_us = 0
        self._total_px = np.zeros(self._gel.points_mm.shape)
        self._weight = np.zeros(self._gel.n_markers)
        self._log_per_event = 0.0
        self._noise = _LEAST_NOISE
        self.n_found = self.n_learnt = 0
        load(kernels.expose, self._now, self._rest, 0.0, np.empty(shape, np.uint8))
        load(kernels.draw_rest, self._total_px, 0.0, _RATIO, 0.0, self._rest)

    def update(self, packet: EventPacket) -> Frame | None:
        """Takes the events of a slice; returns the picture at its start, if one is due."""
        frame, t_us = None, packet.t_begin_us
        if self._next_us is None or not 0 <= self._next_us - t_us <= _PERIOD_US:
            frame = self._look(t_us)
            self._next_us = t_us + _PERIOD_US
        elif t_us >= self._next_us:
            frame = self._look(t_us)
            self._next_us += _PERIOD_US
        kernels.add_events(self._gel.lighten_events(packet.events), self._net)
        return frame

    def _look(self, t_us: int) -> Frame | None:
        kernels.smooth(self._net, self._now)
        self._watch()
        if not self.n_learnt:
            return None
        pixels = np.empty(self._net.shape, np.uint8)
        kernels.expose(self._now, self._rest, self._log_per_event, pixels)
        pixels = self._gel.lighten(pixels)  # drawn light, but the frames of a camera are not
        pixels.setflags(write=False)
        return Frame(pixels, t_us, t_us)

    def _watch(self) -> None:
        """Learns where the markers are at rest whenever the gel has come back from a touch."""
        self._noise = noise = max(
            1.48 * float(find_median(np.abs(self._now).ravel())), _LEAST_NOISE
        )
        changed = int(np.count_nonzero(np.abs(self._now) > _NOISE * noise))
        moving = int(np.count_nonzero(np.abs(self._now - self._before) > _NOISE * noise))
        self._before[:] = self._now
        np.minimum(self._low, self._now, out=self._low)
        if changed >= self._most_changed:
            self._most_changed = changed
            self._most[:] = self._now
        if self._most_changed < _LEAST_CHANGED:
            self._fade(math.exp(-_PERIOD_US / _FADE_US))
            return
        is_still = moving <= _MOVING_SHARE * self._most_changed
        self._still_us = self._still_us + _PERIOD_US if is_still else 0
        if changed <= _BACK_SHARE * self._most_changed:
            if self._still_us >= _STILL_US:
                self._learn()
                self._fade(0.0)
        elif self._still_us >= _STUCK_US and not self.n_learnt:
            self._fade(0.0)

    def _fade(self, share: float) -> None:
        """Begins to wait for a touch."""
        self._net *= share
        self._low *= share
        if not share:
            self._now[:] = self._before[:] = 0.0
        self._most_changed = self._still_us = 0

    def _learn(self) -> None:
        """Learns the places of the markers from a touch that is over."""
        spots = self._find_spots()
        if spots is None:
            return
        known = self._weight > 0.0
        if known.any():
            mean_px = self._total_px[known] / self._weight[known, None]
            off_px = find_median(np.hypot(*(mean_px - spots.position_px[known]).T))
            if (
                off_px > 0.5 * self._gel.pitch_mm * spots.px_per_mm
            ):  # the lattice was a pitch beside it
                self._total_px[:], self._weight[:] = 0.0, 0.0
        self._total_px += spots.weight[:, None] * spots.position_px
        self._weight += spots.weight
        seen = self._weight > 0.0
        mean_px = self._total_px / np.maximum(self._weight, 1e-9)[:, None]
        model_px = fit_model(mean_px, np.where(seen, np.arange(len(seen)), -1), self._gel)
        own_px = np.hypot(*(mean_px - model_px).T)
        seen &= own_px <= _MAX_OWN * self._gel.pitch_mm * spots.px_per_mm
        share = np.where(seen, self._weight / (self._weight + _MODEL_WEIGHT), 0.0)[:, None]
        position_px = share * mean_px + (1.0 - share) * model_px
        self._log_per_event = math.log1p(_RATIO) / spots.full
        sigma_px = _SIGMA * self._gel.dot_mm * spots.px_per_mm
        kernels.draw_rest(position_px, sigma_px, _RATIO, self._log_per_event, self._rest)
        self.n_learnt += 1

    def _find_spots(self) -> _Spots | None:
        """Finds the markers by the spots that they have left."""
        dark = -self._low
        np.maximum(_REMEMBER * self._dark, dark, out=self._dark)
        gel = self._gel
        all_px = self._find_blobs(self._dark)
        lattice = self._lattice.find(all_px, self._rig, near_rad=self._near_rad)
        self.n_found = 0 if lattice is None else lattice.n_found
        if lattice is None or lattice.share < _TOUCHED_SHARE:
            return None
        bright_px = self._find_blobs(self._most)
        faint_px = np.empty((0, 2))
        if lattice.share < self._lattice.config.min_share:  # a light touch
            faint_px = find_faint_spots(self._most, np.concatenate([all_px, bright_px]))
            all_px = np.concatenate([all_px, faint_px])
            lattice = self._lattice.find(all_px, self._rig, near_rad=self._near_rad)
            self.n_found = 0 if lattice is None else lattice.n_found
        if lattice is None or not self._is_certain(lattice):
            return None
        px_per_mm = fit_rig(lattice.position_px, gel).px_per_mm
        spots_px = self._find_blobs(dark)
        blob = assign(lattice.position_px, spots_px, _GATE * gel.pitch_mm * px_per_mm)
        seen = blob >= 0
        position_px = np.where(seen[:, None], spots_px[blob], lattice.position_px)
        x, y = np.rint(position_px).astype(np.intp).T
        depth = dark[y.clip(0, SENSOR_HEIGHT_PX - 1), x.clip(0, SENSOR_WIDTH_PX - 1)]
        full = float(np.percentile(depth, _FULL_SHARE))
        weight = np.where(seen, np.clip(depth / full, 0.0, 1.0), 0.0)
        weight[weight < _FAINT] = 0.0
        for i in np.flatnonzero((weight > 0.0) & (weight < _FULL)):
            to_bright = bright_px - position_px[i]
            apart_px = np.hypot(*to_bright.T)
            k = int(apart_px.argmin())
            if apart_px[k] > _SPOT_GATE * gel.pitch_mm * px_per_mm:
                weight[i] = 0.0
                continue
            lead_px = find_lead(float(apart_px[k]), _SIGMA * gel.dot_mm * px_per_mm)
            position_px[i] += lead_px / apart_px[k] * to_bright[k]
        faint = assign(lattice.position_px, faint_px, _GATE * gel.pitch_mm * px_per_mm)
        is_faint = (faint >= 0) & ~seen
        position_px[is_faint], weight[is_faint] = faint_px[faint[is_faint]], _FAINT_WEIGHT
        return _Spots(position_px, weight, px_per_mm, full)

    def _is_certain(self, lattice: Lattice) -> bool:
        """Returns whether the spots leave no doubt which marker is which.

        A light touch moves only the markers around it enough to leave a spot. They are told apart
        if some of them are at the rim on each side: then no other place of the lattice explains
        them.
        """
        if lattice.share >= self._lattice.config.min_share:
            return True
        if lattice.share < _LEAST_SHARE:
            return False
        return count_lost(self._gel, lattice.blob >= 0) >= _LEAST_LOST

    def _find_blobs(self, picture: NDArray[np.float32]) -> NDArray[np.float64]:
        above = picture - find_median(picture.ravel())
        pixels = np.clip(kernels.BLACK_DN + _GREY / self._noise * above, 0, 255).astype(np.uint8)
        return self._finder.find(pixels).centroid_px.copy()


def count_lost(gel: Gel, seen: NDArray[np.bool_]) -> int:
    """Returns how many seen places have no marker if the lattice is moved to a neighbour's place.

    Args:
        gel: the gel.
        seen: (n,) bool, the markers that were seen.

    Returns:
        The number for the neighbour that explains the seen places best.
    """
    points_mm = gel.points_mm
    middle = int(np.hypot(*(points_mm - points_mm.mean(axis=0)).T).argmin())
    around = gel.neighbours[middle]
    least = int(seen.sum())
    for step_mm in points_mm[around[around >= 0]] - points_mm[middle]:
        apart_mm = points_mm[seen, None] + step_mm - points_mm[None]
        nearest_mm = np.hypot(apart_mm[..., 0], apart_mm[..., 1]).min(axis=1)
        least = min(least, int((nearest_mm > 0.5 * gel.pitch_mm).sum()))
    return least


def find_lead(apart_px: float, sigma_px: float) -> float:
    """Returns how far a marker at rest is ahead of the middle of its dark spot, px.

    The spots are the two parts of the difference of two Gaussians. If the marker has moved little,
    both are beside its place; once it has left, the dark one is its place.

    Args:
        apart_px: distance of the middles of its dark and its bright spot.
        sigma_px: standard deviation of the marker.
    """
    return float(np.interp(apart_px / sigma_px, _APART, _LEAD)) * sigma_px


_MOVED = np.linspace(0.01, 6.0, 200)  # in standard deviations
_OUTSIDE = np.array([0.5 * math.erfc(moved / math.sqrt(8.0)) for moved in _MOVED])
_LEAD = np.r_[0.0, _MOVED * _OUTSIDE / (1.0 - 2.0 * _OUTSIDE)]
_APART = np.r_[0.0, _MOVED + 2.0 * _LEAD[1:]]
