"""Workload of the live benchmark: a simulated hand, and any number of events."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import takewhile
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.closing import Closing
from neurotouch_hid.evaluation.speed.kernels.event_load import fill_slice
from neurotouch_hid.events import shift_packet
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
)
from neurotouch_hid.source.simulator import Simulator, find_scene, scene_config

TOUR_US: Final = 18_860_000
"""One tour of all gestures, from rest to rest."""
SPREAD_PX: Final = 1.2
"""Spread of the events around a marker, one axis."""

_POOL: Final = 1 << 14  # numbers that are drawn once and used in turn
_MARGIN_PX: Final = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class LoopScene:
    """Slices of one length in a row; the gel ends as it begins.

    Attributes:
        packets: n slices.
        markers_px: (n, m, 2) float32, true places of the markers in the middle of each.
    """

    packets: tuple[EventPacket, ...]
    markers_px: NDArray[np.float32]


@cache
def load_scene(
    name: str, slice_us: int, length_us: int = TOUR_US, *, is_noisy: bool = True
) -> LoopScene:
    """Returns the first slices of a scene of the simulator.

    Args:
        name: name of the scene.
        slice_us: length of a slice.
        length_us: length of all slices together.
        is_noisy: with the noise of the sensor; without, only light that changes makes events.
    """
    packets, markers = [], []
    config = scene_config(name)
    if not is_noisy:
        config = replace(config, sensor=replace(config.sensor, shot_hz=0.0, leak_hz=0.0))
    with Simulator(find_scene(name), config, slice_us=slice_us) as simulator:
        for packet in takewhile(lambda packet: packet.t_end_us <= length_us, simulator):
            packets.append(packet)
            markers.append(simulator.truth(packet.t_begin_us + slice_us // 2).markers_px)
    return LoopScene(tuple(packets), np.array(markers, np.float32))


class DenseSource(Closing):
    """Repeats a scene for any time, with any number of events.

    Each slice is made when it is needed. It has its own events in their order. Additional events
    fill it to the wanted number. Their random order is the hardest for the caches; they lie evenly
    on all sides of a marker, so they do not move it.

    Args:
        scene: the scene.
        seconds: sensor time of the whole.
        events_per_s: wanted rate of events; if None, the scene's own events only.
        seed: seed of the random numbers.

    Attributes:
        seconds: sensor time of the whole.
        slice_us: length of a slice.
    """

    is_live = False
    is_simulated = True

    name = "dense"
    rig: Rig | None = None

    def __init__(
        self, scene: LoopScene, seconds: float, events_per_s: float | None = None, seed: int = 0
    ) -> None:
        self._packets = scene.packets
        self.seconds = seconds
        self.slice_us = scene.packets[0].t_end_us - scene.packets[0].t_begin_us
        self._n = math.ceil(seconds * 1e6 / self.slice_us)
        self._n_events = 0
        if events_per_s is not None:
            self._n_events = round(events_per_s * self.slice_us / 1e6)
            most_px = np.array([SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX]) - _MARGIN_PX
            self._markers_px = np.clip(scene.markers_px, _MARGIN_PX, most_px).astype(np.float32)
            rng = np.random.default_rng(seed)
            self._marker = rng.integers(scene.markers_px.shape[1], size=_POOL, dtype=np.int32)
            off_px = rng.normal(0.0, SPREAD_PX, (_POOL, 2)).clip(1.0 - _MARGIN_PX, _MARGIN_PX - 1.0)
            self._off_px = (off_px + 0.5).astype(
                np.float32
            )  # so that cutting off the fraction rounds
            self._is_on = rng.random(_POOL) < 0.5
            self._make(0, self._packets[0], 0)  # compiles or loads the kernel

    def __iter__(self) -> Iterator[EventPacket]:
        for k in range(self._n):
            packet = self._packets[k % len(self._packets)]
            begin_us = self._packets[0].t_begin_us + k * self.slice_us
            shift_us = begin_us - packet.t_begin_us
            events = self._make(k, packet, shift_us) if self._n_events else None
            yield shift_packet(packet, shift_us, events)

    def _make(self, k: int, packet: EventPacket, shift_us: int) -> NDArray[np.void]:
        events = np.empty(self._n_events, EVENT_DTYPE)
        fill_slice(
            packet.events,
            shift_us,
            packet.t_begin_us + shift_us,
            self.slice_us,
            self._markers_px[k % len(self._packets)],
            self._marker,
            self._off_px,
            self._is_on,
            k * self._n_events,
            events,
        )
        return events

    def close(self) -> None:
        """Does nothing: there is nothing to close."""
