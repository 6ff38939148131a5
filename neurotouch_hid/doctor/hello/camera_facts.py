"""Reads what a camera says of itself; nothing is written to it."""

from pathlib import Path
from typing import Any, Final

from neurotouch_hid.doctor.event_cameras import judge_events
from neurotouch_hid.doctor.finding import Finding
from neurotouch_hid.doctor.video import judge_pictures
from neurotouch_hid.geometry import Gel
from neurotouch_hid.source import SizedSource, Source
from neurotouch_hid.source.davis import CameraInfo, choose_camera, find_cameras
from neurotouch_hid.source.davis.camera import read_registers
from neurotouch_hid.source.davis.enumeration import SYSFS
from neurotouch_hid.source.events.source import EventCameraSource
from neurotouch_hid.source.video.capture import CaptureDevice
from neurotouch_hid.source.video.controls import CONTROLS
from neurotouch_hid.source.video.live import VideoCameraSource
from neurotouch_hid.source.video.v4l2 import Linux
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

_MOST_DESCRIPTORS: Final = 4096
"""Bytes; those of a webcam take about 1 kB."""


def read_davis(source: str, sysfs: Path = SYSFS) -> tuple[dict[str, Any], set[str]]:
    """Returns a DAVIS's descriptors and registers, and the texts that no report may have.

    The camera is opened for a moment. Call it before the camera is opened to play.

    Args:
        source: the source; of any other kind than ``davis:``, nothing is read.
        sysfs: the folder in which Linux lists USB devices.

    Raises:
        CameraError: it is not plugged in, cannot be opened or does not answer.
    """
    if find_source_kind(source) is not SourceKind.CAMERA:
        return {}, set()
    cameras = find_cameras(sysfs)
    info = choose_camera(cameras, source.partition(":")[2])
    facts = {
        "product": info.product,
        "usb_mbit_s": info.speed_mbit_s,
        "firmware": info.firmware,
        "descriptors": _read_descriptors(info, sysfs),
        "registers": read_registers(info),
    }
    return facts, {each.serial for each in cameras}


def read_opened(source: Source, linux: Linux | None = None) -> dict[str, Any]:
    """Returns what any other camera than a DAVIS says, once it is open; empty of no camera."""
    if isinstance(source, VideoCameraSource):
        info = source.stats().info
        return {} if info is None else _read_video(info.node, linux)
    if isinstance(source, SizedSource) and source.is_live and source.sensor is not None:
        sensor = source.sensor
        return {"name": sensor.name, "width_px": sensor.width_px, "height_px": sensor.height_px}
    return {}


def list_serials(source: Source) -> set[str]:
    """Returns the serial number of an open event camera of another maker; no report may have it."""
    info = source.stats().info if isinstance(source, EventCameraSource) else None
    return {info.serial} if info is not None and info.serial else set()


def read_stream(source: Source) -> dict[str, Any]:
    """Returns how a camera other than a DAVIS has sent its data; empty of no camera.

    Call it while the camera is open, after it has played.
    """
    if isinstance(source, VideoCameraSource):
        stats = source.stats()
        mode = stats.mode
        return {
            "mode": None if mode is None else f"{mode.fourcc} {mode.width}x{mode.height}",
            "stated_hz": None if mode is None else round(mode.fps, 2),
            "pictures_hz": round(stats.fps, 2),
            "exposure_us": stats.exposure_us,
            "not_fixed": list(stats.lacking),
            "pictures": stats.n_pictures,
            "pictures_lost": stats.n_lost,
            "pictures_damaged": stats.n_damaged,
            "pictures_unstamped": stats.n_unstamped,
            "stamp_to_driver_us": round(stats.latency_us),
        }
    if isinstance(source, EventCameraSource):
        counts = source.stats()
        return {
            "events": counts.n_events,
            "events_shown": counts.n_shown,
            "overflows": counts.n_lost,
            "limited_us": counts.limited_us,
            "restarts": counts.n_restarts,
        }
    return {}


def judge_stream(source: Source, gel: Gel, seconds: float) -> Finding | None:
    """Returns what the doctor says of the data that a camera has sent; None of a DAVIS, or of none.

    Args:
        source: the camera, after it has played.
        gel: the gel before it.
        seconds: for how long it has played.
    """
    if isinstance(source, VideoCameraSource):
        return judge_pictures(source.name, source.stats(), gel)
    if isinstance(source, EventCameraSource):
        return judge_events(source.name, source.stats(), seconds)
    return None


def _read_descriptors(info: CameraInfo, sysfs: Path) -> str:
    """Returns the USB descriptors as hexadecimal digits; texts, such as the serial, are not in."""
    try:
        with (sysfs / info.port_path / "descriptors").open("rb") as file:
            return file.read(_MOST_DESCRIPTORS).hex()
    except OSError:
        return ""


def _read_video(node: Path, linux: Linux | None) -> dict[str, Any]:
    with CaptureDevice(node, linux) as device:
        modes = {
            f"{fourcc} {width}x{height}": [
                round(float(1 / each), 2)
                for each in device.list_intervals(fourcc, width, height)
                if each
            ]
            for fourcc in device.list_formats()
            for width, height in device.list_sizes(fourcc)
        }
        controls = {}
        for name, control in CONTROLS.items():
            scale = device.find_control(control)
            if scale is not None:
                controls[name] = {**scale._asdict(), "now": device.get_control(control)}
        return {
            "name": device.name,
            "driver": device.driver,
            "rates_by_mode": modes,
            "controls": controls,
        }
