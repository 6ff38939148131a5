"""``neurotouch bench soak``: measures memory over hours of play."""

import click

from neurotouch_hid.cli.ui.options import Finite, method_option
from neurotouch_hid.cli.ui.output import json_option, print_json


@click.command(
    "soak",
    epilog="\b\nExamples:\n"
    "  neurotouch bench soak\n"
    "  neurotouch bench soak --minutes 480              a working day, in about half an hour",
)
@click.option(
    "--minutes",
    type=Finite(min=1.0),
    default=30.0,
    show_default=True,
    help="Sensor time in minutes; it is played as fast as possible.",
)
@method_option
@json_option
def command(minutes: float, method: str, as_json: bool) -> None:
    """Repeat all gestures through the whole pipeline, and measure the memory."""
    from neurotouch_devtools.bench.soak import measure_soak

    result = measure_soak(method, minutes, lambda text: click.echo(text, err=True))
    if as_json:
        print_json(result)
    else:
        click.echo(
            f"{minutes:g} min at {result['realtime_factor']:.1f} times real time, "
            f"{result['rss_mb'][-1]:.1f} MB at the end, "
            f"growth {result['kb_per_hour']:+.0f} kB an hour"
        )
