"""Finds out why the gamepad does not work while no driver runs, and the next step."""

from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.players import SERVICE_UNIT, explain_start, find_user_file

SituationKind = Literal["no_camera", "service_stopped", "no_right", "unusable", "ready"]


@dataclass(frozen=True, slots=True)
class Situation:
    """The reason why the gamepad does not work, and the next step.

    Attributes:
        kind: the reason in a word.
        text: the reason in a sentence.
        next: the next step, with its command.
    """

    kind: SituationKind
    text: str
    next: str


def find_situation() -> Situation:
    """Looks for a camera and its rights; takes some milliseconds and changes nothing."""
    from neurotouch_hid.source.davis.enumeration import find_cameras  # noqa: PLC0415  # needs USB

    cameras = find_cameras()
    if not cameras:
        return Situation("no_camera", "No camera found.", "Try it now: neurotouch demo")
    if SERVICE_UNIT.exists():
        return Situation(
            "service_stopped",
            f"The service does not run. {explain_start()}.",
            "Why: systemctl status neurotouch",
        )
    reasons = [info.reason for info in cameras]
    if all(reasons):
        if "no right" in reasons[0]:
            return Situation("no_right", "Camera found but not readable.", "Fix: neurotouch setup")
        text = f"Camera found but not usable: {reasons[0]}."
        return Situation("unusable", text, "Fix: neurotouch doctor")
    step = "calibrate (about 3 minutes, no time limit)"
    with suppress(OSError):  # no values yet, or none that can be read
        if "range:" in read_text(find_user_file(), MAX_SETTINGS_BYTES):
            step = "run"
    return Situation("ready", "Ready.", f"Next: neurotouch {step}")
