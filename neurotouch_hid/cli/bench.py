"""``neurotouch bench``: how fast this machine is."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neurotouch_hid.cli import pointing
from neurotouch_hid.cli.method import choose_method

if TYPE_CHECKING:
    from neurotouch_hid.gesture import Method

_ROWS = (
    ("tracker", "tracker_events_per_s", 1e-6, "million events/s", "20"),
    ("contacts, type, intensity", "gesture_ms", 1.0, "ms per slice", "1"),
    ("rest detection", "rest_ms", 1.0, "ms per frame", "0.2"),
    ("the whole line", "advance_ms", 1.0, "ms per slice", ""),
)


@click.group(
    invoke_without_command=True,
    epilog="\b\nExamples:\n"
    "  neurotouch bench\n"
    "  neurotouch bench --json bench.json\n"
    "  neurotouch bench pointing                        how well you point, see its --help",
)
@choose_method
@click.option("--json", "json_path", type=click.Path(path_type=Path, dir_okay=False))
@click.pass_context
def command(ctx: click.Context, method: "Method", json_path: Path | None) -> None:
    """Measure the speed of every stage on this machine, on one core.

    Slices are 10 ms of sensor time at the paper's speeds.
    """
    if ctx.invoked_subcommand is not None:
        return
    from neurotouch_hid.evaluation.benchmark import run_benchmark

    result = run_benchmark(method, lambda text: click.echo(f"{text} ...", err=True))
    click.echo(_format(result))
    if json_path is not None:
        json_path.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


def _format(result: dict[str, Any]) -> str:
    lines = [f"{'':<28}{'median':>10}{'p99':>10}  {'unit':<18}{'goal':>6}"]
    for name, key, factor, unit, goal in _ROWS:
        median, p99 = (result[key][which] * factor for which in ("median", "p99"))
        lines.append(f"{name:<28}{median:>10.3f}{p99:>10.3f}  {unit:<18}{goal:>6}")
    start = result["startup_s"]
    for name, value, unit, goal in (
        ("recording, whole line", result["realtime_factor"], "x real time", "10"),
        ("neurotouch --help", start["help_cpu"], "s of processor", "0.15"),
        ("run until the pad is there", start["pad"], "s", "1.5"),
        ("memory", result["rss_mb"], "MB", "300"),
    ):
        lines.append(f"{name:<28}{value:>10.3f}{'':>10}  {unit:<18}{goal:>6}")
    lines.append(f"The scene has {result['events_per_s'] / 1e6:.2f} million events/s.")
    return "\n".join(lines)


command.add_command(pointing.command)
