"""``neurotouch bench curves``: draws the pictures of the documentation that show speed."""

from pathlib import Path

import click

from neurotouch_hid.cli.ui.output import json_option, print_json


@click.command("curves", epilog="\b\nExamples:\n  neurotouch bench curves docs/pictures")
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False))
@json_option
def command(folder: Path, as_json: bool) -> None:
    """Draw latency over the rate of events, and cost over the number of markers, into FOLDER.

    Writes latency.svg and markers.svg; takes about a minute and a half.
    """
    from neurotouch_devtools.bench.curves import (
        NUMBERS,
        measure_markers,
        measure_rates,
        write_curves,
    )

    cost = {n: measure_markers(n) for n in NUMBERS}
    latency = measure_rates(lambda text: click.echo(f"{text} ...", err=True))
    paths = write_curves(folder, latency, cost)
    if as_json:
        print_json({"latency_ms": latency, "ns_per_event": cost})
    else:
        click.echo("\n".join(map(str, paths)))
