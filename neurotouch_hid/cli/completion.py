"""``neurotouch completion``: prints the tab completion of a shell."""

import click

from neurotouch_hid.cli.main import cli
from neurotouch_hid.cli.ui.shells import Bash, Fish, Zsh

_SHELLS = {"bash": Bash, "zsh": Zsh, "fish": Fish}


@click.command(
    epilog="\b\nExamples:\n"
    '  eval "$(neurotouch completion bash)"      in ~/.bashrc\n'
    '  eval "$(neurotouch completion zsh)"       in ~/.zshrc, behind compinit\n'
    "  neurotouch completion fish > ~/.config/fish/completions/neurotouch.fish"
)
@click.argument("shell", type=click.Choice(list(_SHELLS)))
def command(shell: str) -> None:
    """Print the tab completion for SHELL."""
    click.echo(_SHELLS[shell](cli, {}, "neurotouch", "_NEUROTOUCH_COMPLETE").source())
