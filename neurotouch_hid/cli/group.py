"""A command whose sub-commands are imported only when they are used."""

import importlib
from collections.abc import Mapping

import click


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
        command: click.Command = getattr(importlib.import_module(module), name)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes names and summaries without importing any sub-command."""
        with formatter.section("Commands"):
            formatter.write_dl(list(self._summaries.items()))
