"""``neurotouch calibrate``: a person's own range of each movement."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Literal

import click

from neurotouch_hid.cli.shared.silent_driver import is_guided, open_silent_driver
from neurotouch_hid.cli.ui.completing import complete_source
from neurotouch_hid.cli.ui.options import (
    method_option,
    seconds_option,
    seed_option,
    speed_option,
)
from neurotouch_hid.cli.ui.output import json_option, plain_option
from neurotouch_hid.errors import DriverError, NeuroTouchError, SourceError
from neurotouch_hid.profile.schema import MOVEMENTS
from neurotouch_hid.vocabulary import RUNNING_DRIVER, SourceKind, find_source_kind

if TYPE_CHECKING:
    from neurotouch_hid.cli.ui.keyboard import Keyboard
    from neurotouch_hid.cli.ui.voice import Voice
    from neurotouch_hid.messages import Gesture
    from neurotouch_hid.profile.calibration import (
        CalibrationSession,
        HoldTeller,
        Repetition,
        UnfinishedCalibration,
    )

_KEYS = (
    "Enter = next. A letter, then Enter: S = I cannot do this, B = back, R = begin again, "
    "Q = stop and save nothing."
)

_REHEARSE = "To rehearse it: neurotouch demo --mouse, and in another terminal: neurotouch calibrate"
_KEPT = "What you did is kept. The next calibration continues there."


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch calibrate                           all movements, about three minutes\n"
    "  neurotouch calibrate zoom pinch                only these two\n"
    "  neurotouch calibrate --source davis:           the camera, not the running driver\n"
    "  neurotouch calibrate --source file:me.aedat4   from a recording, nothing to press\n"
    "  neurotouch calibrate --undo                    back to the calibration before"
)
@click.argument("gestures", nargs=-1, type=click.Choice(tuple(MOVEMENTS)), metavar="[GESTURE]...")
@click.option(
    "--source",
    shell_complete=complete_source,
    show_default="what the running driver sees, or else the camera",
    help="driver:, davis: (the camera), file:NAME.aedat4 (a recording) or sim:NAME (the "
    "simulator).",
)
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
    source: str | None,
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

    Nothing is timed: each step lasts until you press Enter. If it ends in the middle, the next call
    continues there. Full output will need 0.8 of a comfortable movement. GESTURE: only these. With
    --json what you are asked goes to the standard error, and nothing is saved without --yes.

    A running driver is paused meanwhile, and what it sees is measured: also the mouse gel of
    'neurotouch demo --mouse', to rehearse it.
    """
    from neurotouch_hid.client import find_live_source

    source = source or find_live_source()
    if not undo:
        _check(source)
    from neurotouch_hid.cli.calibrate_result import (
        conclude,
        relieve_weak_sides,
        undo_calibration,
    )
    from neurotouch_hid.cli.ui.keyboard import Keyboard
    from neurotouch_hid.cli.ui.voice import Voice
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.calibration import CalibrationSession, UnfinishedCalibration

    if undo:
        undo_calibration(plain=plain, as_json=as_json)
        return
    guided = is_guided(source, speed)
    keyboard = Keyboard()
    user = load_user()
    session = CalibrationSession(user, gestures, guided=guided)
    with ExitStack() as stack:
        voice = stack.enter_context(Voice(user.feedback, err=as_json))
        stack.enter_context(_pause_driver(source, voice))
        driver = stack.enter_context(open_silent_driver(source, speed, seed, method))
        if driver.source.is_simulated:
            voice.say("SIMULATED: this measures no hand.")
        kept = UnfinishedCalibration(session.movements, is_simulated=driver.source.is_simulated)
        stream = (step.gesture for step in driver.steps(seconds=seconds))
        with _tell_unsaved(voice, kept, guided=guided):
            if guided:
                _guide(session, stream, keyboard, voice, kept, seconds)
            else:
                for gesture in stream:
                    _tell(session, session.take(gesture), voice)
        is_saved = conclude(
            session,
            None if as_json else keyboard,
            yes=yes,
            plain=plain,
            as_json=as_json,
            is_simulated=driver.source.is_simulated,
        )
        if guided and session.step is None:
            kept.forget()
        if is_saved and not as_json:
            relieve_weak_sides(session, None if yes else keyboard, plain=plain)


def _check(source: str) -> None:
    """Checks the source; without a camera, the hint says how to rehearse."""
    from neurotouch_hid.source.check import check_source

    try:
        check_source(source)
    except SourceError as error:
        if find_source_kind(source) is SourceKind.RECORDING:
            raise
        hint = f"{error.hint}\n{_REHEARSE}" if error.hint else _REHEARSE
        raise type(error)(error.message, hint=hint) from error


@contextmanager
def _tell_unsaved(voice: "Voice", kept: "UnfinishedCalibration", *, guided: bool) -> Iterator[None]:
    """Says that nothing was saved if the person leaves, or the keyboard's input ends."""
    try:
        yield
    except (click.Abort, KeyboardInterrupt, NeuroTouchError) as error:
        if isinstance(error, click.Abort):  # Q
            kept.forget()
        voice.say("Nothing was saved.")
        if guided and kept.path.exists():
            voice.say(_KEPT)
        raise


