"""``neurotouch calibrate``: a person's own range of each movement."""

import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import click

from neurotouch_hid.cli.method import choose_method
from neurotouch_hid.cli.output import make_stamp, plain_option, say, show_changes

if TYPE_CHECKING:
    from neurotouch_hid.cli.keyboard import Keyboard
    from neurotouch_hid.messages import Gesture
    from neurotouch_hid.profile.calibration import Repetition, Session, WeakSide

_MOVEMENTS = (
    "push_left",
    "push_right",
    "push_up",
    "push_down",
    "pinch",
    "zoom",
    "twist_cw",
    "twist_ccw",
)
_KEYS = "Enter = next, S = I cannot do this, B = back, Q = stop and save nothing."


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch calibrate                           all movements, about three minutes\n"
    "  neurotouch calibrate zoom pinch                only these two\n"
    "  neurotouch calibrate --source file:me.aedat4   from a recording, nothing to press\n"
    "  neurotouch calibrate --undo                    back to the calibration before"
)
@click.argument("gestures", nargs=-1, type=click.Choice(_MOVEMENTS), metavar="[GESTURE]...")
@click.option(
    "--source",
    default="davis:",
    show_default=True,
    help="davis: (the camera), file:NAME.aedat4 (a recording) or sim:NAME (the simulator).",
)
@click.option(
    "--speed",
    type=click.Choice(["recorded", "max"]),
    default="recorded",
    show_default=True,
    help="As recorded, or as fast as possible; then movements are taken for what they are.",
)
@click.option("--seconds", type=click.FloatRange(min=0.1), help="The source ends after so long.")
@click.option("--seed", default=0, show_default=True, help="Seed of the simulator.")
@choose_method
@click.option("--yes", is_flag=True, help="Save without asking.")
@click.option("--undo", is_flag=True, help="Take back the last calibration.")
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
    plain: bool,
) -> None:
    """Measure how far each movement comfortably goes, how much you tremble, and save it.

    Nothing is timed: each step lasts until you press Enter. Full output will need 0.8 of a
    comfortable movement. GESTURE: only these.
    """
    from neurotouch_hid.cli.keyboard import Keyboard
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.calibration import Session

    if undo:
        _undo(plain=plain)
        return
    guided = speed == "recorded" and not source.startswith("file:")
    session = Session(load_user(), gestures, guided=guided)
    keyboard = Keyboard()
    stream = read_gestures(source, speed, seed, method, seconds)
    if guided:
        _guide(session, stream, keyboard)
    else:
        for gesture in stream:
            _tell(session, session.take(gesture))
    conclude(session, keyboard, yes=yes, plain=plain)


def read_gestures(
    source: str,
    speed: Literal["recorded", "max"] = "recorded",
    seed: int = 0,
    method: Literal["neurotouch", "paper"] = "neurotouch",
    seconds: float | None = None,
) -> Iterator["Gesture"]:
    """What the hand does in a source, slice by slice."""
    from neurotouch_hid.cli.play import prepare_kernels
    from neurotouch_hid.gesture import GestureConfig
    from neurotouch_hid.profile import load_profile
    from neurotouch_hid.runtime import Pipeline
    from neurotouch_hid.source import open_source

    profile, config = load_profile("default"), GestureConfig(method=method)
    with open_source(source, speed=speed, seed=seed) as packets:
        prepare_kernels(profile, config, source)
        live = speed == "recorded" and not packets.name.startswith("file:")
        pipeline = Pipeline.build(profile, config, rig=packets.rig, live=live)
        begin_us: int | None = None
        try:
            for packet in packets:
                yield pipeline.advance(packet).gesture
                begin_us = packet.t_begin_us if begin_us is None else begin_us
                if seconds is not None and packet.t_end_us - begin_us >= seconds * 1e6:
                    return
        finally:
            pipeline.close()


def _guide(session: "Session", stream: Iterator["Gesture"], keyboard: "Keyboard") -> None:
    """Asks for one movement after the other; what is pressed decides when it goes on."""
    from neurotouch_hid.profile.calibration import MOVEMENTS

    requests = {
        "neutral": "Rest your hand as you will play, or keep it off the gel.",
        "hold": "Make any movement about half way, and keep it there. Ten seconds help.",
        **{
            name: f"{movement.request}, as far as is comfortable; let go; as often as you like."
            for name, movement in MOVEMENTS.items()
        },
    }
    steps = ["neutral", "hold", *session.movements]
    click.echo(_KEYS)
    asked = None
    for gesture in stream:
        if session.step is None:
            return
        if session.step != asked:
            asked = session.step
            click.echo(f"Step {steps.index(asked) + 1} of {len(steps)}. {requests[asked]}")
        _tell(session, session.take(gesture))
        key = keyboard.poll()
        if key is not None:
            _press(session, key.lower())
    click.echo("The source has ended.")


def _press(session: "Session", key: str) -> None:
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
            click.echo(_KEYS)


