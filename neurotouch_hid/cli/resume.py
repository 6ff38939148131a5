"""``neurotouch resume``: see ``order``; this is its help page."""

import click

from neurotouch_hid.cli.order import give_order


@click.command(epilog="\b\nExamples:\n  neurotouch resume")
@click.option("--json", "as_json", is_flag=True, help="Print the answer as JSON.")
def command(as_json: bool) -> None:
    """Go on at the next gesture, after a pause or a panic.

    Whoever or whatever stopped the driver: nothing acts before the gel has been at rest.
    """
    raise SystemExit(give_order("resume", as_json=as_json))
