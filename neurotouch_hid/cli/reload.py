"""``neurotouch reload``: the running driver loads its profile again."""

import click

from neurotouch_hid.cli.order import give_order


@click.command(epilog="\b\nExamples:\n  neurotouch reload")
@click.option("--json", "as_json", is_flag=True, help="Print the answer as JSON.")
def command(as_json: bool) -> None:
    """Load the profile and your own values again, now.

    Saved files are noticed within a second anyway. A profile with errors changes nothing: why is
    said, and the exit code is 8.
    """
    raise SystemExit(give_order("reload", as_json=as_json))
