"""A command whose sub-commands are imported only when they are used."""

import importlib
from collections.abc import Mapping

import click

DEVTOOLS = "neurotouch_devtools"
"""The distribution with the emulated camera and the long benchmarks; not everybody has it."""


class LazyGroup(click.Group):
    """Knows the names of its sub-commands and imports only the module of the one that is used.

    Args:
        name: what it is called, or None.
        places: the module of each sub-command, and how it is called there.
        summaries: what each does, in a line; in the order of the help page.
        **settings: as of every group.
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
        """The names, in the order of the help page."""
        return list(self._summaries)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The sub-command; None if there is none of that name."""
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

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes names and summaries without importing any sub-command."""
        with formatter.section("Commands"):
            formatter.write_dl(list(self._summaries.items()))


def _explain_missing(name: str) -> click.Command:
    """Returns a stand-in for a command of the development tools that says how to get them."""

    @click.command(name, context_settings={"ignore_unknown_options": True})
    @click.argument("anything", nargs=-1, type=click.UNPROCESSED)
    def command(anything: tuple[str, ...]) -> None:  # noqa: ARG001
        """Belongs to the development tools, which are not installed."""
        raise click.ClickException(
            f"'{name}' belongs to the development tools, which are not installed.\n"
            "Fix: in a checkout of the project: pip install ./devtools"
        )

    return command
