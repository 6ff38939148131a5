"""Options that several commands share, so that they are called and mean the same everywhere."""

import difflib

import click
from click.shell_completion import CompletionItem

_METHODS = ("neurotouch", "paper")  # gesture.method.BUILT_IN, without loading its kernels


class MethodName(click.ParamType):  # type: ignore[type-arg]  # generic from click 8.5 on
    """The name of a method: one of ours, or of a package that offers its own."""

    name = "method"

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Returns the name if there is such a method."""
        if value not in _METHODS:
            from neurotouch_hid.plugins import METHODS, list_plugins

            known = (*_METHODS, *list_plugins(METHODS))
            if value not in known:
                near = difflib.get_close_matches(value, known, 1)
                guess = f" Did you mean '{near[0]}'?" if near else ""
                self.fail(f"no method '{value}'; methods: {', '.join(known)}.{guess}", param, ctx)
        return value

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        """Returns what the help page shows."""
        return f"[{'|'.join(_METHODS)}|...]"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Returns the names that begin so."""
        from neurotouch_hid.plugins import METHODS, list_plugins

        known = (*_METHODS, *list_plugins(METHODS))
        return [CompletionItem(name) for name in known if name.startswith(incomplete)]


method_option = click.option(
    "--method",
    type=MethodName(),
    default=_METHODS[0],
    show_default=True,
    help="How gestures are recognised; packages can add methods.",
)
profile_option = click.option(
    "--profile",
    show_default="the first of your favourites",
    help="Name or path of a profile.",
)
source_option = click.option(
    "--source",
    default="davis:",
    show_default=True,
    help="davis: (the camera), file:NAME.aedat4 (a recording) or sim:NAME (the simulator).",
)
speed_option = click.option(
    "--speed",
    type=click.Choice(["recorded", "max"]),
    default="recorded",
    show_default=True,
    help="As recorded, or as fast as possible; then nothing waits for a person.",
)
seed_option = click.option(
    "--seed", default=0, show_default=True, help="Seed of whatever is simulated."
)
seconds_option = click.option(
    "--seconds", type=click.FloatRange(min=0.1), help="End by itself after so long."
)
rate_option = click.option(
    "--rate",
    "rate_hz",
    type=click.FloatRange(min=25.0, max=1000.0),
    metavar="HZ",
    show_default="250 of a camera, 100 (the paper's) of anything else",
    help="Gestures a second: more answer sooner and cost more processor time.",
)
