"""Settings of the tracker, and tracks made for them."""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.tracker.kernels import nearest
from neurotouch_hid.tracker.kernels import tracks as track_kernels

_PAST: Final = 64  # checks remembered: at least 128 ms, longer than exposure and delay of a frame
_NEVER_US: Final = -(1 << 60)


@dataclass(frozen=True, slots=True)
class TrackerConfig:
    """Settings of the event filter and of the checks.

    Attributes:
        gate_px: an event farther from every marker than this belongs to none; at most 3.5.
            That is a third of the pitch: markers that are pressed together come within 3.5 px.
        r_px2: variance of an event about its marker's centre, px². Larger than the marker: its
            events are not independent of each other.
        spread_px: the farther beyond this distance, the more an event counts as noise.
        q_x: growth of a position's variance, px²/s.
        q_v: growth of a velocity's variance, px²/s³.
        memory_us: a velocity fades within this time if a marker makes no events.
        quiet_us: the longer the interval between events beyond this, the more they count as noise.
        check_us: time between two checks, up to 8 ms while nothing moves; every second check
            compares neighbours.
        max_stray_px: part of the largest distance of a marker from the median of its neighbours'
            displacements.
        max_stray_ratio: the other part of that distance, in spreads of these displacements. Near
            the edge of a finger they differ by many pixels.
        rate_us: time over which the rate of a marker's events is averaged.
        n_sigma: a rate is motion if it is this many standard deviations above that of the noise.
        search: ``tiles`` finds the marker of an event in the list of the event's tile; ``all``
            compares all markers, the plain way that the lists are measured against.
        lead_px: distance by which ON events of a fast bright marker are ahead of its centre, and
            OFF events behind it: the centre of a half circle of 1.25 px plus some blur.
    """

    gate_px: float = 3.5
    r_px2: float = 10.0
    spread_px: float = 4.0
    q_x: float = 5.0
    q_v: float = 1e6
    memory_us: int = 20_000
    quiet_us: int = 150
    check_us: int = 2_000
    max_stray_px: float = 4.0
    max_stray_ratio: float = 2.0
    rate_us: int = 20_000
    n_sigma: float = 3.0
    lead_px: float = 1.0
    search: Literal["tiles", "all"] = "tiles"

    def tuning(self) -> track_kernels.Tuning:
        """Returns these settings for the kernels."""
        return track_kernels.Tuning(
            self.gate_px,
            self.r_px2,
            self.spread_px,
            self.q_x,
            self.q_v,
            self.memory_us * track_kernels.SECOND,
            self.quiet_us * track_kernels.SECOND,
            self.check_us,
            self.max_stray_px,
            self.max_stray_ratio,
            self.rate_us * track_kernels.SECOND,
            self.n_sigma,
            self.lead_px,
            self.search == "all",
        )


def make_tracks(neighbours: NDArray[np.intp], config: TrackerConfig) -> track_kernels.Tracks:
    """Returns tracks of n markers without positions.

    Args:
        neighbours: (n, 8) intp, the lattice neighbours of each, -1 where there is none.
        config: of the event filter.
    """
    n, n_tiles = len(neighbours), nearest.ROWS * nearest.COLUMNS
    return track_kernels.Tracks(
        state=np.zeros(n, track_kernels.MARKER),
        targets=nearest.Targets(
            aim_px=np.zeros((n, 2, 2)),
            near=np.zeros((nearest.CAPACITY, n_tiles), np.uint16),
            n_near=np.zeros(n_tiles, np.uint8),
            listed=np.zeros(n, nearest.PLACE),
        ),
        n_new=np.zeros(n, np.int64),
        rate_hz=np.zeros(n),
        r_px2=np.full((n, 2), config.r_px2),
        lost=np.zeros(n, np.bool_),
        rest_px=np.full((n, 2), np.nan),
        neighbours=neighbours.copy(),  # writeable, because kernels are compiled for one type only
        steps=np.zeros((n, 2)),
        steps_s=np.zeros((n, 2)),
        long_steps_s=np.zeros((n, 2)),
        moved_px_s=np.zeros((n, 2)),
        past_px=np.zeros((_PAST, n, 2)),
        past_us=np.full(_PAST, -1, np.int64),
        common=np.array(
            [(0, 0, 0, _NEVER_US, _NEVER_US, 0, 0, 0.0, 0.0, False, False, 0.0, 0.0, 0.0)],
            track_kernels.COMMON,
        ),
    )
