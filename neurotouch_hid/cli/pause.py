"""``neurotouch pause``: see ``order``; this is its help page."""

import click

from neurotouch_hid.cli.order import give_order


@click.command(epilog="\b\nExamples:\n  neurotouch pause")
@click.option("--json", "as_json", is_flag=True, help="Print the answer as JSON.")
def command(as_json: bool) -> None:
    """Release everything and stop acting; tracking goes on.

    The same gesture of the profile that pauses, if it has one, or 'neurotouch resume' goes on.
    """
    raise SystemExit(give_order("pause", as_json=as_json))
