"""Ends a calibration: says and saves the results, and offers help for weak sides."""

import time
from typing import TYPE_CHECKING, Any

from neurotouch_hid.cli.profile.saving import save_edited
from neurotouch_hid.cli.ui.outcome import Outcome
from neurotouch_hid.cli.ui.output import (
    echo,
    make_calibration_stamp,
    make_stamp,
    print_json,
    say,
    show_changes,
)
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile.calibration import LEAST_PEAKS
from neurotouch_hid.profile.schema import MOVEMENTS

if TYPE_CHECKING:
    from neurotouch_hid.cli.ui.keyboard import Keyboard
    from neurotouch_hid.profile import UserSettings
    from neurotouch_hid.profile.calibration import CalibrationSession, WeakSide
    from neurotouch_hid.profile.schema import FilterName, MovementRange

_SIDES = ["left", "right", "up", "down"]


def conclude(
    session: "CalibrationSession",
    keyboard: "Keyboard | None",
    *,
    yes: bool,
    plain: bool,
    as_json: bool = False,
    is_simulated: bool = False,
) -> bool:
    """Says the results, and saves them if the person wants to.

    Args:
        session: what was measured.
        keyboard: reads the person's answers; None if there is none.
        yes: save without asking.
        plain: one fact a line.
        as_json: print one JSON object; then nothing is asked.
        is_simulated: no hand was measured.

    Returns:
        True if they were saved.
    """
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.calibration import write_ranges
    from neurotouch_hid.profile.editing import ProfileText, compare, hand_over_saved, take_user

    before, calm, edited = load_user(), session.tremor_filter, take_user(make_calibration_stamp)
    asks = keyboard is not None and not yes and not as_json
    if not as_json:
        _say_findings(session, before)
    if not any(session.ranges.values()):
        outcome = Outcome(
            "No movement was made twice and far enough; nothing was saved.", "WARNING"
        )
        _tell(outcome, session, before, plain=plain, as_json=as_json)
        return False
    wanted: FilterName | None = calm if calm != before.filter else None
    tremor_hz: float | None = None
    if asks and keyboard is not None:
        wanted, tremor_hz = _ask_filter(session, before, keyboard)
    date = time.strftime("%Y-%m-%d")
    text = write_ranges(edited.text, session.ranges, date, wanted, tremor_hz)
    lines = compare(edited.text if edited.content is not None else ProfileText(""), text)
    path = edited.store.path
    if not as_json:
        show_changes(lines, plain=plain)
    saves = yes
    if asks and keyboard is not None:
        question = "Save this as your own, although it is simulated?"
        question = question if is_simulated else "Save this?"
        saves = keyboard.choose(question, ["Save", "Save nothing"]) == 0
    if not saves:
        outcome = Outcome("Nothing was saved.", file=path, lines=lines if as_json else ())
        _tell(outcome, session, before, plain=plain, as_json=as_json)
        return False
    edited.save(text)
    effect = hand_over_saved(edited.name)
    outcome = Outcome(
        f"Saved {path}",
        effect.status,
        file=path,
        changed=True,
        lines=lines if as_json else (),
        notes=(effect.text, "Back to the one before: neurotouch calibrate --undo"),
        fix=effect.fix,
    )
    _tell(outcome, session, before, plain=plain, as_json=as_json)
    return True


def relieve_weak_sides(
    session: "CalibrationSession", keyboard: "Keyboard | None", *, plain: bool
) -> None:
    """Names the weak sides, and offers help for each if the person can be asked.

    Args:
        session: what was measured.
        keyboard: reads the person's answers; None if there is none.
        plain: one fact a line.
    """
    from neurotouch_hid.profile.calibration import find_weak_sides

    for side in find_weak_sides(session.ranges):
        _relieve(side, keyboard, plain=plain)


def undo_calibration(*, plain: bool, as_json: bool) -> None:
    """Takes back the last calibration; again, the one before. Everything else stays as it is.

    Raises:
        ProfileError: there is none to take back, or it cannot be saved.
    """
    from neurotouch_hid.profile.calibration import undo_ranges
    from neurotouch_hid.profile.editing import compare, hand_over_saved, take_user

    edited = take_user(make_stamp)
    text = edited.undo_kind("calibration", undo_ranges)
    if text is None:
        raise ProfileError(
            "There is no calibration to undo.", hint="Versions: neurotouch profile history user"
        )
    edited.save(text)
    path, lines = edited.store.path, compare(edited.text, text)
    effect = hand_over_saved(edited.name)
    outcome = Outcome(
        "Ranges, unused movements and tremor are as before that calibration.",
        effect.status,
        file=path,
        changed=True,
        lines=lines,
        notes=(effect.text,),
        fix=effect.fix,
    )
    outcome.tell(plain=plain, as_json=as_json)


