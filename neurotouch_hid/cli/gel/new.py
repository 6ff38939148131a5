"""``neurotouch gel new``: writes ``gel.yaml`` by a few questions."""

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.options import Finite, PlainName
from neurotouch_hid.cli.ui.output import choose, echo
from neurotouch_hid.cli.ui.usage_errors import WrongUsage
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.partial_file import write_whole

if TYPE_CHECKING:
    from neurotouch_hid.driver.making_settings import Camera

_CAMERAS = ("webcam", "ps3eye", "board", "davis346", "own")
_HANDS = ("small", "medium", "large")
_WAYS = ("evening", "printed", "cast")


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch gel new\n"
    "  neurotouch gel new --camera webcam --hand large --way evening\n"
    "  neurotouch gel new try.yaml --camera own --width 640 --height 480 --view 60 --hand small "
    "--way cast"
)
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False), required=False)
@click.option("--camera", type=click.Choice(_CAMERAS), help="The camera. Asked if not given.")
@click.option("--width", type=click.IntRange(120, 8000), help="Of --camera own, px.")
@click.option("--height", type=click.IntRange(120, 8000), help="Of --camera own, px.")
@click.option(
    "--view",
    type=Finite(min=15.0, max=100.0),
    help="Of --camera own: the angle that its picture shows from top to bottom, degrees.",
)
@click.option("--hand", type=click.Choice(_HANDS), help="Size of the hand. Asked if not given.")
@click.option("--way", type=click.Choice(_WAYS), help="How it is made. Asked if not given.")
@click.option(
    "--name", type=PlainName(), default="own", show_default=True, help="What you call the gel."
)
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def command(
    file: Path | None,
    camera: str | None,
    width: int | None,
    height: int | None,
    view: float | None,
    hand: str | None,
    way: str | None,
    name: str,
    force: bool,
) -> None:
    """Write the gel's FILE; without FILE, your own gel.yaml, which the driver reads.

    What the options do not say is asked. A file that is there stays as it is without --force.
    """
    from neurotouch_hid.driver.gel_file import FILE, find_gel_folder
    from neurotouch_hid.driver.gel_settings import GelSettings
    from neurotouch_hid.gel_making.cameras import CAMERAS, HANDS, WAYS, write_gel_file
    from neurotouch_hid.gel_making.plan import make_plan
    from neurotouch_hid.profile.reading import parse_settings

    path = file or find_gel_folder() / FILE
    if path.exists() and not force:
        raise ProfileError(
            f"There is a gel '{path}' already.",
            hint="Give another FILE, or add --force to replace it.",
        )
    own = (width, height, view)
    if camera != "own" and any(each is not None for each in own):
        raise WrongUsage(
            "The options --width, --height and --view are for --camera own.",
            hint="Add --camera own, or leave them out.",
        )
    cameras = {key: what for key, (what, _) in CAMERAS.items()}
    cameras["own"] = "another camera: you give its picture and its angle"
    camera = camera or _ask("Which camera looks at the gel?", "--camera", cameras)
    hands = {key: each.what for key, each in HANDS.items()}
    hand = hand or _ask("Whose hand plays?", "--hand", hands)
    way = way or _ask("How do you want to make it?", "--way", {str(k): v for k, v in WAYS.items()})
    chosen = CAMERAS[camera][1] if camera != "own" else _describe_camera(*own)
    chosen_way = next(each for each in WAYS if each == way)
    text = write_gel_file(name, chosen, HANDS[hand], chosen_way)
    plan = make_plan(parse_settings(text.encode(), str(path), GelSettings))
    try:
        if file is None:
            path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text.encode())
    except OSError as error:
        raise ProfileError.of_writing(path, error) from error
    echo(f"'{path}' is written: {plan.gel.n_markers} dots, camera {plan.distance:.0f} mm below.")
    option = "" if file is None else f" --gel {shlex.quote(str(path))}"
    echo(f"Next: neurotouch gel make my-gel{option}")


def _ask(question: str, option: str, choices: Mapping[str, str]) -> str:
    if not sys.stdin.isatty():
        raise WrongUsage(
            f"The option {option} is missing, and there is no terminal to ask.",
            hint=f"Add {option} and one of: {', '.join(choices)}.",
        )
    return list(choices)[choose(question, list(choices.values()), default=0)]


def _describe_camera(width: int | None, height: int | None, view: float | None) -> "Camera":
    from neurotouch_hid.driver.making_settings import Camera

    missing = [
        option
        for option, value in (("--width", width), ("--height", height), ("--view", view))
        if value is None
    ]
    if missing and not sys.stdin.isatty():
        raise WrongUsage(
            f"The camera 'own' needs {', '.join(missing)}.",
            hint="The data sheet of the camera says them.",
        )
    if width is None:
        width = click.prompt("Width of its picture in pixels", type=click.IntRange(120, 8000))
    if height is None:
        height = click.prompt("Height of its picture in pixels", type=click.IntRange(120, 8000))
    if view is None:
        view = click.prompt(
            "Angle that the picture shows from top to bottom, in degrees",
            type=Finite(min=15.0, max=100.0),
        )
    return Camera(name="own", width_px=width, height_px=height, view_deg=view)
