"""Finds out why the gamepad does not work, and the next step."""

import os
import shutil
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.players import SERVICE_UNIT, find_user_file

SituationKind = Literal[
    "no_camera", "service_stopped", "no_right", "no_pad", "unusable", "no_data", "ready"
]
MENDS: Final = {"no_right": "setup", "no_pad": "setup", "service_stopped": "service"}
"""What the page can start against it, as ``Programs`` calls it; both ask for a password."""

_PAD_NODE: Final = Path("/dev/uinput")


@dataclass(frozen=True, slots=True)
class Situation:
    """The reason why the gamepad does not work, and the next step.

    Attributes:
        kind: the reason in a word.
        text: the reason in a sentence.
        next: the next step, with its command.
        mend: what the page can start to mend it; empty if it can do nothing.
    """

    kind: SituationKind
    text: str
    next: str
    mend: str = ""


def find_situation(*, waits: bool = False) -> Situation:
    """Looks for a camera and its rights; takes some milliseconds and changes nothing.

    Args:
        waits: a driver runs, and nothing comes from its camera.
    """
    kind, text, step = _judge(waits=waits)
    mend = MENDS.get(kind, "") if shutil.which("pkexec") else ""
    return Situation(kind, text, step, mend)


def _judge(*, waits: bool) -> tuple[SituationKind, str, str]:
    """Returns the kind, the sentence and the command of a situation."""
    from neurotouch_hid.source.davis.enumeration import find_cameras  # noqa: PLC0415  # needs USB

    cameras = find_cameras()
    if not cameras:
        text = "No camera found. The driver waits for one." if waits else "No camera found."
        return "no_camera", text, "Try it now: neurotouch demo"
    if waits:
        return "no_data", "No data comes from the camera.", "Why: neurotouch status"
    if SERVICE_UNIT.exists():
        step = "Start it: sudo systemctl start neurotouch. Why: systemctl status neurotouch"
        return "service_stopped", "The service does not run.", step
    reasons = [info.reason for info in cameras]
    if all(reasons):
        if "no right" in reasons[0]:
            return "no_right", "Camera found but not readable.", "Fix: neurotouch setup"
        text = f"Camera found but not usable: {reasons[0]}."
        return "unusable", text, "Fix: neurotouch doctor"
    return _judge_readable()


def _judge_readable() -> tuple[SituationKind, str, str]:
    """Returns the same where a camera can be used."""
    if not os.access(_PAD_NODE, os.R_OK | os.W_OK):
        text = "Camera found, but no gamepad can be made."
        return "no_pad", text, "Fix: neurotouch setup"
    step = "calibrate (about 3 minutes, no time limit)"
    with suppress(OSError):  # no values yet, or none that can be read
        if "range:" in read_text(find_user_file(), MAX_SETTINGS_BYTES):
            step = "run"
    return "ready", "Ready.", f"Next: neurotouch {step}"
