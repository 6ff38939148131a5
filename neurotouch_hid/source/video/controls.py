"""Fixes exposure, gain, white balance and focus of a camera, so that only the gel changes."""

from dataclasses import dataclass
from typing import Final

from neurotouch_hid.source.video import v4l2
from neurotouch_hid.source.video.capture import CaptureDevice
from neurotouch_hid.source.video.config import VideoConfig

EXPOSURE_UNIT_US: Final = 100
"""V4L2's unit of ``exposure_time_absolute``."""
SHORT_US: Final = 4_000
"""The exposure where none avoids flicker, as of the DAVIS: more only smears moving dots."""
_MOST_OF_INTERVAL: Final = 0.9
"""A camera needs some of the time from picture to picture to read the picture out."""
_LINE_FREQUENCIES: Final = {0: 0, 50: 1, 60: 2}
"""The values of V4L2's ``power_line_frequency``, by Hz."""

CONTROLS: Final = {
    "auto_white_balance": v4l2.CID_AUTO_WHITE_BALANCE,
    "exposure": v4l2.CID_EXPOSURE,
    "autogain": v4l2.CID_AUTOGAIN,
    "gain": v4l2.CID_GAIN,
    "power_line_frequency": v4l2.CID_POWER_LINE_FREQUENCY,
    "exposure_auto": v4l2.CID_EXPOSURE_AUTO,
    "exposure_absolute": v4l2.CID_EXPOSURE_ABSOLUTE,
    "exposure_auto_priority": v4l2.CID_EXPOSURE_AUTO_PRIORITY,
    "focus_absolute": v4l2.CID_FOCUS_ABSOLUTE,
    "focus_auto": v4l2.CID_FOCUS_AUTO,
}
"""All controls that this driver knows, by V4L2's names."""


@dataclass(frozen=True, slots=True)
class FixedControls:
    """The settings that a camera took, and those that it lacks.

    Attributes:
        exposure_us: the exposure; None if the camera does not say.
        lacking: what could not be fixed, a sentence each.
    """

    exposure_us: int | None
    lacking: tuple[str, ...]


def fix_controls(device: CaptureDevice, config: VideoConfig, interval_us: float) -> FixedControls:
    """Fixes everything that a camera would change by itself.

    Args:
        device: the camera, before it streams.
        config: what ``camera.yaml`` asks for.
        interval_us: time from picture to picture.

    Raises:
        CameraGoneError: the camera is gone.
    """
    lacking = []
    exposure_us = _fix_exposure(device, choose_exposure(config, interval_us))
    own = device.get_control(v4l2.CID_EXPOSURE) if exposure_us is None else None
    if own is not None and device.get_control(v4l2.CID_EXPOSURE_AUTO) == v4l2.EXPOSURE_MANUAL:
        # A PS3 Eye and other cameras of the kernel's gspca drivers, which count lines.
        lacking.append(
            f"Its exposure is fixed at {own} in the camera's own unit, so its length is unknown."
        )
    elif exposure_us is None:
        lacking.append(
            "It has no fixed exposure, so its pictures may become brighter or darker by themselves."
        )
        if not device.set_control(v4l2.CID_EXPOSURE_AUTO_PRIORITY, 0):
            lacking.append("It may send fewer pictures in dim light: no control forbids it.")
    elif config.exposure_us is not None and abs(exposure_us - config.exposure_us) > max(
        EXPOSURE_UNIT_US, config.exposure_us // 10
    ):
        lacking.append(
            f"It exposes for {exposure_us} µs, not the {config.exposure_us} µs of camera.yaml."
        )
    device.set_control(v4l2.CID_AUTOGAIN, 0)
    gain = device.find_control(v4l2.CID_GAIN)
    wanted = 0 if gain is None else gain.usual if config.gain is None else gain.clip(config.gain)
    if gain is None or not device.set_control(v4l2.CID_GAIN, wanted):
        lacking.append("Its gain cannot be fixed.")
    if not device.set_control(v4l2.CID_AUTO_WHITE_BALANCE, 0):
        lacking.append("Its white balance cannot be fixed.")
    if not device.set_control(v4l2.CID_FOCUS_AUTO, 0):
        lacking.append("Its focus has no control: turn its lens by hand, if it can be turned.")
    line = _LINE_FREQUENCIES.get(config.mains_hz, 0)
    is_steady = exposure_us is not None and is_flicker_free(exposure_us, config.mains_hz)
    if not device.set_control(v4l2.CID_POWER_LINE_FREQUENCY, line) and not is_steady:
        lacking.append("It has no control against the flicker of lamps.")
    return FixedControls(exposure_us, tuple(lacking))


def choose_exposure(config: VideoConfig, interval_us: float) -> int:
    """Returns the exposure to ask for, µs: the settings', or one in which lamps do not flicker.

    A lamp on the mains is bright twice in each period, so an exposure of whole half periods always
    gets the same light. Where the time from picture to picture is too short for one of them, the
    exposure is short.

    Args:
        config: what ``camera.yaml`` asks for.
        interval_us: time from picture to picture.
    """
    most_us = int(_MOST_OF_INTERVAL * interval_us)
    if config.exposure_us is not None:
        return config.exposure_us
    if config.mains_hz and (half_us := round(500_000 / config.mains_hz)) <= most_us:
        return half_us
    return min(SHORT_US, most_us)


def is_flicker_free(exposure_us: int, mains_hz: int) -> bool:
    """Returns whether an exposure takes whole half periods of the mains, within one unit."""
    if not mains_hz:
        return True
    half_us = 500_000 / mains_hz
    halves = round(exposure_us / half_us)
    return halves > 0 and abs(exposure_us - halves * half_us) <= EXPOSURE_UNIT_US


def _fix_exposure(device: CaptureDevice, exposure_us: int) -> int | None:
    """Fixes the exposure; returns the one that the camera agreed to, or None if it has none."""
    device.set_control(v4l2.CID_EXPOSURE_AUTO, v4l2.EXPOSURE_MANUAL)
    device.set_control(v4l2.CID_EXPOSURE_AUTO_PRIORITY, 0)
    scale = device.find_control(v4l2.CID_EXPOSURE_ABSOLUTE)
    if scale is None:
        return None
    value = scale.clip(exposure_us / EXPOSURE_UNIT_US)
    if not device.set_control(v4l2.CID_EXPOSURE_ABSOLUTE, value):
        return None
    answer = device.get_control(v4l2.CID_EXPOSURE_ABSOLUTE)
    agreed = value if answer is None or not scale.least <= answer <= scale.most else answer
    return max(agreed, 0) * EXPOSURE_UNIT_US
