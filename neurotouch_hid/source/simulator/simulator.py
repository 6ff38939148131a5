"""A camera that looks at a gel under fingers, with the truth beside every packet."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from neurotouch_hid.closing import Closing
from neurotouch_hid.events import join_events
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame, Truth
from neurotouch_hid.source.simulator.clock import Clock
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.field_table import FieldTable
from neurotouch_hid.source.simulator.gel import KNOT_US, FieldMotion, GelMotion
from neurotouch_hid.source.simulator.knot import make_dots
from neurotouch_hid.source.simulator.nuisances import disturb
from neurotouch_hid.source.simulator.optics import CameraModel
from neurotouch_hid.source.simulator.script import Play
from neurotouch_hid.source.simulator.sensor import Sensor
from neurotouch_hid.source.simulator.setup import Piece, Setup
from neurotouch_hid.source.simulator.uvc import UvcSensor
from neurotouch_hid.source.simulator.view import View


class Simulator(Closing):
    """Plays a script; iterating gives equal slices of sensor time from 0 on.

    Events and frames depend on script, config, nuisances and seed only, bit for bit, not on
    ``slice_us``. An endless script never ends; other scripts end with the slice that completes
    them.

    Args:
        script: the fingers.
        config: gel, camera, pixels, light.
        nuisances: strength of each nuisance, by its name.
        seed: of all that is random.
        slice_us: length of a packet.
    """

    is_live = False
    is_simulated = True

    rig: Rig | None = None  # found from the picture, as with a real camera

    def __init__(
        self,
        script: Play,
        config: SimulatorConfig | None = None,
        *,
        nuisances: Mapping[str, float] | None = None,
        seed: int = 0,
        slice_us: int = 10_000,
    ) -> None:
        config = config or SimulatorConfig()
        gel = config.gel.layout
        dots = make_dots(gel, config.gel.missing)
        setup = disturb(Setup(script, config, seed, dots), nuisances or {})
        self.name = f"sim:{script.name}"
        self._script, self._slice_us, self._wires = setup.script, slice_us, setup.wires
        config = setup.config
        self._frame_us = config.sensor.frame_us, config.sensor.exposure_us
        self._late_us = config.uvc.readout_us // 2 if config.uvc else 0  # of the middle row
        camera = CameraModel(config.camera, gel)
        about = camera, config.gel, setup.dots, setup.mount
        self._motion: GelMotion = (
            FieldMotion(setup.script, *about)
            if isinstance(setup.script, FieldTable)
            else GelMotion(setup.script, *about)
        )
        self._view = View(self._motion, setup)
        parts = config.light, config.camera.rig, seed, gel
        self._sensor: Sensor | UvcSensor = (
            UvcSensor(config.sensor, config.uvc, *parts)
            if config.uvc
            else Sensor(config.sensor, *parts)
        )
        self._sensor.settle(self._view.outline(-1), self._view.light(-1))
        self._clock = Clock(setup.clock)
        self._packets = self._run()

    def __iter__(self) -> Iterator[EventPacket]:
        return self._packets

    def close(self) -> None:
        """Does nothing: there is nothing to close."""

    def truth(self, t_us: int) -> Truth:
        """Returns the truth at ``t_us``; cheap up to a few seconds before the newest packet."""
        truth = self._motion.truth(self._clock.find_moment(t_us))
        return truth if not self._clock.changes else replace(truth, t_us=t_us)

    def find_labelled_times(self, packet: EventPacket) -> list[int]:
        """Returns at which stamps within a packet the gesture is labelled.

        They are the middles of the exposures of a camera that loses no frame.
        """
        begin_us = self._clock.find_moment(packet.t_begin_us)
        end_us = begin_us + packet.t_end_us - packet.t_begin_us
        since_us = self._clock.find_last_change(begin_us)
        period_us, exposure_us = self._frame_us
        exposed = range(begin_us // period_us - 3, end_us // period_us + 1)
        starts_us = [k * period_us + self._late_us for k in exposed]
        return [
            start_us + exposure_us // 2 + packet.t_begin_us - begin_us
            for start_us in starts_us
            if start_us >= since_us + self._late_us and begin_us <= start_us + exposure_us < end_us
        ]

    def _run(self) -> Iterator[EventPacket]:
        events, frames = np.empty(0, EVENT_DTYPE), list[Frame]()
        made_us = t_us = n_lost = 0
        while self._script.endless or t_us < self._script.duration_us:
            end_us = self._clock.cut(t_us, t_us + self._slice_us)
            parts = [events]
            while made_us < end_us + self._late_us:  # a rolling shutter reads the last row later
                piece = self._sense(made_us // KNOT_US)
                parts.append(piece.events)
                frames += piece.frames
                made_us += KNOT_US
            events = join_events(parts)
            cut = int(np.searchsorted(events["t"], end_us))
            n_frames = sum(frame.exposure_end_us < end_us for frame in frames)
            gap, n_lost = self._sensor.n_lost - n_lost, self._sensor.n_lost
            packet = EventPacket(t_us, end_us, events[:cut], tuple(frames[:n_frames]), gap)
            if not self._clock.changes:
                yield packet
            elif self._clock.arrives(t_us):
                yield self._clock.stamp(packet)
            events, frames = events[cut:], frames[n_frames:]
            t_us = end_us

    def _sense(self, index: int) -> Piece:
        """Returns what the sensor sends between two knots."""
        begin_us, end_us = index * KNOT_US, (index + 1) * KNOT_US
        knots = np.stack([self._view.outline(index + k) for k in (-1, 0, 1, 2)])
        light = self._view.light(index)
        events, frames = self._sensor.run(knots, KNOT_US, begin_us, end_us, light)
        piece = Piece(begin_us, end_us, events, tuple(frames), self._sensor.picture_dn)
        for wire in self._wires:
            piece = wire(piece)
        return piece
