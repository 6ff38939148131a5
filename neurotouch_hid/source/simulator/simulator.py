"""A camera that looks at a gel under fingers, with the truth beside every packet."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from neurotouch_hid.closing import Closing
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame, Truth
from neurotouch_hid.source.simulator.gel import KNOT_US, GelConfig, GelMotion
from neurotouch_hid.source.simulator.optics import CameraConfig, CameraModel, LightConfig
from neurotouch_hid.source.simulator.script import Play
from neurotouch_hid.source.simulator.sensor import Sensor, SensorConfig


@dataclass(frozen=True, slots=True)
class SimulatorConfig:
    """One simulated set-up: gel, camera, pixels, light."""

    gel: GelConfig = field(default_factory=GelConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
    sensor: SensorConfig = field(default_factory=SensorConfig)
    light: LightConfig = field(default_factory=LightConfig)


class Simulator(Closing):
    """Plays a script; iterating gives equal slices of sensor time from 0 on.

    Events and frames depend on script, config and seed only, bit for bit, not on ``slice_us``.
    An endless script never ends; other scripts end with the slice that completes them.
    """

    is_live = False
    is_simulated = True

    rig: Rig | None = None  # found from the picture, as with a real camera

    def __init__(
        self,
        script: Play,
        config: SimulatorConfig | None = None,
        *,
        seed: int = 0,
        slice_us: int = 10_000,
    ) -> None:
        config = config or SimulatorConfig()
        self.name = f"sim:{script.name}"
        self._script, self._slice_us = script, slice_us
        rig = config.camera.rig
        self._motion = GelMotion(script, CameraModel(config.camera), rig.px_per_mm, config.gel)
        self._sensor = Sensor(config.sensor, config.light, rig, seed)
        self._sensor.settle(self._motion.knot(-1).outline)
        self._packets = self._run()

    def __iter__(self) -> Iterator[EventPacket]:
        return self._packets

    def close(self) -> None:
        """Does nothing: there is nothing to close."""

    def truth(self, t_us: int) -> Truth:
        """Returns the truth at ``t_us``; cheap up to a few seconds before the newest packet."""
        return self._motion.truth(t_us)

    def _run(self) -> Iterator[EventPacket]:
        events, frames = np.empty(0, EVENT_DTYPE), list[Frame]()
        made_us = t_us = n_lost = 0
        while self._script.endless or t_us < self._script.duration_us:
            end_us = t_us + self._slice_us
            parts = [events]
            while made_us < end_us:
                index = made_us // KNOT_US
                knots = np.stack([self._motion.knot(index + k).outline for k in (-1, 0, 1, 2)])
                new, taken = self._sensor.run(knots, KNOT_US, made_us, made_us + KNOT_US)
                parts.append(new)
                frames += taken
                made_us += KNOT_US
            events = np.concatenate(parts)
            cut = int(np.searchsorted(events["t"], end_us))
            n_frames = sum(frame.exposure_end_us < end_us for frame in frames)
            gap, n_lost = self._sensor.n_lost - n_lost, self._sensor.n_lost
            yield EventPacket(t_us, end_us, events[:cut], tuple(frames[:n_frames]), gap)
            events, frames = events[cut:], frames[n_frames:]
            t_us = end_us
