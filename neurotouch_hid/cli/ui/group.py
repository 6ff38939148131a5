"""A command whose sub-commands are imported only when they are used."""

import difflib
import importlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from neurotouch_hid.cli.ui.usage_errors import WrongUsage, explain_usage
from neurotouch_hid.errors import NeuroTouchError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

_OTHER_WORDS = {
    "stop": ("quit", "exit", "end", "kill", "off"),
    "run": ("start", "play", "on"),
    "resume": ("continue", "unpause", "go"),
    "calibrate": ("calibration", "measure"),
    "record": ("capture",),
    "new": ("create", "add", "copy"),
    "list": ("ls",),
    "show": ("cat", "print"),
}
"""Words that people may type instead of a name."""

_PAGES = ("help", "version")
"""Options that people may type as a command."""
_REMOVING = ("remove", "rm")
"""Words that can mean a whole profile or one binding."""

_CALLED = f"{__name__}.called"
"""Where a context keeps the name of the sub-command, the sub-command and its words."""

DEVTOOLS = "neurotouch_devtools"
"""The distribution with the emulated camera and the long benchmarks; it may be missing."""


class LazyGroup(click.Group):
    """Knows the names of its sub-commands and imports only the module of the one that is used.

    Args:
        name: its name, or None.
        places: the module of each sub-command, and its name there.
        summaries: a line about each, in the order of the help page.
        **settings: those of every group.
    """

    def __init__(
        self,
        name: str | None = None,
        *,
        places: Mapping[str, tuple[str, str]],
        summaries: Mapping[str, str],
        **settings: object,
    ) -> None:
        super().__init__(name, **settings)  # type: ignore[arg-type]
        self._places = places
        self._summaries = summaries

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Returns the names, in the order of the help page."""
        return list(self._summaries)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Returns the sub-command; None if none has that name."""
        if cmd_name not in self._summaries:
            return None
        module, name = self._places[cmd_name]
        try:
            command: click.Command = getattr(importlib.import_module(module), name)
        except ModuleNotFoundError as error:
            if (error.name or "").partition(".")[0] != DEVTOOLS:
                raise
            return _explain_missing(cmd_name)
        command.name = cmd_name  # of the function it has "command"; the documents show this one
        return command

    def shell_complete(self, ctx: click.Context, incomplete: str) -> "list[CompletionItem]":
        """Returns what the shell offers, also without importing any."""
        from click.shell_completion import CompletionItem

        names = [
            CompletionItem(name, help=summary)
            for name, summary in self._summaries.items()
            if name.startswith(incomplete)
        ]
        return [*names, *click.Command.shell_complete(self, ctx, incomplete)]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Returns the sub-command; if none has the name, the error names the nearest one."""
        name = args[0]
        if name in self._summaries or name.startswith("-"):
            found = super().resolve_command(ctx, args)
            _, command, words = found
            ctx.meta[_CALLED] = name, command, (*words,)  # parsing takes words away
            _refuse_twice(command, words)
            return found
        near = [each for each, others in _OTHER_WORDS.items() if name.lower() in others]
        near = [each for each in near if each in self._summaries]
        near = near or difflib.get_close_matches(name.lower(), self._summaries, 1)
        fix = f"Did you mean: {ctx.command_path} {near[0]}" if near else ""
        if name in _PAGES:
            fix = f"Did you mean: {ctx.command_path if name == 'help' else 'neurotouch'} --{name}"
        elif name.lower() in _REMOVING and "unbind" in self._summaries:
            fix = "A profile: neurotouch profile delete. A binding: neurotouch profile unbind"
        fix = fix or f"All commands: {ctx.command_path} --help"
        raise WrongUsage(f"There is no command '{name}'.", hint=fix)

    def invoke(self, ctx: click.Context) -> Any:
        """Runs the sub-command. If that is to print JSON, a failure or wrong usage is JSON too.

        The keys are those of every outcome, and the exit code is the same.
        """
        ctx.meta.pop(_CALLED, None)
        try:
            return super().invoke(ctx)
        except (NeuroTouchError, click.UsageError) as error:
            name, command, words = ctx.meta.get(_CALLED, (None, None, ()))
            if isinstance(error, click.UsageError) and command is not None:
                # Of some errors click does not say in which command they are.
                error.ctx = error.ctx or click.Context(command, info_name=name, parent=ctx)
            if not _prints_json(command, words):
                raise
            from neurotouch_hid.cli.ui.output import print_json

            message, fix = (
                explain_usage(error)
                if isinstance(error, click.UsageError)
                else (error.message, error.hint)
            )
            print_json({"status": "FAILED", "message": message, "fix": fix})
            ctx.exit(error.exit_code)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes names and summaries without importing any sub-command."""
        with formatter.section("Commands"):
            formatter.write_dl(list(self._summaries.items()))


def _prints_json(command: click.Command | None, words: Sequence[str]) -> bool:
    """Returns whether a command was asked for JSON, also in a command line that is wrong."""
    params = [] if command is None else command.params
    return "--json" in words and any(param.name == "as_json" for param in params)


def _refuse_twice(command: click.Command | None, args: list[str]) -> None:
    """Makes sure that no option with one value is given two, of which click would drop one.

    Raises:
        WrongUsage: one is.
    """
    words = [word.partition("=")[0] for word in args[: [*args, "--"].index("--")]]
    for param in command.params if command is not None else ():
        if isinstance(param, click.Option) and not param.is_flag and not param.multiple:
            given = [word for word in words if word in param.opts]
            if len(given) > 1:
                raise WrongUsage(
                    f"Option {given[0]} is there {len(given)} times, but takes one value.",
                    hint=f"Write only one {given[0]}.",
                )


def _explain_missing(name: str) -> click.Command:
    """Returns a substitute for a command of the development tools that says how to get them."""

    @click.command(name, context_settings={"ignore_unknown_options": True})
    @click.argument("anything", nargs=-1, type=click.UNPROCESSED)
    def command(anything: tuple[str, ...]) -> None:  # noqa: ARG001
        """Belongs to the development tools, which are not installed."""
        raise NeuroTouchError(
            f"'{name}' belongs to the development tools, which are not installed.",
            hint="In a checkout of the project: pip install ./devtools",
        )

    return command