def _tell(session: "Session", repetition: "Repetition | None") -> None:
    """Reads out a repetition."""
    from neurotouch_hid.profile.calibration import MOVEMENTS

    if repetition is None or session.step in ("neutral", "hold"):
        return
    words, mm = MOVEMENTS[repetition.movement].words, f"{repetition.peak_mm:.1f} millimetres"
    if session.accepts(repetition):
        click.echo(f"{words}, {mm}, good" if session.step == "everything" else f"{mm}, good")
    elif session.step in (repetition.movement, "everything"):
        click.echo(f"{words}, {mm}, too small to count")
    else:
        click.echo(f"{words}, {mm}, seen as another movement and not counted")


def conclude(session: "Session", keyboard: "Keyboard", *, yes: bool, plain: bool) -> None:
    """Says what came out, offers relief, saves."""
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.calibration import MOVEMENTS, find_weak_sides, write_ranges
    from neurotouch_hid.profile.editing import compare, take_user

    ranges, before = session.ranges, load_user()
    click.echo(f"Noise at rest: below {session.rest_mm:g} mm")
    tremor, calm = session.tremor, session.tremor_filter
    if tremor is not None:
        click.echo(f"Tremor: {tremor.frequency_hz:.1f} Hz, {tremor.amplitude_mm:.1f} mm")
    elif calm is not None:
        click.echo("Tremor: none")
    for name, range_ in ranges.items():
        old = getattr(before.range, name)
        was = f"{old.rest:g} to {old.full:g} mm" if old is not None else "a usual hand's"
        now = f"{range_.rest:g} to {range_.full:g} mm" if range_ is not None else "not used"
        click.echo(f"{MOVEMENTS[name].words}: was {was}, now {now}")
    if not any(ranges.values()):
        say("WARNING", "No movement was made twice and far enough; nothing was saved.", plain=plain)
        return
    wanted = calm if calm is not None and calm != before.filter else None
    if wanted is not None and not yes:
        question = f"The filter '{wanted}' is calm enough for you. Your hand holds more exactly "
        question += "the stronger it is, and everything comes a little later."
        keep = f"Leave it as it is ({before.filter or 'the profile decides'})"
        if keyboard.choose(question, [f"Set it to {wanted}", keep]) == 1:
            wanted = None
    paper = take_user(make_stamp)
    text = write_ranges(paper.text, ranges, time.strftime("%Y-%m-%d"), wanted)
    show_changes(compare(paper.text if paper.content is not None else "", text), plain=plain)
    if not yes and keyboard.choose("Save this?", ["Save", "Save nothing"]) == 1:
        say("OK", "Nothing was saved.", plain=plain)
        return
    paper.save(text)
    say("OK", f"Saved {paper.store.path}", plain=plain)
    click.echo("Back to the one before: neurotouch calibrate --undo")
    for side in find_weak_sides(ranges):
        _relieve(side, keyboard if not yes else None, plain=plain)


def _relieve(side: "WeakSide", keyboard: "Keyboard | None", *, plain: bool) -> None:
    """Offers the three assists for a weak side; without a keyboard it only names them."""
    from neurotouch_hid.cli.profile.saving import save_paper
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.calibration import MOVEMENTS, hand_over
    from neurotouch_hid.profile.editing import take_profile

    weak, strong = MOVEMENTS[side.weak].words, MOVEMENTS[side.strong].words
    profile = load_user().slots[0]
    size = f"goes {100 * side.share:.0f} % as far as" if side.share else "is not used, unlike"
    small = "Keep it: with its own range, a small movement counts as a whole one"
    ways = [
        small if side.share else "Keep it: nothing you play will need it if you bind nothing to it",
        f"Let a long {strong} do what {weak} does in the profile '{profile}'",
        f"Let a short push do what {weak} does in the profile '{profile}'",
    ]
    if keyboard is None:
        click.echo(f"{weak} {size} {strong}.")
        return
    choice = keyboard.choose(f"{weak} {size} {strong}. What shall be done?", ways)
    if choice == 0:
        return
    gesture, _, way = side.strong.partition("_")
    when = {"gesture": side.strong, "press": "long"}
    if gesture == "push":
        when = {"gesture": "push", "direction": way, "press": "long"}
    if choice == 2:
        sides = ["left", "right", "up", "down"]
        when = {"gesture": "push", "direction": sides[keyboard.choose("Which way?", sides)]}
        when["press"] = "tap"
    paper = take_profile(profile, make_stamp)
    text, moved = hand_over(paper.text, side.weak, when)
    if not moved:
        say("OK", f"{weak} presses nothing in '{profile}', nothing has changed.", plain=plain)
        return
    save_paper(paper, text, plain=plain)


def _undo(*, plain: bool) -> None:
    from neurotouch_hid.profile.editing import compare, read_text, take_user

    paper = take_user(make_stamp)
    paper.store.undo()
    show_changes(compare(paper.text, read_text(paper.store.path)[0]), plain=plain)
    say("OK", "Your values are as before the last calibration.", plain=plain)
