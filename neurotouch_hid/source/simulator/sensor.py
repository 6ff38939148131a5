"""The sensor's pixels: events and frames of a picture of moving markers."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.events import copy_events, pick_events
from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.source.simulator.config import LightConfig, SensorConfig
from neurotouch_hid.source.simulator.kernels.optics import (
    COUNTS_DTYPE,
    POINT_DTYPE,
    Lamps,
    Picture,
    draw_markers,
    read_frame,
    shine,
)
from neurotouch_hid.source.simulator.kernels.sensor import (
    LEVEL_SCALE,
    PIXEL_DTYPE,
    Chip,
    Stretch,
    run_sensor,
)
from neurotouch_hid.source.simulator.optics import compute_light, marker_profile

TICK_US = 500  # the picture is rendered at 2 kHz: a marker at 525 px/s moves 0.26 px
WINDOW_US = 20_000  # how often leaking pixels are looked for
MAX_EVENTS = 1 << 19  # room for one call
READ_PER_US = 12  # events that a DAVIS-346 can send
ELECTRONS_PER_DN = 80.0  # photon noise grows with the root of the light: 255 DN are 20,000
LINEAR_DN = 20.0  # below it the photoreceptor's response is linear (v2e's lin-log)
_ONE = np.ones((2, 1), np.float32)
USUAL_LIGHT = Lamps(False, np.ones(1), np.zeros(1), _ONE[0], _ONE)
LEAK_SPREAD = 0.23  # log units; v2e spreads the rate by 0.1 decades


class Sensor:
    """Events and frames of one camera that looks at one gel."""

    def __init__(
        self,
        config: SensorConfig,
        light: LightConfig,
        rig: Rig,
        seed: int,
        gel: Gel = PAPER_GEL,
    ) -> None:
        self._config, self._seed = config, seed
        rng = np.random.default_rng((seed, 1))
        n = SENSOR_WIDTH_PX * SENSOR_HEIGHT_PX
        base, white = (image.ravel() for image in compute_light(light, rig, gel))
        canvas = np.zeros(n, POINT_DTYPE)
        canvas["base"] = canvas["image"] = base
        canvas["light"] = white
        pixels = np.zeros(n, PIXEL_DTYPE)
        thresholds = rng.normal(config.contrast, config.contrast_spread, (2, n))
        pixels["on"], pixels["off"] = np.maximum(thresholds, 0.05)
        leak = config.leak_hz * config.contrast * 1e-6
        pixels["leak"] = leak * rng.lognormal(0.0, LEAK_SPREAD, n)
        pixels["free_us"] = -np.inf
        self._start = rng.random(n)
        levels, gains = response_tables(config.cutoff_hz)
        counts = np.zeros(1, COUNTS_DTYPE)
        profile, profile_scale = marker_profile(config.blur_px, gel.dot_mm)
        touched, active = np.zeros((2, n), np.uint32)
        self._chip = Chip(
            Picture(canvas, touched, active, profile, profile_scale, counts),
            pixels,
            levels=levels,
            gains=gains,
            refractory_us=config.refractory_us,
            hot=rng.choice(n, config.n_hot, replace=False).astype(np.int32),
            hot_hz=config.hot_hz,
            shot_hz=config.shot_hz,
            random=rng.integers(0, 1 << 63, 1).astype(np.uint64),
            row_us=config.row_us,
            events=np.zeros(MAX_EVENTS, EVENT_DTYPE),
            counts=counts,
        )
        spread = np.array([[config.gain_spread], [config.offset_spread_dn]])
        self._pattern = rng.normal([[1.0], [0.0]], spread, (2, n))
        self._n_exposed = 0

    def settle(self, knot: NDArray[np.float64], lamps: Lamps) -> None:
        """Adapts every pixel to the markers of ``knot``, (n, 6) float64, in a light."""
        knots = np.stack([knot] * 4)
        chip = self._chip
        draw_markers(knots, 0.0, chip.picture)
        if lamps.changes:
            shine(chip.picture, lamps, 0, 0.0)
        places = np.arange(len(chip.levels)) / LEVEL_SCALE
        signal = np.interp(chip.picture.canvas["image"], places, chip.levels)
        chip.pixels["signal"] = signal
        # No signal changes any more. Events of one moment come in the order in which pixels become
        # active, so without this a few of them would come in another one.
        chip.picture.canvas["is_active"], chip.counts["active"] = False, 0
        # After a long time, each pixel is at a random place between its thresholds.
        chip.pixels["reference"] = signal - self._start * chip.pixels["on"]

    @property
    def picture_dn(self) -> NDArray[np.float32]:
        """The picture on the sensor now, (260, 346) float32."""
        image = self._chip.picture.canvas["image"]
        return np.asarray(image.reshape(SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.float32)

    @property
    def n_lost(self) -> int:
        """Number of events that found no room so far."""
        return int(self._chip.counts["lost"][0])

    def run(
        self,
        knots: NDArray[np.float64],
        knot_us: int,
        begin_us: int,
        end_us: int,
        lamps: Lamps = USUAL_LIGHT,
    ) -> tuple[NDArray[np.void], list[Frame]]:
        """Returns events and frames of a stretch of time within one knot interval.

        Args:
            knots: (4, n, 6) float64, see ``draw_markers``.
            knot_us: length of the interval; it begins at a multiple of it.
            begin_us: start of the stretch, a multiple of 500 µs.
            end_us: its end, a multiple of 500 µs.
            lamps: the light of the interval.

        Returns:
            (n,) EVENT_DTYPE ascending in time, and the frames whose exposure ended in the stretch.
        """
        self._chip.counts["events"] = 0
        frames = []
        t_us = begin_us
        moving = not all(np.array_equal(knots[0], knot) for knot in knots[1:])
        while t_us < end_us:
            phase = t_us % self._config.frame_us
            exposing = phase < self._config.exposure_us
            edge = self._config.exposure_us if exposing else self._config.frame_us
            stop_us = min(end_us, t_us - phase + edge)
            n_ticks = (stop_us - t_us) // TICK_US
            stretch = Stretch(
                t_us,
                TICK_US,
                first_tick=t_us % knot_us // TICK_US,
                n_ticks=n_ticks,
                ticks_per_knot=knot_us // TICK_US,
                window_us=WINDOW_US,
                moving=moving,
                exposing=exposing,
            )
            run_sensor(knots, stretch, lamps, self._chip)
            self._n_exposed += n_ticks * exposing
            if exposing and stop_us - t_us + phase == self._config.exposure_us:
                frames.append(self._take_frame(stop_us))
            t_us = stop_us
        events = copy_events(self._chip.events[: self._chip.counts["events"][0]])
        return self._read_out(events, begin_us, end_us), frames

    def _read_out(self, events: NDArray[np.void], begin_us: int, end_us: int) -> NDArray[np.void]:
        """Returns as many events as the chip can send in this time; a flood loses some of all."""
        most = READ_PER_US * (end_us - begin_us)
        if len(events) <= most:
            return events
        rng = np.random.default_rng((self._seed, 3, begin_us))
        return pick_events(events, np.sort(rng.choice(len(events), most, replace=False)))

    def _take_frame(self, end_us: int) -> Frame:
        config, rng = self._config, np.random.default_rng((self._seed, 2, end_us))
        pixels = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
        read_frame(
            self._chip.picture.canvas,
            self._n_exposed,
            config.read_noise_dn**2,
            ELECTRONS_PER_DN,
            config.frame_gain,
            self._pattern,
            rng.standard_normal(pixels.size, np.float32),
            pixels.ravel(),
        )
        self._n_exposed = 0
        return Frame(pixels, end_us - config.exposure_us, end_us)


def response_tables(cutoff_hz: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Returns tables over intensity: the photoreceptor's level, and its low-pass share per tick.

    The corner of the low pass grows with intensity, from a thirteenth in the dark to ``cutoff_hz``.

    Returns:
        Two (m,) float32; index is intensity in DN times LEVEL_SCALE.
    """
    dn = np.arange(int(300 * LEVEL_SCALE)) / LEVEL_SCALE
    levels = np.where(
        dn < LINEAR_DN, dn * math.log(LINEAR_DN) / LINEAR_DN, np.log(np.maximum(dn, LINEAR_DN))
    )
    corner_hz = cutoff_hz * (dn + 20.0) / 275.0
    gains = 1.0 - np.exp(-2e-6 * np.pi * corner_hz * TICK_US)
    return levels.astype(np.float32), gains.astype(np.float32)
