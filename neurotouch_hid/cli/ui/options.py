"""Options that several commands share."""

import difflib
import math
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from neurotouch_hid.cli.ui.completing import complete_profile_or_path, complete_source
from neurotouch_hid.cli.ui.output import require_writable
from neurotouch_hid.cli.ui.usage_errors import WrongUsage
from neurotouch_hid.vocabulary import NAME_PATTERN, RECORDING_ENDINGS

_METHODS = ("neurotouch", "paper")  # gesture.method.BUILT_IN, without loading its kernels


class Finite(click.FloatRange):
    """A number in a range; refuses ``nan`` and ``inf``, which Python reads as numbers."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Returns the number."""
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"'{value}' is not in the range.", param, ctx)
        return number


class OutFile(click.Path):
    """A file to be written; whether it can be is tried before the work begins.

    ``--json`` takes a file in some commands and none in others. So an option that follows is not
    taken for the file, nor is ``-`` a file's name, and no recording is written over.

    Args:
        allow_dash: ``-`` means the standard output.
    """

    def __init__(self, *, allow_dash: bool = False) -> None:
        super().__init__(dir_okay=False, path_type=Path, allow_dash=allow_dash)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Returns the path."""
        path = Path(str(super().convert(value, param, ctx)))
        option = param.opts[0] if param is not None else ""
        if str(value) == "-":
            if self.allow_dash:
                return path
            raise WrongUsage(
                f"Option {option} needs the name of a file to write, not the standard output.",
                hint="Write the name of a file instead.",
            )
        if str(value).startswith("--"):
            raise WrongUsage(
                f"Option {option} needs the name of a file to write, not the option {value}.",
                hint=f"Write the name between the two. A file of this name: {option} ./{value}",
            )
        if path.suffix.lower() in RECORDING_ENDINGS and path.exists():
            raise WrongUsage(
                f"Option {option} would write over the recording '{path}'.",
                hint=f"Name another file for {option}: it comes right behind it.",
            )
        if not path.parent.is_dir():
            raise WrongUsage(
                f"There is no folder '{path.parent}' to write '{path.name}' to.",
                hint="Make the folder, or choose another.",
            )
        require_writable(path)
        return path


class PlainName(click.ParamType):  # type: ignore[type-arg]  # generic from click 8.5 on
    """The name of a person or a gel; it can be a part of a file's name."""

    name = "name"

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Returns the name if it can be a part of a file's name."""
        import re

        if not re.fullmatch(NAME_PATTERN, value):
            from neurotouch_hid.profile.reading import propose_name

            near = propose_name(value)
            raise WrongUsage(
                f"The name '{value}' cannot be used.",
                hint=(f"Try: {near}. " if near else "")
                + "It becomes a part of a file's name: at most 64 small letters, digits, _ or -, "
                "and no - in front.",
            )
        return value


class MethodName(click.ParamType):  # type: ignore[type-arg]  # generic from click 8.5 on
    """The name of a method: one of ours, or of a package that offers its own."""

    name = "method"

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Returns the name if there is such a method."""
        if value not in _METHODS and value not in (known := _list_methods()):
            near = difflib.get_close_matches(value, known, 1)
            fix = f"Did you mean {near[0]}? " if near else ""
            raise WrongUsage(
                f"There is no method '{value}'.", hint=f"{fix}Methods: {', '.join(known)}."
            )
        return value

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        """Returns the placeholder for the help page."""
        return f"[{'|'.join(_list_methods())}]"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Returns the names that start with the typed letters."""
        return [CompletionItem(name) for name in _list_methods() if name.startswith(incomplete)]


def complete_gel(
    _context: click.Context, _parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Returns the names of gels that start with the typed letters, and files."""
    from neurotouch_hid.players import find_user_file

    suffix = ".gel.yaml"
    folder = find_user_file().parent
    names = ["paper", *(path.name.removesuffix(suffix) for path in folder.glob(f"*{suffix}"))]
    found = [CompletionItem(name) for name in sorted(names) if name.startswith(incomplete)]
    return [*found, CompletionItem(incomplete, type="file")]


def _list_methods() -> tuple[str, ...]:
    from neurotouch_hid.plugins import METHODS, list_plugins

    return (*_METHODS, *list_plugins(METHODS))


method_option = click.option(
    "--method",
    type=MethodName(),
    default=_METHODS[0],
    show_default=True,
    help="Method of recognition; packages can add methods.",
)
profile_option = click.option(
    "--profile",
    shell_complete=complete_profile_or_path,
    show_default="the first of your favourites",
    help="Name or path of a profile.",
)
source_option = click.option(
    "--source",
    shell_complete=complete_source,
    default="davis:",
    show_default=True,
    help="davis: (the camera), video: (a webcam), file:NAME.aedat4 (a recording), file:NAME.mkv (a "
    "video clip) or sim:NAME (the simulator).",
)
gel_option = click.option(
    "--gel",
    metavar="FILE or NAME",
    shell_complete=complete_gel,
    show_default="the recording's, then yours, then the paper's",
    help="The gel: a .yaml file, NAME for ~/.config/neurotouch/NAME.gel.yaml, or paper.",
)
speed_option = click.option(
    "--speed",
    type=click.Choice(["recorded", "max"]),
    default="recorded",
    show_default=True,
    help="As recorded, or as fast as possible, without pauses for a person.",
)
seed_option = click.option(
    "--seed",
    type=click.IntRange(0),
    default=0,
    show_default=True,
    help="Seed of the simulation.",
)
seconds_option = click.option(
    "--seconds",
    type=Finite(min=0.1),
    help="End after this many seconds, or before with the source.",
)
rate_option = click.option(
    "--rate",
    "rate_hz",
    type=Finite(min=25.0, max=1000.0),
    metavar="HZ",
    show_default="a camera's 250, and 1000 while the gel moves; 100 (the paper's) of anything else",
    help="Updates of the gesture a second: more react sooner and cost more processor time.",
)
