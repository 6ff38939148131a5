"""Finds the cameras that are plugged in, through Linux, without touching any of them."""

import os
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from neurotouch_hid.source.camera_errors import CameraAbsentError
from neurotouch_hid.source.davis.registers import FIRMWARE, PRODUCT_ID, VENDOR_ID

SYSFS: Final = Path("/sys/bus/usb/devices")
NODES: Final = Path("/dev/bus/usb")
SUPER_SPEED_MBIT_S: Final = 5_000


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """A camera as Linux sees it.

    Attributes:
        bus: number of the USB bus.
        address: number on that bus; another one after every plug.
        port_path: where it is plugged in, as ``2-1.4``.
        serial: as on its sticker, with leading zeros; empty if it has none.
        product: its product name.
        speed_mbit_s: 480 on USB 2, 5000 and more on USB 3.
        firmware: version of the firmware in its USB chip.
        reason: why it cannot be opened, or an empty string.
    """

    bus: int
    address: int
    port_path: str
    serial: str
    product: str
    speed_mbit_s: int
    firmware: int
    reason: str = ""

    @property
    def node(self) -> Path:
        """The file through which programs reach it."""
        return NODES / f"{self.bus:03d}" / f"{self.address:03d}"


def find_cameras(sysfs: Path = SYSFS) -> tuple[CameraInfo, ...]:
    """Returns all cameras that are plugged in, ordered by port.

    None of them is opened or disturbed.

    Args:
        sysfs: the folder in which Linux lists USB devices.
    """
    found = []
    for folder in sysfs.iterdir() if sysfs.is_dir() else ():
        with suppress(OSError, ValueError):  # unplugged while we read
            ids = tuple(int(_read(folder, name), 16) for name in ("idVendor", "idProduct"))
            if ids == (VENDOR_ID, PRODUCT_ID):
                found.append(_describe(folder))
    return tuple(sorted(found, key=lambda info: (info.bus, info.port_path)))


def choose_camera(cameras: tuple[CameraInfo, ...], serial: str = "") -> CameraInfo:
    """Returns the camera of a serial number, or the first one that can be opened.

    Args:
        cameras: those that are plugged in.
        serial: with or without leading zeros; empty for any.

    Raises:
        CameraAbsentError: it is not plugged in.
    """
    if not cameras:
        asked = f", so none has the serial number {serial}" if serial else ""
        raise CameraAbsentError(
            f"No DAVIS camera is plugged in{asked}.",
            hint="Plug it in. Without a camera: neurotouch demo, or the source sim:tour.",
        )
    if not serial:
        return next((info for info in cameras if not info.reason), cameras[0])
    for info in cameras:
        if info.serial == serial or info.serial.lstrip("0") == serial.lstrip("0") != "":
            return info
    present = ", ".join(info.serial or "one without a number" for info in cameras)
    raise CameraAbsentError(f"No camera {serial} is plugged in.", hint=f"There is: {present}")


def find_users(info: CameraInfo) -> tuple[int, ...]:
    """Returns the other processes that have the camera open, as far as we may see them."""
    pids = []
    for folder in Path("/proc").glob("[0-9]*/fd"):
        pid = int(folder.parent.name)
        if pid == os.getpid():
            continue
        with suppress(OSError):  # not ours, or it has ended
            if any(entry.readlink() == info.node for entry in folder.iterdir()):
                pids.append(pid)
    return tuple(sorted(pids))


def _describe(folder: Path) -> CameraInfo:
    firmware = int(_read(folder, "bcdDevice"), 16) & 0xFF
    info = CameraInfo(
        bus=int(_read(folder, "busnum")),
        address=int(_read(folder, "devnum")),
        port_path=folder.name,
        serial=_read(folder, "serial", ""),
        product=_read(folder, "product", "DAVIS"),
        speed_mbit_s=round(float(_read(folder, "speed"))),
        firmware=firmware,
    )
    reason = ""
    if firmware < FIRMWARE:
        reason = f"its firmware is version {firmware}, and {FIRMWARE} is the least"
    elif not os.access(info.node, os.R_OK | os.W_OK):
        reason = f"no right to read and write {info.node}"
    elif users := find_users(info):
        reason = f"in use by {describe_users(users)}"
    return replace(info, reason=reason)


def describe_users(pids: tuple[int, ...]) -> str:
    """Returns the processes by number, or words where none can be seen."""
    if not pids:
        return "another program"
    return "PID " + ", ".join(map(str, pids))


def _read(folder: Path, name: str, default: str | None = None) -> str:
    try:
        return (folder / name).read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        if default is None:
            raise
        return default
