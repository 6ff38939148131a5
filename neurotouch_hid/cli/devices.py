"""``neurotouch devices``: lists the cameras and the game controllers of this machine."""

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from neurotouch_hid.cli.ui.output import echo, json_option, print_json
from neurotouch_hid.errors import CameraError
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

if TYPE_CHECKING:
    from neurotouch_hid.doctor.inventory import Pad
    from neurotouch_hid.source.davis import CameraInfo, CameraVersions
    from neurotouch_hid.source.events.enumeration import EventCameraInfo
    from neurotouch_hid.source.video.enumeration import VideoInfo


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch devices\n"
    "  neurotouch devices --json | jq -r '.cameras[].serial'\n"
    "  neurotouch run --source davis:00000216          the camera with this number\n"
    "  neurotouch run --source video:/dev/video2       the video camera with this node\n"
    "  neurotouch run --source events:00ca0123         the event camera of another maker\n"
    "  neurotouch devices --watch                      reads the pad of 'run --device hid' back\n\n"
    "Exit code 0, also if there are none."
)
@click.option(
    "--watch", is_flag=True, help="Print the reports of our HID pad as they come, until Ctrl-C."
)
@json_option
def command(watch: bool, as_json: bool) -> None:
    """List the cameras and the game controllers of this machine; ours are marked.

    A DAVIS that is not in use is opened for a moment to read its versions; one in use is not. A
    video camera is always asked, which disturbs no program.
    """
    if watch:
        from neurotouch_hid.cli.shared.watch_reports import watch_pad

        watch_pad(as_json=as_json)
        return
    from neurotouch_hid.doctor.inventory import find_driver, find_pads
    from neurotouch_hid.source.davis import find_cameras
    from neurotouch_hid.source.video.enumeration import find_video_cameras

    cameras = [(info, *_identify(info)) for info in find_cameras()]
    running = find_driver() if cameras else None
    playing = "" if running is None else running["source"]
    if find_source_kind(playing) is SourceKind.CAMERA:
        has = f"the running driver plays {playing}"
        cameras = [(info, known, f"{why}; {has}" if why else "") for info, known, why in cameras]
    videos = [(info, *_find_mode(info)) for info in find_video_cameras()]
    others = _find_others()
    pads = find_pads()
    if as_json:
        print_json(
            {
                "cameras": [_report_camera(*camera) for camera in cameras],
                "video_cameras": [_report_video(*video) for video in videos],
                "event_cameras": [_report_other(other) for other in others],
                "pads": [_report_pad(pad) for pad in pads],
            }
        )
        return
    for camera in cameras:
        _show_camera(*camera)
    for video in videos:
        _show_video(*video)
    for other in others:
        _show_other(other)
    if not (cameras or videos or others):
        echo("No camera is plugged in. Try without: neurotouch demo")
    for pad in pads:
        _show_pad(pad)
    if not pads:
        echo("There is no game controller. 'neurotouch run' makes one.")


def _identify(info: "CameraInfo") -> "tuple[CameraVersions | None, str]":
    """Returns the camera's versions, or why they cannot be read."""
    from neurotouch_hid.source.davis import identify

    if info.reason:
        return None, info.reason
    try:
        return identify(info), ""
    except CameraError as error:
        return None, error.message.rstrip(".")


def _show_camera(info: "CameraInfo", versions: "CameraVersions | None", reason: str) -> None:
    status = "OK" if versions is not None else "WARNING"
    usb = "USB 3" if info.speed_mbit_s >= 5000 else "USB 2, fast motion may lose events"
    echo(f"{status} camera {info.serial or 'without a serial number'}: {info.product}")
    echo(f"  plugged in: {info.port_path} (bus {info.bus}, address {info.address})")
    echo(f"  speed: {info.speed_mbit_s} Mbit/s ({usb})")
    if versions is None:
        echo(f"  firmware: {info.firmware}")
        echo(f"  not available: {reason}")
    else:
        echo(f"  variant: {versions}")
    echo(f"  use it: --source davis:{info.serial}")


def _find_mode(info: "VideoInfo") -> tuple[str, str]:
    """Returns the pictures that a video camera would send, or why that is unknown."""
    from neurotouch_hid.source.video.capture import CaptureDevice
    from neurotouch_hid.source.video.config import VideoConfig
    from neurotouch_hid.source.video.modes import choose_mode, list_modes

    if info.reason:
        return "", info.reason
    try:
        with CaptureDevice(info.node) as device:
            return str(choose_mode(list_modes(device), VideoConfig())), ""
    except CameraError as error:
        return "", error.message.rstrip(".")


def _show_video(info: "VideoInfo", mode: str, reason: str) -> None:
    status = "WARNING" if reason else "OK"
    echo(f"{status} video camera {info.name or 'without a name'}: {info.node}")
    if info.bus_info:
        echo(f"  plugged in: {info.bus_info}")
    echo(f"  not available: {reason}" if reason else f"  fastest pictures: {mode}")
    echo(f"  use it: --source video:{info.place}")


def _find_others() -> "list[EventCameraInfo]":
    """Returns the event cameras of other makers; none without the library that plays them."""
    from neurotouch_hid.source.events.enumeration import find_event_cameras
    from neurotouch_hid.source.events.library import INSTALL, load_library
    from neurotouch_hid.source.events.models import DAVIS
    from neurotouch_hid.source.events.plugged import needs_library

    try:
        library = load_library()
    except CameraError:
        if needs_library():
            echo(f"An event camera needs another package: {INSTALL}", err=True)
        return []
    return [info for info in find_event_cameras(library) if info.model is not DAVIS]


def _show_other(info: "EventCameraInfo") -> None:
    status = "WARNING" if info.reason else "OK"
    model = info.model
    echo(f"{status} event camera {info.serial or 'without a serial number'}: {model.title}")
    echo(f"  picture: {model.width_px}x{model.height_px} pixels, no frames")
    echo(f"  plugged in: {info.connection}")
    if info.reason:
        echo(f"  not available: {info.reason}")
    echo(f"  use it: --source {info.source}")


def _show_pad(pad: "Pad") -> None:
    whose = "ours" if pad.ours else "made by another program" if pad.virtual else "a real one"
    echo(f"OK game controller {pad.name}: {whose}")
    echo(f"  node: {pad.node}{'' if pad.readable else ' (you may not read it)'}")
    echo(f"  identity: {pad.usb_id}, version {pad.ids[3]:#06x}")
    if pad.place:
        echo(f"  place: {pad.place}")


def _report_camera(
    info: "CameraInfo", versions: "CameraVersions | None", reason: str
) -> dict[str, Any]:
    known = None if versions is None else asdict(versions)
    return {**asdict(info), "reason": reason or None, "versions": known}


def _report_video(info: "VideoInfo", mode: str, reason: str) -> dict[str, Any]:
    known = asdict(info) | {"node": str(info.node), "source": f"video:{info.place}"}
    return {**known, "reason": reason or None, "mode": mode or None}


def _report_other(info: "EventCameraInfo") -> dict[str, Any]:
    known = {"serial": info.serial, "model": info.model.key, "title": info.model.title}
    size = {"width": info.model.width_px, "height": info.model.height_px}
    place = {"connection": info.connection, "address": info.address, "source": info.source}
    return {**known, **size, **place, "reason": info.reason or None}


def _report_pad(pad: "Pad") -> dict[str, Any]:
    bus, vendor, product, version = pad.ids
    ids = {"bus": bus, "vendor": vendor, "product": product, "version": version}
    return {**asdict(pad), "ids": ids}
