"""``neurotouch demo``: the simulated gel drives the pad."""

from contextlib import ExitStack

import click


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch demo                      all gestures in turn, until Ctrl-C\n"
    "  neurotouch demo --scene pinch --seconds 10\n"
    "  neurotouch demo --show lines         plain lines, for screen readers"
)
@click.option("--scene", default="tour", show_default=True, help="What the simulated hand does.")
@click.option("--profile", default="spacecraft", show_default=True, help="Name or path.")
@click.option("--seconds", type=click.FloatRange(min=0.1), help="End by itself after so long.")
@click.option(
    "--show",
    type=click.Choice(["auto", "picture", "lines"]),
    default="auto",
    show_default=True,
    help="auto: a picture on a terminal, else lines.",
)
def command(scene: str, profile: str, seconds: float | None, show: str) -> None:
    """Let a simulated gel drive the pad: no camera needed.

    Where this machine allows it, the pad is a real game controller that every program sees.
    """
    from neurotouch_hid.cli.live import Live, take_control
    from neurotouch_hid.cli.play import play, prepare_kernels
    from neurotouch_hid.device import open_device
    from neurotouch_hid.errors import DeviceError
    from neurotouch_hid.gesture import GestureConfig
    from neurotouch_hid.profile import load_profile, load_user
    from neurotouch_hid.runtime import (
        Pipeline,
        Stopwatch,
        find_companions,
        load_driver_settings,
    )
    from neurotouch_hid.source import open_source

    mapping, user, settings = load_profile(profile), load_user(), load_driver_settings()
    gesture = GestureConfig()
    source = f"sim:{scene}"
    with ExitStack() as stack:
        control = take_control(stack)
        packets = stack.enter_context(open_source(source))
        prepare_kernels(mapping, gesture, source)
        try:
            pad = open_device("uinput", find_companions(mapping))
        except DeviceError as error:
            click.echo(f"No real controller this time: {error.message} Going on without.", err=True)
            pad = open_device("memory")
        stack.enter_context(pad)
        stopwatch = Stopwatch()
        pipeline = Pipeline.build(
            mapping, gesture, user=user, rig=packets.rig, live=True, stopwatch=stopwatch
        )
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
        title = f"SIMULATED {packets.name} → {pad.name}, profile {mapping.name}"
        play(packets, pipeline, pad, title=title, show=show, seconds=seconds, live=live)
