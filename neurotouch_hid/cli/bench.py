"""``neurotouch bench``: measures the speed of this machine."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import click

from neurotouch_hid.cli.ui.group import LazyGroup
from neurotouch_hid.cli.ui.options import OutFile, method_option
from neurotouch_hid.cli.ui.output import echo, save_json

_SUMMARIES: Final = {
    "pointing": "Measure how well you point (ISO 9241-411).",
    "profile": "Measure the tremor filters, and the cost of a profile.",
    "latency": "Measure from the last event of a slice to another program.",
    "curves": "Draw latency over the rate of events, and cost over the number of markers.",
    "soak": "Watch the memory over hours of play.",
}
_PLACES: Final = {
    "pointing": ("neurotouch_hid.cli.pointing", "command"),
    "profile": ("neurotouch_devtools.cli.steadiness", "command"),
    "latency": ("neurotouch_devtools.cli.latency", "command"),
    "curves": ("neurotouch_devtools.cli.curves", "command"),
    "soak": ("neurotouch_devtools.cli.soak", "command"),
}
_ROWS: Final = (
    (
        "camera, bytes to events",
        "davis_decode_events_per_s",
        1e-6,
        "million events/s",
        (50,),
        False,
    ),
    ("view of 640x480", "view_640x480_ms", 1.0, "ms per picture", (0.6,), True),
    ("view of 1920x1200", "view_1920x1200_ms", 1.0, "ms per picture", (1.5,), True),
    ("tracker", "tracker_events_per_s", 1e-6, "million events/s", (30,), False),
    ("rest detection", "rest_ms", 1.0, "ms per frame", (0.1,), True),
    ("tracker", "tracker_ms", 1.0, "ms per slice", (), True),
    ("contacts, type, intensity", "gesture_ms", 1.0, "ms per slice", (0.3, 0.8), True),
    ("profile", "profile_ms", 1.0, "ms per slice", (), True),
    ("the whole pipeline", "advance_ms", 1.0, "ms per slice", (), True),
)
"""Name, key, factor, unit, goals of median and p99, and whether they are the most or the least."""
_LIVE: Final = (
    ("at_1_khz", "1 kHz, 1 million events/s", (), 50),
    ("at_250_hz", "250 Hz, 1 million events/s", (0.5, 1.5, 3.0), 20),
    ("at_12_million", "play, 12 million events/s", (None, 1.2), None),
    ("play", "play, slices as it moves", (), 15),
    ("idle", "250 Hz, gel at rest", (), 3),
)
"""Key of the load, name, goals of the latency's p50, p99 and p99.9, and of the processor time."""
_EVENT_MS: Final = (0.8, 1.6)
"""Goals of a dot's event in ordinary play: mean and p99."""
_BACKLOG_MS: Final = 4.0
"""A slice: a pipeline falls behind if it is later at the end than at the start by more."""
_RANKS = ("median", "p99", "p99.9")


@click.group(
    cls=LazyGroup,
    places=_PLACES,
    summaries=_SUMMARIES,
    invoke_without_command=True,
    epilog="\b\nExamples:\n"
    "  neurotouch bench\n"
    "  neurotouch bench --json bench.json\n"
    "  neurotouch bench pointing                        how well you point, see its --help\n"
    "  neurotouch bench profile                         what tremor filters do; cost of a profile\n"
    "  neurotouch bench latency                         from the last event to another program\n"
    "  neurotouch bench curves docs/pictures            draws the figures of the notebook\n"
    "  neurotouch bench soak                            memory over half an hour of play",
)
@method_option
@click.option("--json", "json_path", type=OutFile())
@click.option("--long", is_flag=True, help="Play the sustained rates for ten minutes each.")
@click.pass_context
def command(ctx: click.Context, method: str, json_path: Path | None, long: bool) -> None:
    """Measure the speed of every stage on this machine, on one core.

    The stages get slices of 10 ms at the paper's speeds; then the pipeline runs live, in sensor
    time, at the rates that --rate of run gives. A player of recorded
    events replaces the camera's driver; its own share is shown beside the total.
    """
    if ctx.invoked_subcommand is not None:
        return
    from neurotouch_hid.evaluation.speed.benchmark import run_benchmark

    result = run_benchmark(method, lambda text: echo(f"{text} ...", err=True), long=long)
    echo(_format(result))
    if json_path is not None:
        save_json(json_path, result)


