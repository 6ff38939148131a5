"""Chooses among the pictures that a camera offers."""

from collections.abc import Iterable
from fractions import Fraction
from typing import Final, NamedTuple

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.video.capture import CaptureDevice
from neurotouch_hid.source.video.config import VideoConfig
from neurotouch_hid.source.video.formats import COMPRESSED, KNOWN

LEAST_WIDTH_PX: Final = 320
USEFUL_WIDTH_PX: Final = 1_280
"""More pixels than this only cost time: the pipeline's picture is 346 px wide."""
UNSTATED: Final = Fraction(1, 30)
"""The interval that is assumed of a camera that does not state any."""


class Mode(NamedTuple):
    """One kind of pictures that a camera offers.

    Attributes:
        fourcc: V4L2's four letters of the format.
        width: in px.
        height: in px.
        interval: time from picture to picture, s.
    """

    fourcc: str
    width: int
    height: int
    interval: Fraction

    @property
    def fps(self) -> float:
        """Pictures/s."""
        return float(1 / self.interval)

    def __str__(self) -> str:
        return f"{self.width}x{self.height} {self.fourcc} at {self.fps:g} pictures/s"


def list_modes(device: CaptureDevice) -> list[Mode]:
    """Returns all modes of a camera whose pictures can be read."""
    modes = []
    for fourcc in device.list_formats():
        if fourcc not in KNOWN:
            continue
        for width, height in device.list_sizes(fourcc):
            intervals = device.list_intervals(fourcc, width, height) or [UNSTATED]
            modes += [Mode(fourcc, width, height, interval) for interval in intervals]
    return modes


def choose_mode(modes: Iterable[Mode], config: VideoConfig) -> Mode:
    """Returns the mode with the most pictures/s, among those that the settings allow.

    Of several, the one with the most pixels up to ``USEFUL_WIDTH_PX``, without compression if
    there is one.

    Args:
        modes: all that the camera offers.
        config: what ``camera.yaml`` asks for.

    Raises:
        CameraError: no mode is wide enough, or none is as the settings ask.
    """
    modes = list(modes)
    wide = [mode for mode in modes if mode.width >= LEAST_WIDTH_PX]
    fitting = [mode for mode in wide if _fits(mode, config)]
    if fitting:
        return max(fitting, key=_rate)
    if wide:
        near = sorted({f"{mode.width}x{mode.height} {mode.fourcc}" for mode in wide})
        raise CameraError(
            "The camera offers no pictures as camera.yaml asks for them (video: width, height, "
            "fps, format).",
            hint=f"It offers: {', '.join(near[:8])}{' and others' if len(near) > 8 else ''}.",
        )
    raise CameraError(
        f"The camera offers no pictures that can be read and are {LEAST_WIDTH_PX} px wide.",
        hint=f"Formats that can be read: {', '.join(KNOWN)}.",
    )


def _fits(mode: Mode, config: VideoConfig) -> bool:
    return (
        config.width in (None, mode.width)
        and config.height in (None, mode.height)
        and config.format in (None, mode.fourcc)
        and (config.fps is None or mode.fps <= config.fps + 0.5)
    )


def _rate(mode: Mode) -> tuple[float, bool, int, bool]:
    is_useful = mode.width <= USEFUL_WIDTH_PX
    pixels = mode.width * mode.height
    return (
        round(mode.fps, 1),
        is_useful,
        pixels if is_useful else -pixels,
        mode.fourcc not in COMPRESSED,
    )
