"""``neurotouch demo``: drives the pad from a simulated gel."""

from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.completing import complete_profile_or_path, complete_scene
from neurotouch_hid.cli.ui.options import gel_option, method_option, seconds_option
from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.cli.ui.usage_errors import WrongUsage

if TYPE_CHECKING:
    from neurotouch_hid.source import Source

_PROFILE = "spacecraft"
_WEBCAM = ",uvc=60,rolling=12,gamma,mjpeg"
"""The nuisances that make the simulated camera an ordinary webcam."""


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch demo                      all gestures in turn, until Ctrl-C\n"
    "  neurotouch demo --scene pinch --seconds 10   repeats the pinch for ten seconds\n"
    "  neurotouch demo --mouse              press the gel yourself, on a page in your browser\n"
    "  neurotouch demo --camera uvc         the same gestures, seen by a simulated webcam\n"
    "  neurotouch demo --show lines         plain lines, for screen readers"
)
@click.option(
    "--scene",
    default="tour",
    shell_complete=complete_scene,
    show_default=True,
    help="Scene of the simulator.",
)
@click.option(
    "--camera",
    type=click.Choice(["davis", "uvc"]),
    default="davis",
    show_default=True,
    help="A simulated DAVIS-346, or a simulated webcam with 60 frames a second.",
)
@click.option("--mouse", is_flag=True, help="Press the gel with mouse, touch or keyboard.")
@click.option("--page/--no-page", default=True, help="Serve the live view and the spacecraft too.")
@click.option(
    "--profile",
    shell_complete=complete_profile_or_path,
    show_default="spacecraft; with --mouse your favourite, if you have chosen one",
    help="Name or path.",
)
@method_option
@gel_option
@seconds_option
@click.option(
    "--show",
    type=click.Choice(["auto", "picture", "lines"]),
    default="auto",
    show_default=True,
    help="auto: a picture on a wide terminal, else lines.",
)
def command(
    scene: str,
    camera: str,
    mouse: bool,
    page: bool,
    profile: str | None,
    method: str,
    gel: str | None,
    seconds: float | None,
    show: str,
) -> None:
    """Let a simulated gel drive the pad: no camera needed.

    Where this machine allows it, the pad is a real game controller that every program sees. The
    demo ends with its scene; the tour repeats until Ctrl-C, every scene until --seconds are over.
    """
    if mouse and not page:
        raise WrongUsage("Option --mouse needs the page.", hint="Leave out --no-page.")
    if mouse and camera != "davis":
        raise WrongUsage("The gel under the mouse has no other camera.", hint="Leave out --camera.")
    from neurotouch_hid.source.check import check_source

    played = "sim:rest" if mouse else f"sim:{scene.removeprefix('sim:')}"
    if camera == "uvc":
        played += _WEBCAM
    check_source(played)
    from neurotouch_hid.driver import DriverOptions
    from neurotouch_hid.driver.check import check_start
    from neurotouch_hid.players import find_player, find_runtime_folder

    options = DriverOptions(
        source=played,
        profile=profile or (_find_favourite() if mouse else None) or _PROFILE,
        method=method,
        gel=gel,
        copilot="",
        player=find_player(),
        needs_device=False,
    )
    check_start(options)
    from neurotouch_hid.cli.shared.demo_page import open_page
    from neurotouch_hid.cli.shared.play import play
    from neurotouch_hid.driver import Driver
    from neurotouch_hid.driver.gel_file import choose_gel
    from neurotouch_hid.source import open_source
    from neurotouch_hid.source.mouse_gel import MouseSource
    from neurotouch_hid.tracker import GelFinder

    drawn = choose_gel(gel, options.source).gel
    make_source: Callable[[], Source] | None = None
    if mouse:
        make_source = partial(MouseSource, find_runtime_folder(), gel=drawn)
    elif seconds is not None:
        make_source = partial(
            open_source, options.source, repeats=True, gel=drawn, finder=GelFinder(drawn)
        )
    with (
        Driver(options, announce=partial(echo, err=True), make_source=make_source) as driver,
        ExitStack() as stack,
    ):
        if isinstance(driver.source, MouseSource):
            driver.taps.append(driver.source.watch)
        if page:
            stack.enter_context(open_page("gel" if mouse else ""))
        play(driver, show=show, seconds=seconds)


def _find_favourite() -> str | None:
    """Returns the first of the person's favourites; None if they have chosen none.

    Raises:
        ProfileError: the file with the person's values cannot be used.
    """
    from neurotouch_hid.profile import load_user

    user = load_user()
    return user.slots[0] if "slots" in user.model_fields_set else None
