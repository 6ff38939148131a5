"""``neurotouch status``: what the running driver does."""

import json
import time
from typing import Any

import click

_STATES = {
    "running": "OK: running",
    "paused": "WARNING: paused. Go on with: neurotouch resume",
    "panic": "WARNING: stopped by panic. Go on with: neurotouch resume",
}
_FACTS = {
    "pid": "process",
    "source": "source",
    "device": "pad",
    "profile": "profile",
    "layer": "layer",
    "gel": "gel",
    "gesture": "gesture",
    "copilot": "co-pilot",
    "keyboard": "keyboard",
    "mouse": "mouse",
    "desktop": "applications",
    "sound": "sound",
}


@click.command(epilog="\b\nExamples:\n  neurotouch status\n  neurotouch status --json | jq .state")
@click.option("--json", "as_json", is_flag=True, help="Print everything as one JSON object.")
def command(as_json: bool) -> None:
    """Say what the running driver does, one fact on each line.

    Exit code 0 if a driver runs, 8 if none does.
    """
    from neurotouch_hid.client import ask

    status = ask("status")
    if as_json:
        click.echo(json.dumps(status, indent=2))
    else:
        click.echo("\n".join(_list_facts(status)))


def _list_facts(status: dict[str, Any]) -> list[str]:
    lines = [_STATES.get(status["state"], status["state"])]
    if status["silent_s"]:
        lines.append(f"WARNING: nothing has come from the source for {status['silent_s']:.1f} s")
    lines += [f"{label}: {status[key]}" for key, label in _FACTS.items() if key in status]
    lines += [
        f"markers: {status['markers_tracked']} of 177 tracked",
        f"events: {status['events_hz']:,} per second, {status['events_lost']:,} lost",
        f"slices: {status['slices_hz']:g} per second",
    ]
    lines += [f"time in {name}: {ms:.3f} ms a slice" for name, ms in status["stage_ms"].items()]
    lines += [
        f"since the start, {name}: p50 {spread['p50']:.3f}, p99 {spread['p99']:.3f}, "
        f"p99.9 {spread['p99.9']:.3f} ms"
        for name, spread in status["stage_spread_ms"].items()
    ]
    lines += [_describe_fatigue(**fading) for fading in status["fatigue"]]
    lines += [
        f"long holds: {movement.replace('_', ' ')}, {times} of more than 5 s. 'mode: toggle' in "
        "the profile holds for you"
        for movement, times in status["long_holds"].items()
    ]
    for error in status["errors"]:
        at = time.strftime("%H:%M:%S", time.localtime(error["at"]))
        lines.append(f"error at {at}: {error['error']}")
    return lines


def _describe_fatigue(movement: str, peak_mm: float, full_mm: float | None, needs: float) -> str:
    words = movement.replace("_", " ")
    if needs < 1.0:
        return f"fatigue: {words} needs {needs:.0%} of its range until the next pause"
    return (
        f"fatigue: {words} has faded to {peak_mm:g} mm. A pause helps, or in user.yaml "
        f"'range.{movement}.full: {full_mm:g}' or 'fatigue: auto'"
    )
