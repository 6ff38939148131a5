"""Finds out why the gamepad does not work, and the next step."""

import os
import shutil
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.players import SERVICE_UNIT, find_user_file

SituationKind = Literal[
    "no_camera", "service_stopped", "no_right", "no_pad", "unusable", "no_data", "ready"
]
MENDS: Final = {"no_right": "setup", "no_pad": "setup", "service_stopped": "service"}
"""What the page can start against it, as ``Programs`` calls it; both ask for a password."""

StartName = Literal["", "camera", "events", "webcam"]
"""A driver that ``Programs`` can start with a camera that is plugged in; empty: none."""

_PAD_NODE: Final = Path("/dev/uinput")


@dataclass(frozen=True, slots=True)
class Situation:
    """The reason why the gamepad does not work, and the next step.

    Attributes:
        kind: the reason in a word.
        text: the reason in a sentence.
        next: the next step, with its command.
        mend: what the page can start to mend it; empty if it can do nothing.
        start: the driver that can be started now.
    """

    kind: SituationKind
    text: str
    next: str
    mend: str = ""
    start: StartName = ""


def find_situation(*, waits: bool = False) -> Situation:
    """Looks for a camera and its rights; takes some milliseconds and changes nothing.

    Args:
        waits: a driver runs, and nothing comes from its camera.
    """
    found = _judge(waits=waits)
    mend = MENDS.get(found.kind, "") if shutil.which("pkexec") else ""
    return replace(found, mend=mend)


def find_start() -> StartName:
    """Returns the driver that can move a gamepad with the best camera that is plugged in."""
    if not _can_make_pad():
        return ""
    from neurotouch_hid.source.davis.enumeration import find_cameras  # noqa: PLC0415  # needs USB

    if any(not info.reason for info in find_cameras()):
        return "camera"
    return _find_other_start()


def _find_other_start() -> StartName:
    """Returns the same of all cameras but a DAVIS."""
    from neurotouch_hid.source.events.plugged import needs_library  # noqa: PLC0415  # as above
    from neurotouch_hid.source.video.plugged import list_webcams  # noqa: PLC0415

    if needs_library():
        return "events"
    return "webcam" if any(os.access(node, os.R_OK | os.W_OK) for node in list_webcams()) else ""


def _judge(*, waits: bool) -> Situation:
    """Returns the situation, without what mends it."""
    from neurotouch_hid.source.davis.enumeration import find_cameras  # noqa: PLC0415  # needs USB

    cameras = find_cameras()
    if not cameras:
        return _judge_other(waits=waits)
    if waits:
        return Situation("no_data", "No data comes from the camera.", "Why: neurotouch status")
    if SERVICE_UNIT.exists():
        step = "Start it: sudo systemctl start neurotouch. Why: systemctl status neurotouch"
        return Situation("service_stopped", "The service does not run.", step)
    reasons = [info.reason for info in cameras]
    if all(reasons):
        if "no right" in reasons[0]:
            text = "Camera found but not readable."
            return Situation("no_right", text, "Fix: neurotouch setup")
        text = f"Camera found but not usable: {reasons[0]}."
        return Situation("unusable", text, "Fix: neurotouch doctor")
    return _judge_readable()


def _judge_other(*, waits: bool) -> Situation:
    """Returns the same where no DAVIS is plugged in."""
    from neurotouch_hid.source.video.plugged import list_webcams  # noqa: PLC0415  # as above

    start = _find_other_start()
    if waits and not _can_make_pad():  # beside a service, which alone has the right
        start = ""
    if not start:
        if not waits and list_webcams():
            text = "Webcam found, but you may not use it."
            return Situation("unusable", text, "Fix: neurotouch doctor")
        text = "No camera found. The driver waits for one." if waits else "No camera found."
        return Situation("no_camera", text, "Try it now: neurotouch demo")
    if waits:
        text = "No data comes from the driver's camera."
        return Situation("no_data", text, "Why: neurotouch status", start=start)
    text = "Webcam found." if start == "webcam" else "Event camera found."
    if not _can_make_pad():
        return Situation("no_pad", f"{text} But no gamepad can be made.", "Fix: neurotouch setup")
    source = "video:" if start == "webcam" else "events:"
    step = f"Without a gel: neurotouch demo. With one: neurotouch run --source {source}"
    return Situation("ready", text, step, start=start)


def _can_make_pad() -> bool:
    return os.access(_PAD_NODE, os.R_OK | os.W_OK)


def _judge_readable() -> Situation:
    """Returns the same where a DAVIS can be used."""
    if not _can_make_pad():
        text = "Camera found, but no gamepad can be made."
        return Situation("no_pad", text, "Fix: neurotouch setup")
    step = "calibrate (about 3 minutes, no time limit)"
    with suppress(OSError):  # no values yet, or none that can be read
        if "range:" in read_text(find_user_file(), MAX_SETTINGS_BYTES):
            step = "run"
    return Situation("ready", "Ready.", f"Next: neurotouch {step}", start="camera")
