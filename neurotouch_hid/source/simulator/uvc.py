"""A simulated UVC camera: frames without events, with the defects of such cameras."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Gel, Rig
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.source.simulator.config import LightConfig, SensorConfig, UvcConfig
from neurotouch_hid.source.simulator.kernels.optics import (
    COUNTS_DTYPE,
    POINT_DTYPE,
    Lamps,
    Picture,
    average_rows,
    draw_markers,
    shine,
)
from neurotouch_hid.source.simulator.optics import compute_light, marker_profile
from neurotouch_hid.source.simulator.sensor import ELECTRONS_PER_DN, TICK_US, USUAL_LIGHT

FULL_DN = 255.0
SERVO = 0.15  # share of the way to the wanted brightness that auto exposure goes with each frame
LEAST_GAIN, MOST_GAIN = 0.1, 16.0  # of auto exposure
VIDEO_WIDTH_PX, VIDEO_HEIGHT_PX = 640, 480  # of a clip
_SCALE = VIDEO_HEIGHT_PX / SENSOR_HEIGHT_PX
_SHIFT_PX = 0.5 * np.array(
    [
        VIDEO_WIDTH_PX - 1 - _SCALE * (SENSOR_WIDTH_PX - 1),
        VIDEO_HEIGHT_PX - 1 - _SCALE * (SENSOR_HEIGHT_PX - 1),
    ]
)
_NOTHING = np.empty(0, EVENT_DTYPE)


class UvcSensor:
    """Frames of one camera that looks at one gel; the same calls as of ``Sensor``.

    The picture is drawn every 500 µs. Each row of a frame is the mean over its own exposure, which
    a rolling shutter shifts from row to row.
    """

    n_lost = 0

    def __init__(
        self,
        config: SensorConfig,
        uvc: UvcConfig,
        light: LightConfig,
        rig: Rig,
        seed: int,
        gel: Gel,
    ) -> None:
        self._config, self._uvc, self._seed = config, uvc, seed
        n = SENSOR_WIDTH_PX * SENSOR_HEIGHT_PX
        base, white = (image.ravel() for image in compute_light(light, rig, gel))
        canvas = np.zeros(n, POINT_DTYPE)
        canvas["base"] = canvas["image"] = base
        canvas["light"] = white
        profile, scale = marker_profile(config.blur_px, gel.dot_mm)
        counts = np.zeros(1, COUNTS_DTYPE)
        touched, active = np.zeros((2, n), np.uint32)
        self._picture = Picture(canvas, touched, active, profile, scale, counts)
        rng = np.random.default_rng((seed, 1))
        shape = SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
        self._gain = rng.normal(1.0, config.gain_spread, shape)
        self._offset = rng.normal(0.0, config.offset_spread_dn, shape)
        self._weights = weigh_ticks(config.exposure_us, uvc.readout_us)
        self._span_us = TICK_US * self._weights.shape[1]
        self._ticks = np.zeros((self._weights.shape[1], *shape), np.float32)
        self._auto_gain = 1.0

    def settle(self, knot: NDArray[np.float64], lamps: Lamps) -> None:
        """Draws the markers of ``knot``, (n, 6) float64, in a light."""
        self._draw(np.stack([knot] * 4), lamps, 0, 0.0)

    @property
    def picture_dn(self) -> NDArray[np.float32]:
        """The picture on the sensor now, (260, 346) float32."""
        image = self._picture.canvas["image"]
        return np.asarray(image.reshape(SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.float32)

    def run(
        self,
        knots: NDArray[np.float64],
        knot_us: int,
        begin_us: int,
        end_us: int,
        lamps: Lamps = USUAL_LIGHT,
    ) -> tuple[NDArray[np.void], list[Frame]]:
        """Returns no events, and the frames whose last row was read in a stretch of time.

        Args:
            knots: (4, n, 6) float64, see ``draw_markers``.
            knot_us: length of the interval; it begins at a multiple of it.
            begin_us: start of the stretch, a multiple of 500 µs.
            end_us: its end, a multiple of 500 µs.
            lamps: the light of the interval.
        """
        frames, n_ticks = [], knot_us // TICK_US
        for t_us in range(begin_us, end_us, TICK_US):
            phase_us = t_us % self._config.frame_us
            is_last = t_us + TICK_US == end_us
            # A frame may still be read while the next one is exposed.
            is_exposing = phase_us < self._span_us or self._span_us > self._config.frame_us
            if is_exposing or is_last:
                tick = t_us % knot_us // TICK_US
                self._draw(knots, lamps, tick, (tick + 1) / n_ticks)
                self._ticks[t_us // TICK_US % len(self._ticks)] = self.picture_dn
            start_us = t_us + TICK_US - self._span_us
            if start_us >= 0 and start_us % self._config.frame_us == 0:
                frames.append(self._take_frame(start_us))
        return _NOTHING, frames

    def _draw(self, knots: NDArray[np.float64], lamps: Lamps, tick: int, u: float) -> None:
        draw_markers(knots, u, self._picture)
        if lamps.changes:
            shine(self._picture, lamps, tick, u)

    def _take_frame(self, start_us: int) -> Frame:
        config, uvc = self._config, self._uvc
        first = start_us // TICK_US % len(self._ticks)
        light = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX))
        average_rows(self._weights, self._ticks, first, light)
        noise = np.random.default_rng((self._seed, 2, start_us)).standard_normal(
            light.shape, np.float32
        )
        sigma = np.sqrt(config.read_noise_dn**2 + light / ELECTRONS_PER_DN)
        seen = config.frame_gain * light * self._gain + sigma * noise
        linear = np.clip(self._auto_gain * seen + self._offset, 0.0, FULL_DN)
        pixels = np.rint(FULL_DN * (linear / FULL_DN) ** (1.0 / uvc.gamma)).astype(np.uint8)
        if uvc.auto_exposure_dn:
            # The camera measures what it sends, one frame late, and goes a part of the way.
            change = (uvc.auto_exposure_dn / max(float(pixels.mean()), 1.0)) ** uvc.gamma
            wanted = self._auto_gain * change**SERVO
            self._auto_gain = min(max(wanted, LEAST_GAIN), MOST_GAIN)
        if uvc.jpeg_quality:
            import cv2  # noqa: PLC0415  # 60 MB, which no other simulation needs

            quality = [cv2.IMWRITE_JPEG_QUALITY, uvc.jpeg_quality]
            packed = cv2.imencode(".jpg", pixels, quality)[1]
            pixels = np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), np.uint8)
        middle_us = start_us + uvc.readout_us // 2  # of the middle row
        return Frame(pixels, middle_us, middle_us + config.exposure_us)


def weigh_ticks(exposure_us: int, readout_us: int) -> NDArray[np.float64]:
    """Returns the share of each tick in the mean of each row, (260, k) float64; rows sum to 1.

    Args:
        exposure_us: of each row.
        readout_us: from the start of the first row's exposure to that of the last row.
    """
    n = math.ceil((exposure_us + readout_us) / TICK_US)
    begin_us = np.linspace(0.0, readout_us, SENSOR_HEIGHT_PX)[:, None]
    ticks_us = TICK_US * np.arange(n)
    first = np.maximum(begin_us, ticks_us)
    last = np.minimum(begin_us + exposure_us, ticks_us + TICK_US)
    weights: NDArray[np.float64] = np.maximum(last - first, 0.0) / exposure_us
    return weights


def enlarge(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Returns a picture (480, 640) of a frame (260, 346), in the middle and as high."""
    import cv2  # noqa: PLC0415  # as above

    rows = np.array([(_SCALE, 0.0, _SHIFT_PX[0]), (0.0, _SCALE, _SHIFT_PX[1])])
    flags, border = cv2.INTER_CUBIC, cv2.BORDER_REPLICATE
    return np.asarray(
        cv2.warpAffine(
            pixels, rows, (VIDEO_WIDTH_PX, VIDEO_HEIGHT_PX), flags=flags, borderMode=border
        )
    )


def enlarge_points(points_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns where points of a frame, (n, 2) px, are in its enlarged picture."""
    return points_px * _SCALE + _SHIFT_PX
