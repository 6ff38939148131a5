"""``neurotouch run``: the driver."""

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from neurotouch_hid.cli.method import choose_method

if TYPE_CHECKING:
    from neurotouch_hid.gesture import Method


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch run --source sim:tour --profile spacecraft\n"
    "  neurotouch run --source file:play.aedat4 --speed max --device memory --trace play.jsonl\n\n"
    "Ctrl-C ends; the pad goes neutral first."
)
@click.option(
    "--profile",
    show_default="the first of your favourites",
    help="Name or path of a profile.",
)
@click.option(
    "--source",
    default="davis:",
    show_default=True,
    help="davis: (the camera), file:NAME.aedat4 (a recording) or sim:NAME (the simulator).",
)
@click.option(
    "--device",
    type=click.Choice(["uinput", "memory"]),
    default="uinput",
    show_default=True,
    help="uinput makes a gamepad that every program sees; memory makes none.",
)
@click.option(
    "--speed",
    type=click.Choice(["recorded", "max"]),
    default="recorded",
    show_default=True,
    help="As recorded, or as fast as possible.",
)
@choose_method
@click.option("--seed", default=0, show_default=True, help="Seed of the simulator.")
@click.option(
    "--trace",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write one JSON line per slice to this file.",
)
@click.option(
    "--show",
    type=click.Choice(["auto", "picture", "lines", "nothing"]),
    default="auto",
    show_default=True,
    help="What to print while playing; auto: a picture on a terminal, else lines.",
)
def command(
    profile: str | None,
    source: str,
    device: str,
    speed: Literal["recorded", "max"],
    method: "Method",
    seed: int,
    trace: Path | None,
    show: str,
) -> None:
    """Drive the virtual gamepad from the gel until the source ends or Ctrl-C."""
    from neurotouch_hid.cli.live import Live, take_control
    from neurotouch_hid.cli.play import play, prepare_kernels
    from neurotouch_hid.device import check_device, open_device
    from neurotouch_hid.gesture import GestureConfig
    from neurotouch_hid.profile import load_profile, load_user
    from neurotouch_hid.runtime import (
        Pipeline,
        Stopwatch,
        find_companions,
        load_driver_settings,
    )
    from neurotouch_hid.source import open_source

    user, settings = load_user(), load_driver_settings()
    profile = profile or user.slots[0]
    mapping = load_profile(profile)
    gesture = GestureConfig(method=method)
    with ExitStack() as stack:
        # One driver at a time. As fast as possible and without a pad is a computation beside it.
        drives = speed == "recorded" or device != "memory"
        control = take_control(stack) if drives else None
        packets = stack.enter_context(open_source(source, speed=speed, seed=seed))
        check_device(device)  # before the kernels compile, and again for real after it
        prepare_kernels(mapping, gesture, source)
        stopwatch = Stopwatch()
        pipeline = Pipeline.build(
            mapping,
            gesture,
            user=user,
            rig=packets.rig,
            live=speed == "recorded" and not packets.name.startswith("file:"),
            stopwatch=stopwatch,
        )
        pad = stack.enter_context(open_device(device, find_companions(mapping)))
        live = None
        if drives:
            live = stack.enter_context(
                Live(
                    control,
                    pipeline,
                    stopwatch,
                    pad,
                    name=profile,
                    profile=mapping,
                    user=user,
                    settings=settings,
                    source=packets.name,
                )
            )
        title = f"{packets.name} → {pad.name}, profile {mapping.name}"
        play(packets, pipeline, pad, title=title, show=show, trace=trace, live=live)
