"""``neurotouch calibrate``: a person's own range of each movement."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import click

from neurotouch_hid.cli.follow import is_guided, read_steps
from neurotouch_hid.cli.ui.options import (
    method_option,
    seconds_option,
    seed_option,
    source_option,
    speed_option,
)
from neurotouch_hid.cli.ui.output import json_option, plain_option
from neurotouch_hid.profile.schema.movements import MOVEMENTS

if TYPE_CHECKING:
    from neurotouch_hid.cli.ui.keyboard import Keyboard
    from neurotouch_hid.cli.ui.voice import Voice
    from neurotouch_hid.messages import Gesture
    from neurotouch_hid.profile.calibration import CalibrationSession, Repetition

_KEYS = "Enter = next, S = I cannot do this, B = back, Q = stop and save nothing."


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch calibrate                           all movements, about three minutes\n"
    "  neurotouch calibrate zoom pinch                only these two\n"
    "  neurotouch calibrate --source file:me.aedat4   from a recording, nothing to press\n"
    "  neurotouch calibrate --undo                    back to the calibration before"
)
@click.argument("gestures", nargs=-1, type=click.Choice(tuple(MOVEMENTS)), metavar="[GESTURE]...")
@source_option
@speed_option
@seconds_option
@seed_option
@method_option
@click.option("--yes", is_flag=True, help="Save without asking.")
@click.option("--undo", is_flag=True, help="Take back the last calibration.")
@json_option
@plain_option
def command(
    gestures: tuple[str, ...],
    source: str,
    speed: Literal["recorded", "max"],
    seconds: float | None,
    seed: int,
    method: Literal["neurotouch", "paper"],
    yes: bool,
    undo: bool,
    as_json: bool,
    plain: bool,
) -> None:
    """Measure how far each movement comfortably goes, how much you tremble, and save it.

    Nothing is timed: each step lasts until you press Enter. Full output will need 0.8 of a
    comfortable movement. GESTURE: only these. With --json what you are asked goes to the standard
    error, and nothing is saved without --yes.
    """
    from neurotouch_hid.cli.calibrate_result import conclude, undo_calibration
    from neurotouch_hid.cli.ui.keyboard import Keyboard
    from neurotouch_hid.cli.ui.voice import Voice
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.calibration import CalibrationSession

    if undo:
        undo_calibration(plain=plain, as_json=as_json)
        return
    guided = is_guided(source, speed)
    keyboard = Keyboard()
    user = load_user()
    session = CalibrationSession(user, gestures, guided=guided)
    steps = read_steps(source, speed, seed, method, seconds=seconds)
    stream = (step.gesture for step in steps)
    with Voice(user.feedback, err=as_json) as voice:
        if guided:
            _guide(session, stream, keyboard, voice)
        else:
            for gesture in stream:
                _tell(session, session.take(gesture), voice)
    conclude(session, None if as_json else keyboard, yes=yes, plain=plain, as_json=as_json)


def _guide(
    session: "CalibrationSession",
    stream: Iterator["Gesture"],
    keyboard: "Keyboard",
    voice: "Voice",
) -> None:
    """Asks for one movement after the other; what is pressed decides when it goes on."""
    requests = {
        "neutral": "Rest your hand as you will play, or keep it off the gel.",
        "hold": "Make any movement about half way, and keep it there. Ten seconds help.",
        **{
            name: f"{movement.request}, as far as is comfortable; let go; as often as you like."
            for name, movement in MOVEMENTS.items()
        },
    }
    steps = ["neutral", "hold", *session.movements]
    voice.say(_KEYS)
    asked = None
    for gesture in stream:
        if session.step is None:
            return
        if session.step != asked:
            asked = session.step
            voice.say(f"Step {steps.index(asked) + 1} of {len(steps)}. {requests[asked]}")
        _tell(session, session.take(gesture), voice)
        key = keyboard.poll()
        if key is not None:
            _press(session, key.lower(), voice)
    voice.say("The source has ended.")


def _press(session: "CalibrationSession", key: str, voice: "Voice") -> None:
    """What one pressed: Enter, S, B or Q."""
    match key:
        case "":
            session.next()
        case "s":
            session.skip()
        case "b":
            session.back()
        case "q":
            raise click.Abort
        case _:
            voice.say(_KEYS)


def _tell(session: "CalibrationSession", repetition: "Repetition | None", voice: "Voice") -> None:
    """Reads out a repetition."""
    if repetition is None or session.step in ("neutral", "hold"):
        return
    words, mm = MOVEMENTS[repetition.movement].words, f"{repetition.peak_mm:.1f} millimetres"
    if session.accepts(repetition):
        voice.accept(f"{words}, {mm}, good" if session.step == "everything" else f"{mm}, good")
    elif session.step in (repetition.movement, "everything"):
        voice.reject(f"{words}, {mm}, too small to count")
    else:
        voice.reject(f"{words}, {mm}, seen as another movement and not counted")
