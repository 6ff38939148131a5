"""``neurotouch panic``: see ``order``; this is its help page."""

import click

from neurotouch_hid.cli.order import give_order


@click.command(epilog="\b\nExamples:\n  neurotouch panic")
@click.option("--json", "as_json", is_flag=True, help="Print the answer as JSON.")
def command(as_json: bool) -> None:
    """Release everything and stay released until you resume.

    Nothing but 'neurotouch resume' or a new start of the driver ends this.
    """
    raise SystemExit(give_order("panic", as_json=as_json))