@contextmanager
def _pause_driver(source: str, voice: "Voice") -> Iterator[None]:
    """Pauses a running driver, which goes on afterwards unless a person has stopped it."""
    from neurotouch_hid.program_pause import ProgramPause

    if source != RUNNING_DRIVER:
        yield
        return
    pause = ProgramPause()
    try:
        if pause.state != "panic":
            voice.say("The running driver is paused meanwhile.")
        yield
    finally:
        with suppress(DriverError):  # it has ended
            voice.say(pause.end())


def _guide(
    session: "CalibrationSession",
    stream: Iterator["Gesture"],
    keyboard: "Keyboard",
    voice: "Voice",
    kept: "UnfinishedCalibration",
    seconds: float | None,
) -> None:
    """Asks for one movement after the other; what is pressed decides when it goes on.

    Args:
        session: what is measured.
        stream: the gestures, which end after the time or with the source.
        keyboard: what the person presses.
        voice: what the person is told by.
        kept: what was done before, and is done now.
        seconds: the time that was given, if any.
    """
    from neurotouch_hid.profile.calibration import HoldTeller

    requests = {
        "neutral": "Rest your hand as you will play, or keep it off the gel.",
        "hold": "Make any movement about half way, and keep it there. Ten seconds help.",
        **{
            name: f"{movement.request}, as far as is comfortable; release; at least twice."
            for name, movement in MOVEMENTS.items()
        },
    }
    steps = session.steps
    before = kept.read(steps)
    if before is not None:
        session.resume(before)
    asked, warned, begin_us, now_us = None, False, None, 0
    hold = HoldTeller()
    for gesture in stream:
        begin_us, now_us = gesture.t_us if begin_us is None else begin_us, gesture.t_us
        if session.step is None:
            return
        if asked is None:
            voice.say(_KEYS)
            if before is not None:
                voice.say(f"You have done {before.at} of {len(steps)} steps before. It continues.")
        if session.step != asked:
            asked, warned, hold = session.step, False, HoldTeller()
            voice.say(f"Step {steps.index(asked) + 1} of {len(steps)}. {requests[asked]}")
        repetition = session.take(gesture)
        _tell(session, repetition, voice)
        _tell_hold(session, hold, voice)
        counts = repetition is not None and session.accepts(repetition)
        key = keyboard.poll()
        if key is not None:
            warned = _press(session, key.lower(), voice, warned=warned)
        if key is not None or counts:
            _keep(session, kept)
    at = f"in step {steps.index(asked) + 1} of {len(steps)}" if asked is not None else "at once"
    if seconds is not None and begin_us is not None and now_us - begin_us > 0.9e6 * seconds:
        voice.say(
            f"The {seconds:g} s are over {at}. Without --seconds each step lasts until you press "
            "Enter."
        )
    else:
        voice.say(f"The source has ended {at}.")
    if kept.path.exists():
        voice.say(_KEPT)


def _keep(session: "CalibrationSession", kept: "UnfinishedCalibration") -> None:
    """Keeps what was done; where nothing can be written, the calibration goes on without."""
    with suppress(OSError):
        if session.progress.at or session.peaks_mm:
            kept.save(session.progress)
        else:
            kept.forget()


def _press(session: "CalibrationSession", key: str, voice: "Voice", *, warned: bool) -> bool:
    """Acts on a line from the keyboard: Enter, S, B, R or Q.

    Returns:
        Whether the person has now been told that this movement was made too seldom.
    """
    from neurotouch_hid.profile.calibration import LEAST_PEAKS

    match key:
        case "" if session.missing and not warned:
            made = LEAST_PEAKS - session.missing
            voice.say(
                f"{made} of {LEAST_PEAKS} so far. Make it again. To leave it as it was, go to the "
                "next one once more."
            )
            return True
        case "":
            session.next()
        case "s":
            session.skip()
        case "b":
            session.back()
        case "r":
            session.restart()
        case "q":
            raise click.Abort
        case _:
            voice.say(_KEYS)
            return warned
    return False


def _tell(session: "CalibrationSession", repetition: "Repetition | None", voice: "Voice") -> None:
    """Reads out a repetition."""
    from neurotouch_hid.profile.calibration import describe_peak

    if repetition is None or session.step in ("neutral", "hold"):
        return
    words, mm = MOVEMENTS[repetition.movement].words, f"{repetition.peak_mm:.1f} millimetres"
    if session.accepts(repetition):
        counted = describe_peak(repetition.peak_mm, session.made)
        voice.accept(f"{words}, {mm}, good" if session.step == "everything" else counted)
    elif session.step in (repetition.movement, "everything"):
        voice.reject(f"{words}, {mm}, too small to count")
    else:
        voice.reject(f"{words}, {mm}, seen as another movement and not counted")


def _tell_hold(session: "CalibrationSession", hold: "HoldTeller", voice: "Voice") -> None:
    """Says how long a movement is held, in the step that asks for it."""
    words = hold.take(session.held_s) if session.step == "hold" else None
    if words is not None:
        voice.say(words)
