"""A camera that is set up and streams: grey pictures with stamps."""

from pathlib import Path
from typing import Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import CameraError
from neurotouch_hid.recording import Picture
from neurotouch_hid.source.video.capture import CaptureDevice
from neurotouch_hid.source.video.config import VideoConfig
from neurotouch_hid.source.video.controls import fix_controls
from neurotouch_hid.source.video.formats import COMPRESSED, KNOWN, GreyReader
from neurotouch_hid.source.video.modes import Mode, choose_mode, list_modes
from neurotouch_hid.source.video.picture_stream import PictureStream
from neurotouch_hid.source.video.v4l2 import Linux

_USUAL_EXPOSURE_US: Final = 8_000
"""Assumed of a camera that does not state its exposure."""


class VideoCamera(Closing):
    """An open camera, set up as the settings ask; it streams from ``start`` on.

    Args:
        node: its device node.
        config: the settings.
        linux: the calls into Linux.

    Attributes:
        name: its name.
        bus_info: where it is plugged in.
        mode: the pictures that it agreed to send.
        exposure_us: their exposure; None if it does not say.
        lacking: what could not be fixed, a sentence each.
        stamp_us: the stamp of the newest picture, µs of CLOCK_MONOTONIC.
        n_lost: pictures that were lost so far.
        n_damaged: pictures that came, but could not be read.
        n_unstamped: pictures without a usable stamp; their time is estimated from their arrival.

    Raises:
        CameraError: it cannot be opened or set up.
    """

    def __init__(self, node: Path, config: VideoConfig, linux: Linux | None = None) -> None:
        self.stamp_us = self.n_lost = self.n_damaged = self.n_unstamped = 0
        self._device = device = CaptureDevice(node, linux)
        self._stream: PictureStream | None = None
        try:
            if not device.is_camera:
                raise CameraError(
                    f"The device {node} is no camera.", hint="See: neurotouch devices"
                )
            self.name, self.bus_info = device.name, device.bus_info
            wanted = choose_mode(list_modes(device), config)
            agreed = device.set_format(wanted.fourcc, wanted.width, wanted.height)
            if agreed.fourcc not in KNOWN:
                raise CameraError(
                    f"The camera {device} sends {agreed.fourcc}, which cannot be read."
                )
            interval = device.set_interval(wanted.interval) or wanted.interval
            self.mode = Mode(agreed.fourcc, agreed.width, agreed.height, interval)
            fixed = fix_controls(device, config, 1e6 * float(interval))
            self.exposure_us, self.lacking = fixed.exposure_us, fixed.lacking
            self._reader = GreyReader(agreed)
        except BaseException:
            device.close()
            raise

    def start(self) -> None:
        """Starts the stream.

        Raises:
            CameraError: the camera refuses, or another program streams from it.
        """
        self._stream = PictureStream(self._device)

    def take(self, timeout_s: float, *, keeps_jpeg: bool = False) -> Picture | None:
        """Returns the newest picture; None if none came in time, or one that is damaged.

        Its pixels are valid until the next one; its times are those of CLOCK_MONOTONIC.

        Args:
            timeout_s: how long to wait for one.
            keeps_jpeg: the picture has its JPEG as well, if the camera sent one.

        Raises:
            CameraError: the camera is gone, or has failed.
        """
        assert self._stream is not None  # noqa: S101 - it streams from ``start`` on
        picture = self._stream.take(timeout_s)
        if picture is None:
            return None
        self.stamp_us = picture.t_us
        self.n_lost += picture.n_lost
        self.n_unstamped += not picture.has_stamp
        pixels = None if picture.is_damaged else self._reader.read(picture.data)
        if pixels is None:
            self.n_damaged += 1
            return None
        exposure_us = _USUAL_EXPOSURE_US if self.exposure_us is None else self.exposure_us
        begin_us = picture.t_us if picture.is_start else picture.t_us - exposure_us
        is_jpeg = keeps_jpeg and self.mode.fourcc in COMPRESSED
        jpeg = picture.data.tobytes() if is_jpeg else None
        return Picture(pixels, begin_us, begin_us + exposure_us, jpeg)

    def close(self) -> None:
        """Stops and closes it; a second call does nothing."""
        if self._stream is not None:
            self._stream.close()
        self._device.close()
