"""``neurotouch bench latency``: measures from the last event of a slice to another program."""

from typing import TYPE_CHECKING, Any

import click

from neurotouch_hid.cli.ui.options import Finite, method_option
from neurotouch_hid.cli.ui.output import json_option, print_json

if TYPE_CHECKING:
    from neurotouch_hid.driver import DeviceKind

_BAR = 40
_ROWS = (
    ("last event of a slice to the reader", "line"),
    ("our write to the reader", "device"),
)


@click.command(
    "latency",
    epilog="\b\nExamples:\n"
    "  neurotouch bench latency\n"
    "  neurotouch bench latency --device hid --json | jq .line.p99_ms",
)
@click.option(
    "--device",
    type=click.Choice(["uinput", "hid"]),
    default="uinput",
    show_default=True,
    help="Kind of pad.",
)
@click.option("--source", default="sim:random", show_default=True, help="Source.")
@click.option(
    "--seconds",
    type=Finite(min=1.0, max=600.0),
    default=20.0,
    show_default=True,
    help="Largest sensor time, in seconds.",
)
@method_option
@json_option
def command(device: "DeviceKind", source: str, seconds: float, method: str, as_json: bool) -> None:
    """Measure the time from the last event of a slice until a game has its input.

    Slices are played in real time through the whole pipeline; another process reads the pad's
    event node. The camera's own delay (USB, exposure) is not in it.
    """
    from neurotouch_devtools.bench.latency import measure_latency

    def tell(text: str) -> None:
        click.echo(f"{text} ...", err=True)

    result = measure_latency(device, method, tell, source=source, seconds=seconds)
    if as_json:
        print_json(result)
    else:
        click.echo(_format(result))


def _format(result: dict[str, Any]) -> str:
    lines = [f"{'ms':<38}{'p50':>9}{'p99':>9}{'p99.9':>9}{'max':>9}"]
    for name, key in _ROWS:
        values = [result[key][f"{which}_ms"] for which in ("p50", "p99", "p999", "max")]
        lines.append(f"{name:<38}" + "".join(f"{value:>9.3f}" for value in values))
    bins = result["line"]["histogram"]
    most = max(each["n"] for each in bins)
    for each in bins:
        edge = "longer" if each["up_to_ms"] is None else f"up to {each['up_to_ms']:g} ms"
        bar = "#" * round(_BAR * each["n"] / most)
        lines.append(f"{edge:>14} {each['n']:>7} {bar}".rstrip())
    kept = result["sensor_time_kept"]
    if kept is not None:
        lines.append(f"{kept:.0%} of the frames carry the sensor's time to the reader.")
    return "\n".join(lines)
