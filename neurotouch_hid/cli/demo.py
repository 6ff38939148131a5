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
    if mouse and not page:
        raise click.UsageError("--mouse needs the page")
    from neurotouch_hid.cli.demo_page import open_page
    from neurotouch_hid.cli.play import announce, play
    from neurotouch_hid.client import find_runtime_folder
    from neurotouch_hid.driver import Driver, DriverOptions
    from neurotouch_hid.source.mouse import MouseSource

    options = DriverOptions(
        source="sim:rest" if mouse else f"sim:{scene}",
        profile=profile,
        copilot="",
        needs_device=False,
    )
    hand = (lambda: MouseSource(find_runtime_folder())) if mouse else None
    with Driver(options, announce=announce, make_source=hand) as driver, ExitStack() as stack:
        if isinstance(driver.source, MouseSource):
            driver.taps.append(driver.source.watch)
        if page:
            stack.enter_context(open_page("gel" if mouse else ""))
        play(driver, show=show, seconds=seconds)