def _format(result: dict[str, Any]) -> str:
    lines = [f"{'':<30}{'median':>10}{'p99':>10}{'p99.9':>10}  {'unit':<18}{'goal':>12}"]
    for name, key, factor, unit, goals, most in _ROWS:
        values = [result[key][rank] * factor for rank in _RANKS]
        lines.append(_line(name, values, unit, goals, most=most))
    start, live = result["startup_s"], result["live"]
    for name, value, unit, goal, most in (
        ("tracker against full search", result["tracker_ratio"], "times as fast", 5, False),
        ("recording, whole pipeline", result["realtime_factor"], "x real time", 10, False),
        ("evaluate, all cores", result["evaluate_factor"], "x real time", 40, False),
        ("neurotouch --help", start["help_cpu"], "s of processor", 0.15, True),
        ("import for driver:", start["reader_cpu"], "s of processor", 0.15, True),
        ("run until the pad is ready", start["pad"], "s", 1.0, True),
        ("memory", result["rss_mb"], "MB", 250, True),
    ):
        lines.append(_line(name, [value], unit, (goal,), most=most))
    lines.append(f"The scene has {result['events_per_s'] / 1e6:.2f} million events/s.")
    lines += ["", f"Live, last event to the write to the pad ({live['device']}):"]
    for key, name, latency_ms, core in _LIVE:
        run = live[key]
        values = [run["latency_ms"][rank] for rank in ("p50", "p99", "p99.9")]
        lines.append(_line(name, values, "ms", latency_ms, most=True))
        if "event_ms" in run:
            waits = [run["event_ms"][rank] for rank in ("mean", "p99", "p99.9")]
            goals = _EVENT_MS if key == "play" else ()
            lines.append(_line("  a dot's event (mean)", waits, "ms", goals, most=True))
        alone = run["machine"]
        values = [alone["latency_ms"][rank] for rank in ("p50", "p99", "p99.9")]
        lines.append(_line("  an empty pipeline", values, "ms", (), most=True))
        lines.append(_line("", [100.0 * run["core"]], "% of a core", (core,), most=True))
        lines.append(_line("  of it the player", [100.0 * alone["core"]], "%", (), most=True))
        counts = f"{run['late']} late and {run['lost']} lost of {run['slices']:,} slices"
        counts += f" (nothing to do: {alone['late']} late of {alone['slices']:,})"
        keeps_up = run["late"] == 0 if key == "at_1_khz" else not run["lost"]
        verdict = "OK" if keeps_up and run["backlog_ms"] < _BACKLOG_MS else "short"
        lines.append(f"{'':<30}{counts}, backlog {run['backlog_ms']:+.2f} ms  {verdict}")
    return "\n".join(lines)


def _line(
    name: str, values: Sequence[float], unit: str, goals: Sequence[float | None], *, most: bool
) -> str:
    """Returns a row, and whether every goal is reached."""
    shown = "".join(f"{value:>10.3f}" for value in values) + " " * 10 * (len(_RANKS) - len(values))
    aims = [(v, g) for v, g in zip(values, goals, strict=False) if g is not None]
    goal = "/".join(f"{g:g}" for _, g in aims)
    reached = all(v <= g if most else v >= g for v, g in aims)
    verdict = ("  OK" if reached else "  short") if aims else ""
    return f"{name:<30}{shown}  {unit:<18}{goal:>12}{verdict}".rstrip()