def _say_findings(session: "CalibrationSession", before: "UserSettings") -> None:
    if session.ranges:  # else the rest may not have been measured to its end either
        echo(f"Noise at rest: below {session.rest_mm:g} mm")
    tremor = session.tremor
    if tremor is not None:
        echo(f"Tremor: {tremor.frequency_hz:.1f} Hz, {tremor.amplitude_mm:.1f} mm")
    elif session.tremor_filter is not None:
        echo("Tremor: none")
    for name, count in session.unfinished.items():
        times = "once" if count == 1 else f"{count} times"
        echo(f"{MOVEMENTS[name].words}: made {times}, needs {LEAST_PEAKS}; it stays as it was")
    for name, range_ in session.ranges.items():
        old = getattr(before.range, name)
        was = (
            f"{old.rest:g} to {old.full:g} mm" if old is not None else "that of the reference hand"
        )
        if name in before.unused:
            was = "not used"
        now = f"{range_.rest:g} to {range_.full:g} mm" if range_ is not None else "not used"
        echo(f"{MOVEMENTS[name].words}: was {was}, now {now}")


def _tell(
    outcome: Outcome,
    session: "CalibrationSession",
    before: "UserSettings",
    *,
    plain: bool,
    as_json: bool,
) -> None:
    if as_json:
        print_json({**outcome.report(), **_report(session, before)})
    else:
        outcome.tell(plain=plain, as_json=False)


def _report(session: "CalibrationSession", before: "UserSettings") -> dict[str, Any]:
    """Returns the results as plain values."""
    from neurotouch_hid.profile.calibration import find_weak_sides

    tremor = session.tremor
    return {
        "rest_mm": session.rest_mm,
        "tremor": None
        if tremor is None
        else {"frequency_hz": tremor.frequency_hz, "amplitude_mm": tremor.amplitude_mm},
        "filter": session.tremor_filter,
        "movements": [
            {
                "movement": name,
                "was": _report_range(getattr(before.range, name)),
                "now": _report_range(range_),
                "used": range_ is not None,
                "peaks_mm": session.peaks_mm.get(name, []),
            }
            for name, range_ in session.ranges.items()
        ],
        "weak": [
            {"weak": side.weak, "strong": side.strong, "share": side.share}
            for side in find_weak_sides(session.ranges)
        ],
    }


def _report_range(range_: "MovementRange | None") -> dict[str, float] | None:
    return None if range_ is None else {"rest": range_.rest, "full": range_.full}


def _ask_filter(
    session: "CalibrationSession", before: "UserSettings", keyboard: "Keyboard"
) -> "tuple[FilterName | None, float | None]":
    """Returns the filter and the frequency to set; None leaves one as it is."""
    calm, tremor = session.tremor_filter, session.tremor
    wanted = calm if calm != before.filter else None
    hz = tremor.frequency_hz if tremor is not None and calm not in (None, "none") else None
    if wanted is None and (hz is None or before.tremor_hz is not None):
        return None, None
    question = f"The filter '{calm}' is calm enough for you. A stronger filter keeps the output "
    question += "steadier, and everything comes a little later."
    answers = [f"Leave it as it is ({before.filter or 'the profile decides'})"]
    if wanted is not None:
        answers.insert(0, f"Set it to {wanted}")
    if hz is not None:
        more = f"Use {calm}, and take out your own tremor of {hz:.1f} Hz: calmer still, 45 ms later"
        answers.append(more)
    answer = answers[keyboard.choose(question, answers)]
    if answer.startswith("Leave"):
        return None, None
    return wanted, hz if answer.startswith("Use") else None


def _relieve(side: "WeakSide", keyboard: "Keyboard | None", *, plain: bool) -> None:
    """Offers the three assists for a weak side; without a keyboard it only names them."""
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.editing import list_substitutes, make_when, remap, take_profile

    weak, strong = MOVEMENTS[side.weak].words, MOVEMENTS[side.strong].words
    user = load_user()
    profile = user.slots[0]
    size = f"goes {100 * side.share:.0f} % as far as" if side.share else "is not used, unlike"
    small = "Keep it: with its own range, a small movement counts as a whole one"
    ways = [
        small if side.share else "Keep it: nothing you play will need it if you bind nothing to it",
        f"Let a long {strong} do what {weak} does in the profile '{profile}'; two short ones turn "
        "round a stick, the pointer or the wheel",
        f"Let a short push do what {weak} does in the profile '{profile}', or turn that round",
    ]
    if keyboard is None:
        echo(f"{weak} {size} {strong}.")
        return
    choice = keyboard.choose(f"{weak} {size} {strong}. What do you want to do?", ways)
    if choice == 0:
        return
    substitutes = list_substitutes(side.weak, user.unused)
    if choice == 2:
        way = _SIDES[keyboard.choose("Which way?", _SIDES)]
        pushes = [make_when(f"push_{way}", press) for press in ("tap", "double", "hold")]
        substitutes = [*pushes, *substitutes]
    edited = take_profile(profile, make_stamp)
    edited.check(edited.text).require()
    done = remap(edited.text, side.weak, substitutes)
    for what in done.moved:
        echo(f"For you: {what}")
    for what in done.left:
        say("WARNING", f"No other gesture is free for: {what}", plain=plain)
    if done.moved:
        save_edited(edited, done.text, plain=plain)
    else:
        say("OK", f"{weak} does nothing else in '{profile}', nothing has changed.", plain=plain)
