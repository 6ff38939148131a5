"""``neurotouch bench pointing``: measures how well a person points, also after a change."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from neurotouch_hid.cli.shared.silent_driver import is_guided, open_silent_driver
from neurotouch_hid.cli.ui.options import (
    OutFile,
    method_option,
    profile_option,
    seed_option,
    source_option,
    speed_option,
)
from neurotouch_hid.cli.ui.output import echo, save_json
from neurotouch_hid.cli.ui.usage_errors import WrongUsage

if TYPE_CHECKING:
    from neurotouch_hid.evaluation.people.pointing import Pointing
    from neurotouch_hid.evaluation.people.throughput import Trial
    from neurotouch_hid.messages import GamepadState

_TOLD_US = 1_000_000
_SIMULATED = "SIMULATED: a program moved, so the figures say nothing about a person."


@click.command(
    name="pointing",
    epilog="\b\nExamples:\n"
    "  neurotouch bench pointing --json before.json     then change something, and:\n"
    "  neurotouch bench pointing --compare before.json\n"
    "  neurotouch bench pointing --simulated            a simulated test, no gel needed",
)
@profile_option
@source_option
@speed_option
@click.option(
    "--select",
    type=click.Choice(["dwell", "button"]),
    default="dwell",
    show_default=True,
    help="Select by resting for half a second, or by any button of the profile.",
)
@click.option(
    "--targets",
    type=click.Choice(["3", "5", "7", "9", "11", "13", "25"]),
    default="9",
    show_default=True,
    help="Number of targets of each of the two sizes.",
)
@click.option("--simulated", is_flag=True, help="A simulated subject takes the test.")
@seed_option
@click.option(
    "--json",
    "json_path",
    type=OutFile(),
    help="Save the result to this file.",
)
@click.option(
    "--compare",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Compare with a result saved before.",
)
@method_option
def command(
    profile: str | None,
    source: str,
    speed: Literal["recorded", "max"],
    select: str,
    targets: str,
    simulated: bool,
    seed: int,
    json_path: Path | None,
    compare: Path | None,
    method: Literal["neurotouch", "paper"],
) -> None:
    """Measure how well you point: targets around a circle, one after the other (ISO 9241-411).

    There is no time limit: Enter begins a trial, and its time begins with your first movement.
    Pushes move the pointer as the profile moves the left stick or the mouse.
    """
    from neurotouch_hid.evaluation.people.pointing import Pointing
    from neurotouch_hid.evaluation.people.subject import perform_pointing
    from neurotouch_hid.evaluation.people.throughput import (
        compare_results,
        measure_pointing,
        read_result,
    )
    from neurotouch_hid.profile import Mapping, load_profile, load_user

    if simulated and select == "button":
        raise WrongUsage("The simulated subject selects by dwell only.", hint="Leave out --select.")
    before = read_result(compare) if compare is not None else None
    user = load_user()
    name = profile or user.slots[0]
    test = Pointing(dwell=select == "dwell", targets=int(targets))
    is_simulated = simulated
    if simulated:
        echo(_SIMULATED)
        perform_pointing(test, Mapping(load_profile(name), user), seed)
        for number, trial in enumerate(test.trials, 1):
            echo(_describe(number, test.total, trial))
    else:
        with open_silent_driver(source, speed, seed, method, profile=name) as driver:
            is_simulated = driver.source.is_simulated
            if is_simulated:
                echo(_SIMULATED)
            pads = (step.pad for step in driver.steps())
            _play(test, pads, guided=is_guided(source, speed))
    figures = measure_pointing(test.trials)
    head = {"version": 1, "simulated": is_simulated, "profile": name, "select": select}
    result = {**head, "source": "subject" if simulated else source, **figures}
    echo("\n".join(_format(result, test.total)))
    if json_path is not None:
        save_json(json_path, result)
    if before is not None:
        for key in ("simulated", "select"):
            if before.get(key) != result[key]:
                echo(f"WARNING: '{key}' differs; comparing the two means little.")
        mark = "SIMULATED " if is_simulated else ""
        for line in compare_results(before, result):
            echo(f"{mark}{line}")


def _play(test: "Pointing", pads: Iterator["GamepadState"], *, guided: bool) -> None:
    """Runs trial after trial until all are done or the source ends."""
    from neurotouch_hid.cli.ui.keyboard import Keyboard

    keyboard = Keyboard() if guided else None
    if guided:
        echo("Enter = begin the next trial, Q = stop and measure the finished ones.")
    asked, told_us = -1, 0
    for pad in pads:
        if not test.is_running and asked != len(test.trials):
            asked, told_us = len(test.trials), pad.t_us
            echo(_ask(test))
        key = "" if keyboard is None else keyboard.poll()
        if key is not None and key.lower() == "q":
            return
        if not test.is_running and key is not None:
            test.begin()
        trial = test.update(pad)
        if trial is not None:
            echo(_describe(len(test.trials), test.total, trial))
            if test.is_over:
                return
        elif test.is_running and guided and pad.t_us - told_us >= _TOLD_US:
            told_us = pad.t_us
            echo(_tell_way(test))
    echo(f"The source has ended after {len(test.trials)} of {test.total} targets.")


def _ask(test: "Pointing") -> str:
    width_px, _ = test.target
    number = f"Target {len(test.trials) + 1} of {test.total}"
    return f"{number}, {width_px:.0f} pixels wide: {_tell_next(test)}."


def _tell_next(test: "Pointing") -> str:
    from neurotouch_hid.evaluation.people.pointing import name_way

    begin, end = test.start_px, test.target[1]
    return f"{name_way(begin, end)}, {_measure(begin, end):.0f} pixels away"


def _tell_way(test: "Pointing") -> str:
    from neurotouch_hid.evaluation.people.pointing import name_way

    width_px, end = test.target
    left_px = _measure(test.pointer_px, end)
    if left_px <= 0.5 * width_px:
        return "on the target"
    return f"{name_way(test.pointer_px, end)}, {left_px:.0f} pixels to go"


def _measure(begin: tuple[float, float], end: tuple[float, float]) -> float:
    return float(((end[0] - begin[0]) ** 2 + (end[1] - begin[1]) ** 2) ** 0.5)


def _describe(number: int, total: int, trial: "Trial") -> str:
    word = "hit" if trial.is_hit else "missed"
    return f"{number} of {total}: {word}, {trial.movement_s:.2f} s"


def _format(result: dict[str, Any], total: int) -> list[str]:
    mark = " (SIMULATED)" if result["simulated"] else ""
    lines = [
        f"throughput{mark}: {result['throughput_bit_s']:.2f} bit/s",
        f"movement time{mark}: {result['movement_s']:.2f} s",
        f"missed targets{mark}: {100.0 * result['error_rate']:.0f} % of {result['trials']}",
    ]
    lines += [
        f"targets {block['width_px']:.0f} pixels wide: {block['throughput_bit_s']:.2f} bit/s, "
        f"effective width {block['effective_width_px']:.0f} pixels, "
        f"effective distance {block['effective_distance_px']:.0f} pixels, "
        f"{block['movement_s']:.2f} s, {100.0 * block['error_rate']:.0f} % missed"
        for block in result["blocks"]
    ]
    if result["trials"] < total:
        lines.append(f"WARNING: only {result['trials']} of {total} targets were selected.")
    return lines
