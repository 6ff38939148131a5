"""``neurotouch reload``: the running driver loads its profile anew."""

import click


@click.command(epilog="\b\nExamples:\n  neurotouch reload")
def command() -> None:
    """Load the profile and your own values anew, now.

    Saved files are noticed within a second anyway. A profile with errors changes nothing.
    """
    from neurotouch_hid.driver import ask

    click.echo(ask("reload")["text"])
