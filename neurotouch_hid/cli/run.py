"""``neurotouch run``: drives the gamepad from a source, by ``driver/driver.py``."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from neurotouch_hid.cli.ui.options import (
    OutFile,
    gel_option,
    method_option,
    profile_option,
    rate_option,
    seconds_option,
    seed_option,
    source_option,
    speed_option,
)
from neurotouch_hid.cli.ui.output import echo

if TYPE_CHECKING:
    from neurotouch_hid.driver import DeviceKind


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch run --source sim:tour --device memory --seconds 20   simulated, no gamepad\n"
    "  neurotouch run --profile spacecraft\n"
    "  neurotouch run --source file:play.aedat4 --speed max --device memory --trace play.jsonl\n"
    "  neurotouch run --source video:                   the webcam that shows a gel\n"
    "  neurotouch run --copilot auto                    a gamepad plays along\n"
    "  neurotouch run --player 2 --source davis:00000002 --device hid --profile racing\n\n"
    "Ctrl-C ends; the pad goes neutral first. Exit code 0 at the end, also after --seconds or\n"
    "Ctrl-C; 3 source, 4 recording, 5 no gel, 6 profile, 7 gamepad, 75 another driver runs."
)
@profile_option
@source_option
@click.option(
    "--device",
    type=click.Choice(["uinput", "hid", "memory"]),
    default="uinput",
    show_default=True,
    help="uinput: a gamepad that every program sees; hid: a HID gamepad; memory: none.",
)
@click.option(
    "--identity",
    show_default="xbox360; own with hid",
    help="Controller model to emulate: xbox360, own, playstation, or a .toml file of your own.",
)
@click.option(
    "--copilot",
    help="A pad, keyboard or switch that plays along: auto, a node, or a part of its name.",
)
@click.option(
    "--rumble", is_flag=True, help="Offer rumble to games, although only the live view shows it."
)
@click.option(
    "--player",
    type=click.IntRange(1, 4),
    default=1,
    envvar="NEUROTOUCH_PLAYER",
    show_default=True,
    help="Player number; each player has a driver, a pad and a profile of their own.",
)
@speed_option
@rate_option
@method_option
@gel_option
@seed_option
@seconds_option
@click.option(
    "--trace",
    type=OutFile(),
    help="Write one JSON line per slice to this file.",
)
@click.option(
    "--show",
    type=click.Choice(["auto", "picture", "lines", "nothing"]),
    default="auto",
    show_default=True,
    help="What to print while playing; auto: a picture on a wide terminal, else lines. Lines are "
    "for screen readers, too.",
)
def command(
    profile: str | None,
    source: str,
    device: "DeviceKind",
    identity: str | None,
    copilot: str | None,
    rumble: bool,
    player: int,
    speed: Literal["recorded", "max"],
    rate_hz: float | None,
    method: str,
    gel: str | None,
    seed: int,
    seconds: float | None,
    trace: Path | None,
    show: str,
) -> None:
    """Drive the virtual gamepad from the gel until the source ends, the time is over or Ctrl-C.

    A camera does not end; a recording ends once. Of the simulated scenes tour, noise, random and
    rest repeat for ever; all others end after one pass. --source sim: lists them.
    """
    from neurotouch_hid.source.check import check_source

    check_source(source)
    from neurotouch_hid.driver import DriverOptions
    from neurotouch_hid.driver.check import check_start
    from neurotouch_hid.errors import DeviceError

    options = DriverOptions(
        source=source,
        profile=profile,
        device=device,
        identity=identity,
        copilot=copilot,
        player=player,
        speed=speed,
        rate_hz=rate_hz,
        method=method,
        gel=gel,
        seed=seed,
        shows_rumble=rumble,
    )
    try:
        check_start(options)
        from neurotouch_hid.cli.shared.play import play
        from neurotouch_hid.driver import Driver

        with Driver(options, announce=partial(echo, err=True)) as driver:
            play(driver, show=show, trace=trace, seconds=seconds)
    except DeviceError as error:
        if device == "memory":
            raise
        without = "To try it without a gamepad: --device memory."
        hint = "\n".join(filter(None, (error.hint, without)))
        raise DeviceError(error.message, hint=hint) from error
