"""``neurotouch demo``: the simulated gel drives the pad."""

from contextlib import ExitStack

import click

from neurotouch_hid.cli.ui.options import seconds_option


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch demo                      all gestures in turn, until Ctrl-C\n"
    "  neurotouch demo --scene pinch --seconds 10\n"
    "  neurotouch demo --mouse              press the gel yourself, on a page in your browser\n"
    "  neurotouch demo --show lines         plain lines, for screen readers"
)
@click.option("--scene", default="tour", show_default=True, help="What the simulated hand does.")
@click.option("--mouse", is_flag=True, help="Press the gel with mouse, touch or keyboard.")
@click.option("--page/--no-page", default=True, help="Serve the live view and the spacecraft too.")
@click.option("--profile", default="spacecraft", show_default=True, help="Name or path.")
@seconds_option
@click.option(
    "--show",
    type=click.Choice(["auto", "picture", "lines"]),
    default="auto",
    show_default=True,
    help="auto: a picture on a terminal, else lines.",
)
def command(
    scene: str, mouse: bool, page: bool, profile: str, seconds: float | None, show: str
) -> None:
    """Let a simulated gel drive the pad: no camera needed.

    Where this machine allows it, the pad is a real game controller that every program sees.
    """
    from neurotouch_hid.cli.demo_page import open_page
    from neurotouch_hid.cli.play import play, prepare_kernels
    from neurotouch_hid.client import find_runtime_folder
    from neurotouch_hid.device import Device, open_device
    from neurotouch_hid.driver.extra_devices import find_companions
    from neurotouch_hid.driver.settings import load_driver_settings
    from neurotouch_hid.driver.wiring import Live, take_control
    from neurotouch_hid.errors import DeviceError
    from neurotouch_hid.gesture import GestureConfig
    from neurotouch_hid.profile import load_profile, load_user
    from neurotouch_hid.runtime import Pipeline, Stopwatch
    from neurotouch_hid.source import Source, open_source
    from neurotouch_hid.source.mouse import HandSource

    if mouse and not page:
        raise click.UsageError("--mouse needs the page")
    mapping, user, settings = load_profile(profile), load_user(), load_driver_settings()
    gesture = GestureConfig()
    source = "sim:rest" if mouse else f"sim:{scene}"
    with ExitStack() as stack:
        control = take_control(stack)
        hand = HandSource(find_runtime_folder()) if mouse else None
        packets: Source = stack.enter_context(hand or open_source(source))
        prepare_kernels(mapping, gesture, source)
        try:
            pad: Device = open_device("uinput", find_companions(mapping))
        except DeviceError as error:
            click.echo(f"No real controller this time: {error.message} Going on without.", err=True)
            pad = open_device("memory")
        stopwatch = Stopwatch()
        pad = stopwatch.watch("device", stack.enter_context(pad), "write")
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
                facts=hand.facts if hand is not None else None,
            )
        )
        if hand is not None:
            live.taps.append(hand.watch)
        if page:
            stack.enter_context(open_page("gel" if mouse else ""))
        title = f"SIMULATED {packets.name} → {pad.name}, profile {mapping.name}"
        play(packets, pipeline, pad, title=title, show=show, seconds=seconds, live=live)
