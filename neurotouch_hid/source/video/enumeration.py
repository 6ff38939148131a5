"""Lists the video cameras of this machine and finds one by a name."""

import os
from dataclasses import dataclass
from pathlib import Path

from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.source.camera_errors import CameraAbsentError, CameraGoneError
from neurotouch_hid.source.video.capture import CaptureDevice
from neurotouch_hid.source.video.v4l2 import Linux


@dataclass(frozen=True, slots=True)
class VideoInfo:
    """A video camera as Linux sees it.

    Attributes:
        node: its device node, such as ``/dev/video0``.
        name: its name.
        bus_info: where it is plugged in, such as ``usb-0000:00:14.0-2``.
        driver: name of its driver in Linux.
        reason: why it cannot be opened, or an empty string; then the others may be empty.
    """

    node: Path
    name: str = ""
    bus_info: str = ""
    driver: str = ""
    reason: str = ""

    @property
    def place(self) -> str:
        """Its name in a source: its place at the USB, which stays the same, or its node."""
        return self.bus_info if self.bus_info.startswith("usb-") else str(self.node)

    def __str__(self) -> str:
        return f"{self.node} ({self.name})" if self.name else str(self.node)


def find_video_cameras(linux: Linux | None = None) -> tuple[VideoInfo, ...]:
    """Returns all cameras, by the number of their nodes.

    Each is opened for a moment to ask for its name, which disturbs no program that uses it.
    """
    linux = linux or Linux()
    found = []
    for node in linux.list_nodes():
        try:
            with CaptureDevice(node, linux) as device:
                if device.is_camera:
                    found.append(VideoInfo(node, device.name, device.bus_info, device.driver))
        except CameraGoneError:
            continue
        except CameraBusyError:
            found.append(VideoInfo(node, reason="in use by another program"))
        except CameraError as error:
            is_forbidden = isinstance(error.__cause__, PermissionError)
            reason = f"no right to read and write {node}" if is_forbidden else error.message
            found.append(VideoInfo(node, reason=reason))
    return tuple(found)


def select_video_cameras(cameras: tuple[VideoInfo, ...], name: str) -> tuple[VideoInfo, ...]:
    """Returns the cameras that a name fits: all for an empty one.

    Args:
        cameras: those of this machine.
        name: a device node, a place such as ``usb-0000:00:14.0-2``, or a part of a
            camera's name.

    Raises:
        CameraAbsentError: it fits none; lists those that there are.
    """
    if not cameras:
        raise CameraAbsentError(
            "No video camera is plugged in.",
            hint="Plug one in. Without a camera: neurotouch demo, or the source sim:tour.",
        )
    if name.startswith("/"):
        fitting = [info for info in cameras if str(info.node) == os.path.realpath(name)]
    else:
        fitting = [info for info in cameras if name and info.bus_info == name] or [
            info for info in cameras if name.lower() in info.name.lower()
        ]
    if not fitting:
        there = ", ".join(map(str, cameras))
        raise CameraAbsentError(f"No video camera is called '{name}'.", hint=f"There is: {there}")
    return tuple(fitting)
