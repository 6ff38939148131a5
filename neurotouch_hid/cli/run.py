"""``neurotouch run``: the driver."""

import os
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from neurotouch_hid.cli.ui.options import (
    method_option,
    profile_option,
    rate_option,
    seed_option,
    source_option,
    speed_option,
)

if TYPE_CHECKING:
    from neurotouch_hid.gesture import Method
    from neurotouch_hid.source import Source


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch run --source sim:tour --profile spacecraft\n"
    "  neurotouch run --source file:play.aedat4 --speed max --device memory --trace play.jsonl\n"
    "  neurotouch run --copilot auto                    a game pad plays along\n"
    "  neurotouch run --player 2 --source davis:00000002 --device hid --profile racing\n\n"
    "Ctrl-C ends; the pad goes neutral first."
)
@profile_option
@source_option
@click.option(
    "--device",
    type=click.Choice(["uinput", "hid", "memory"]),
    default="uinput",
    show_default=True,
    help="uinput makes a gamepad that every program sees; hid a true HID one; memory none.",
)
@click.option(
    "--identity",
    show_default="xbox360; own with hid",
    help="What the pad claims to be: xbox360, own, playstation, or a .toml file of your own.",
)
@click.option(
    "--copilot",
    help="A pad, keyboard or switch that plays along: auto, a node, or a part of its name.",
)
@click.option(
    "--rumble", is_flag=True, help="Let games shake the pad although only the live view shows it."
)
@click.option(
    "--player",
    type=click.IntRange(1, 4),
    default=1,
    envvar="NEUROTOUCH_PLAYER",
    show_default=True,
    help="Whose gel it is; each player has a driver, a pad and a profile of their own.",
)
@speed_option
@rate_option
@method_option
@seed_option
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
    identity: str | None,
    copilot: str | None,
    rumble: bool,
    player: int,
    speed: Literal["recorded", "max"],
    rate_hz: float | None,
    method: "Method",
    seed: int,
    trace: Path | None,
    show: str,
) -> None:
    """Drive the virtual gamepad from the gel until the source ends or Ctrl-C."""
    from neurotouch_hid.cli.play import play, prepare_kernels
    from neurotouch_hid.client import PLAYER
    from neurotouch_hid.device import check_device
    from neurotouch_hid.driver.extra_devices import find_companions
    from neurotouch_hid.driver.pad import open_pad
    from neurotouch_hid.driver.settings import load_driver_settings
    from neurotouch_hid.driver.wiring import Live, take_control
    from neurotouch_hid.gesture import GestureConfig
    from neurotouch_hid.profile import load_profile, load_user
    from neurotouch_hid.runtime import Pipeline, Stopwatch

    os.environ[PLAYER] = str(player)
    user, settings = load_user(), load_driver_settings()
    profile = profile or user.slots[0]
    mapping = load_profile(profile)
    gesture = GestureConfig(method=method)
    with ExitStack() as stack:
        # One driver at a time. As fast as possible and without a pad is a computation beside it.
        drives = speed == "recorded" or device != "memory"
        control = take_control(stack) if drives else None
        packets = stack.enter_context(_open_source(source, speed, rate_hz, seed))
        check_device(device, identity)  # before the kernels compile, and again for real after it
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
        played = open_pad(
            device,
            find_companions(mapping),
            settings,
            identity=identity,
            player=player,
            copilot=copilot,
            shows_rumble=rumble,
        )
        pad = stopwatch.watch("device", stack.enter_context(played.device), "write")
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
                    facts=played.facts,
                    copilot=played.copilot,
                )
            )
        title = f"{packets.name} → {pad.name}, profile {mapping.name}"
        play(packets, pipeline, pad, title=title, show=show, trace=trace, live=live)


def _open_source(
    source: str, speed: Literal["recorded", "max"], rate_hz: float | None, seed: int
) -> "Source":
    """The source; a camera that cannot be had because the service has it is not a mystery.

    Raises:
        AlreadyRunningError: the service has the camera.
        NeuroTouchError: as ``open_source``.
    """
    from neurotouch_hid.client import is_service_running
    from neurotouch_hid.driver.camera_settings import load_camera_config
    from neurotouch_hid.errors import AlreadyRunningError, CameraError
    from neurotouch_hid.source import open_source

    slice_us = None if rate_hz is None else round(1e6 / rate_hz)
    try:
        return open_source(
            source, slice_us=slice_us, speed=speed, seed=seed, camera=load_camera_config()
        )
    except CameraError as error:
        from neurotouch_hid.source.davis import find_cameras

        if not (find_cameras() and is_service_running()):
            raise
        raise AlreadyRunningError(
            "The neurotouch service plays already, and it has the camera.",
            hint="See what it does: neurotouch status. To play without it: "
            "sudo systemctl stop neurotouch",
        ) from error
