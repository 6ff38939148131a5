"""The sensor's pixels: events and frames of a picture of moving markers."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.source.simulator.kernels.optics import (
    COUNTS_DTYPE,
    POINT_DTYPE,
    Picture,
    draw_markers,
)
from neurotouch_hid.source.simulator.kernels.sensor import (
    LEVEL_SCALE,
    PIXEL_DTYPE,
    Chip,
    Stretch,
    run_sensor,
)
from neurotouch_hid.source.simulator.optics import (
    PROFILE_SCALE,
    LightConfig,
    compute_light,
    marker_profile,
)

TICK_US = 500  # the picture is rendered at 2 kHz: a marker at 525 px/s moves 0.26 px
WINDOW_US = 20_000  # how often leaking pixels are looked for
MAX_EVENTS = 1 << 19  # room for one call
LINEAR_DN = 20.0  # below it the photoreceptor's response is linear (v2e's lin-log)
LEAK_SPREAD = 0.23  # log units; v2e spreads the rate by 0.1 decades


@dataclass(frozen=True, slots=True)
class SensorConfig:
    """The pixels of one camera; defaults from v2e's model of a DAVIS346 unless said otherwise.

    Attributes:
        contrast: mean threshold of both polarities, log units.
        contrast_spread: its standard deviation over pixels.
        cutoff_hz: bandwidth of the photoreceptor at white, 255 DN; less in the dark.
        refractory_us: dead time after an event.
        leak_hz: rate of ON events from the leak.
        shot_hz: rate of noise events of a dark pixel.
        n_hot: pixels that fire by themselves.
        hot_hz: their rate.
        row_us: period of the row-wise readout; 0 stamps every event exactly.
        blur_px: standard deviation of the lens's point spread.
        frame_us: frame period; 40 ms [NT, "System Overview"].
        exposure_us: exposure of a frame, a multiple of 500 µs.
        read_noise_dn, gain_spread, offset_spread_dn: of the frame's pixels.
    """

    contrast: float = 0.2
    contrast_spread: float = 0.03
    cutoff_hz: float = 300.0
    refractory_us: float = 500.0
    leak_hz: float = 0.1
    shot_hz: float = 1.0
    n_hot: int = 0
    hot_hz: float = 200.0
    row_us: int = 0
    blur_px: float = 0.6
    frame_us: int = 40_000
    exposure_us: int = 10_000
    read_noise_dn: float = 1.5
    gain_spread: float = 0.015
    offset_spread_dn: float = 1.5


class Sensor:
    """Events and frames of one camera that looks at one gel."""

    def __init__(self, config: SensorConfig, light: LightConfig, rig: Rig, seed: int) -> None:
        self._config, self._seed = config, seed
        rng = np.random.default_rng((seed, 1))
        n = SENSOR_WIDTH_PX * SENSOR_HEIGHT_PX
        base, white = (image.ravel() for image in compute_light(light, rig))
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
        profile = marker_profile(config.blur_px)
        self._chip = Chip(
            Picture(canvas, np.zeros(n, np.int32), profile, PROFILE_SCALE, counts),
            pixels,
            active=np.zeros(n, np.int32),
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
        self._gain = rng.normal(1.0, config.gain_spread, n)
        self._offset = rng.normal(0.0, config.offset_spread_dn, n)
        self._n_exposed = 0

    def settle(self, knot: NDArray[np.float64]) -> None:
        """Adapts every pixel to the markers of ``knot``, (177, 6) float64."""
        knots = np.stack([knot] * 4)
        chip = self._chip
        draw_markers(knots, 0.0, chip.picture)
        places = np.arange(len(chip.levels)) / LEVEL_SCALE
        signal = np.interp(chip.picture.canvas["image"], places, chip.levels)
        chip.pixels["signal"] = signal
        # After a long time, each pixel is at a random place between its thresholds.
        chip.pixels["reference"] = signal - self._start * chip.pixels["on"]

    @property
    def n_lost(self) -> int:
        """Number of events that found no room so far."""
        return int(self._chip.counts["lost"][0])

    def run(
        self, knots: NDArray[np.float64], knot_us: int, begin_us: int, end_us: int
    ) -> tuple[NDArray[np.void], list[Frame]]:
        """Returns events and frames of a stretch of time within one knot interval.

        Args:
            knots: (4, 177, 6) float64, see ``draw_markers``.
            knot_us: length of the interval; it begins at a multiple of it.
            begin_us: start of the stretch, a multiple of 500 µs.
            end_us: its end, a multiple of 500 µs.

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
            run_sensor(knots, stretch, self._chip)
            self._n_exposed += n_ticks * exposing
            if exposing and stop_us - t_us + phase == self._config.exposure_us:
                frames.append(self._take_frame(stop_us))
            t_us = stop_us
        return self._chip.events[: self._chip.counts["events"][0]].copy(), frames

    def _take_frame(self, end_us: int) -> Frame:
        config = self._config
        canvas = self._chip.picture.canvas
        mean = canvas["base"] + canvas["exposed"] / self._n_exposed
        canvas["exposed"] = 0.0
        self._n_exposed = 0
        noise = np.random.default_rng((self._seed, 2, end_us)).standard_normal(
            len(mean), np.float32
        )
        # Photon noise grows with the root of the light; 255 DN is about 20,000 electrons.
        sigma = np.sqrt(config.read_noise_dn**2 + mean / 80.0)
        pixels = mean * self._gain + self._offset + sigma * noise
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        image = np.clip(np.rint(pixels), 0, 255).astype(np.uint8).reshape(shape)
        return Frame(image, end_us - config.exposure_us, end_us)


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
