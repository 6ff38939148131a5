"""Checks the camera: whether it is present, usable and well connected."""

from pathlib import Path
from typing import Final

from neurotouch_hid.doctor.finding import Finding, approve, fail, skip, warn
from neurotouch_hid.doctor.inventory import find_driver
from neurotouch_hid.doctor.rights import apply_rules, has_service, install_rule
from neurotouch_hid.source.davis import CameraInfo, CameraVersions, find_cameras, identify
from neurotouch_hid.source.davis.enumeration import SUPER_SPEED_MBIT_S, SYSFS
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

_MATCH: Final = "--subsystem-match=usb --attr-match=idVendor=152a"


def check_presence() -> Finding:
    """Checks whether a DAVIS is plugged in."""
    cameras = find_cameras()
    if not cameras:
        return skip(
            "No DAVIS camera is plugged in. If one is: try another cable and socket. "
            "'neurotouch demo' works without."
        )
    return approve(f"Plugged in: {', '.join(map(_describe, cameras))}.")


def check_camera_right() -> Finding:
    """Checks whether this user may open the camera, and whether it answers."""
    cameras = find_cameras()
    if not cameras:
        return skip("Needs a camera.")
    info = next((info for info in cameras if not info.reason), cameras[0])
    if not info.reason:
        return _judge_variant(info, identify(info))
    running = find_driver()
    source = running["source"] if running is not None else ""
    if find_source_kind(source) is SourceKind.CAMERA:
        return approve("The running driver has the camera.")
    if "no right" in info.reason:
        return _explain_right(info)
    if info.reason.startswith("in use"):
        return warn(
            f"The camera {info.serial} is {info.reason}.", "End that program, or record from it."
        )
    return fail(
        f"The camera {info.serial} cannot be used: {info.reason}.",
        "The tools of its maker can say more. This program does not flash cameras.",
    )


def _judge_variant(info: CameraInfo, found: CameraVersions) -> Finding:
    sentence = f"The camera {info.serial} answers: {found}."
    if found.is_usual:
        return approve(sentence)
    return warn(
        f"{sentence} Such a camera was only played in a simulation.",
        f"Try it: neurotouch run --source davis:{info.serial}. It says if it cannot be played.",
    )


def _explain_right(info: CameraInfo) -> Finding:
    sentence = f"The camera {info.serial} is present, but not readable: {info.reason}."
    if has_service():
        return fail(
            f"{sentence} It belongs to the service, which does not run.",
            "Start it; if it ends again, its status says why.",
            "sudo systemctl start neurotouch",
            "systemctl status neurotouch",
        )
    return fail(
        sentence,
        "Allow it for the person at the machine, as 'neurotouch setup' does.",
        install_rule("70-neurotouch-camera.rules"),
        *apply_rules(_MATCH),
    )


def check_connection(system: Path = SYSFS) -> Finding:
    """Checks that the camera is on USB 3 and is never suspended."""
    cameras = find_cameras()
    if not cameras:
        return skip("Needs a camera.")
    slow = [info for info in cameras if info.speed_mbit_s < SUPER_SPEED_MBIT_S]
    if slow:
        return warn(
            f"The camera {slow[0].serial} runs at {slow[0].speed_mbit_s} Mbit/s instead of "
            f"{SUPER_SPEED_MBIT_S}: it works, but fast motion may lose events.",
            "Use a USB 3 socket (blue, or marked SS) and a USB 3 cable, without a hub.",
        )
    sleepy = [info for info in cameras if _may_sleep(system / info.port_path)]
    if sleepy:
        switch = system / sleepy[0].port_path / "power/control"
        return warn(
            f"The system may send the camera {sleepy[0].serial} to sleep (USB autosuspend).",
            "Switch that off for it; power savers such as TLP need an exception for 152a:841a.",
            f"echo on | sudo tee {switch}",
        )
    speeds = ", ".join(f"{info.speed_mbit_s} Mbit/s" for info in cameras)
    return approve(f"USB 3 ({speeds}), and it is never sent to sleep.")


def _may_sleep(folder: Path) -> bool:
    switch = folder / "power/control"
    return switch.exists() and switch.read_text().strip() == "auto"


def _describe(info: CameraInfo) -> str:
    return f"{info.product} {info.serial or 'without a serial number'} at {info.port_path}"
