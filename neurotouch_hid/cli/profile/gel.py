"""Gestures shown on the gel while a profile is edited."""

from typing import TYPE_CHECKING

from neurotouch_hid.cli.shared.silent_driver import read_steps
from neurotouch_hid.cli.ui.output import echo

if TYPE_CHECKING:
    from neurotouch_hid.profile import Profile

TOLD_EVERY_US = 100_000  # ten lines a second of sensor time: readable, and still moving


def see_gesture(source: str) -> str | None:
    """Returns the first movement made on the gel, in words; None if the source ends first."""
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.calibration import CalibrationSession

    session = CalibrationSession(load_user(), guided=False)
    echo("Make the gesture, then lift your fingers.")
    for gesture in (step.gesture for step in read_steps(source)):
        repetition = session.take(gesture)
        if repetition is not None and session.accepts(repetition):
            words = repetition.movement.replace("_", " ")
            echo(f"Seen: {words}, {repetition.peak_mm:.1f} millimetres")
            return words
    echo("No gesture was seen.")
    return None


def try_on_gel(source: str, profile: "Profile") -> None:
    """Shows one gesture and the draft's outputs for it, ten times a second."""
    from neurotouch_hid.messages import GestureKind
    from neurotouch_hid.monitor import describe_gesture, describe_outputs
    from neurotouch_hid.profile import Mapping, load_user

    mapping = Mapping(profile, load_user())
    echo("Make the gesture, then lift your fingers.")
    due_us: int | None = None
    for gesture in (step.gesture for step in read_steps(source)):
        pad = mapping.update(gesture)
        if gesture.kind is GestureKind.NONE:
            if due_us is not None:
                return
        elif due_us is None or gesture.t_us >= due_us:
            due_us = gesture.t_us + TOLD_EVERY_US
            echo(f"{describe_gesture(gesture)}: {describe_outputs(pad) or 'neutral'}")
