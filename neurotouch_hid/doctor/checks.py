"""Lists the checks of the machine, from Python to the finished gamepad."""

from collections.abc import Callable
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from neurotouch_hid.doctor.examination import Check
from neurotouch_hid.doctor.finding import Finding


def list_checks(
    picture: Path | None = None, source: str | None = None, gel: str | None = None
) -> tuple[Check, ...]:
    """Returns all checks, in the order from the machine to the person.

    Args:
        picture: path of the saved picture of the gel.
        source: source to examine instead of the camera.
        gel: name or path of the gel's file.
    """

    @cache
    def view() -> Any:  # three checks share one look at the gel
        return _import("gel").GelView(picture, source, gel)

    return (
        Check("python", _find("machine", "check_python")),
        Check("kernel module", _find("rights", "check_module")),
        Check("right to make a pad", _find("rights", "check_pad_right")),
        Check("udev rule", _find("rights", "check_rule")),
        Check("HID pad", _find("hid", "check_hid")),
        Check("service", _find("service", "check_service")),
        Check("seat", _find("rights", "check_seat")),
        Check("loop-back", _find("pad", "check_loopback")),
        Check("recognised as a pad", _find("pad", "check_recognition")),
        Check("Steam", _find("programs", "check_steam")),
        Check("remappers", _find("programs", "check_remappers")),
        Check("sandboxes", _find("programs", "check_sandboxes")),
        Check("camera", _find("camera", "check_presence")),
        Check("video cameras", _find("video", "check_video_cameras")),
        Check("event cameras", _find("event_cameras", "check_event_cameras")),
        Check("right to the camera", _find("camera", "check_camera_right")),
        Check("USB", _find("camera", "check_connection")),
        Check("events and frames", lambda: view().check_stream(), 60.0),
        Check("markers", lambda: view().check_markers(), 60.0),  # kernels may be compiled
        Check("rest", lambda: view().check_rest()),
        Check("pipeline", _find("machine", "check_pipeline"), 180.0),  # likewise
        Check("timer", _find("machine", "check_timer")),
        Check("profiles", _find("person", "check_profiles"), 20.0),
        Check("calibration", _find("person", "check_calibration")),
        Check("keyboard", _find("person", "check_keyboard")),
        Check("sound", _find("person", "check_sound")),
        Check("desktop", _find("programs", "check_desktop")),
        Check("live view", _find("surroundings", "check_page")),
        Check("terminal", _find("surroundings", "check_terminal")),
    )


def _find(area: str, name: str) -> Callable[[], Finding]:
    """Returns a check that imports its module only when it runs: a package may be missing."""

    def look() -> Finding:
        finding: Finding = getattr(_import(area), name)()
        return finding

    return look


def _import(area: str) -> Any:
    return import_module(f"neurotouch_hid.doctor.{area}")
