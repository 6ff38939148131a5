"""``neurotouch status``: prints the state of the running driver."""

import time
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.output import echo, json_option, print_json

if TYPE_CHECKING:
    from neurotouch_hid.status import Fatigue, GelFacts, Status

_STATES = {
    "running": "OK: running",
    "paused": "WARNING: paused. To continue: neurotouch resume",
    "panic": "WARNING: stopped by panic. To continue: neurotouch resume",
}
_FIRST = {"profile": "profile", "layer": "layer"}
_FACTS = {
    "gesture": "gesture",
    "settings": "settings",
    "copilot": "co-pilot",
    "keyboard": "keyboard",
    "mouse": "mouse",
    "desktop": "applications",
    "sound": "sound",
}


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch status\n"
    "  neurotouch status --verbose      the times of each stage too\n"
    "  neurotouch status --json | jq .state"
)
@click.option("--verbose", is_flag=True, help="Add the process, rates and the times of each stage.")
@json_option
def command(verbose: bool, as_json: bool) -> None:
    """Print the state of the running driver, one fact on each line.

    Exit code 0 if a driver runs, 8 if none does.
    """
    from neurotouch_hid.client import ask_status

    status = ask_status()
    if as_json:
        print_json(status)
        return
    echo("\n".join(_list_facts(status)))
    if verbose:
        echo("\n".join(_list_times(status)))


def _list_facts(status: "Status") -> list[str]:
    """Returns the facts for a person, the most important first."""
    lines = [_STATES.get(status["state"], status["state"])]
    if status["silent_s"]:
        lines.append(f"WARNING: no data from the source for {status['silent_s']:.1f} s")
    for error in status["errors"]:
        at = time.strftime("%H:%M:%S", time.localtime(error["at"]))
        lines.append(f"error at {at}: {error['error']}")
    gel = status["gel"]
    if not gel["found"]:
        lines.append(f"WARNING: the gel is {gel['text']}")
        lines += [f"Fix: {gel['fix']}"] if gel["fix"] else []
    lines += _name_facts(status, _FIRST)
    lines.append(f"source: {'SIMULATED ' if status['simulated'] else ''}{status['source']}")
    lines.append(f"pad: {status['device']}")
    lines += _describe_gel(gel, status["markers_tracked"])
    lines += _name_facts(status, _FACTS)
    if status["events_lost"]:
        lines.append(f"events lost: {status['events_lost']:,}")
    lines += [_describe_fatigue(fading) for fading in status["fatigue"]]
    lines += [
        f"long holds: {movement.replace('_', ' ')}, {times} of more than 5 s. With 'mode: toggle' "
        "in the profile, the press stays on without holding"
        for movement, times in status["long_holds"].items()
    ]
    if status.get("ignored"):
        lines.append(f"last {status['ignored']}")
    return lines


def _describe_gel(gel: "GelFacts", n_tracked: int) -> list[str]:
    """Returns what the camera sees of the gel."""
    if not gel["found"]:
        return ["gel: not found, so the pad is neutral"]
    lines = [f"gel: {gel['text']}, {n_tracked} of {gel['markers']} markers tracked"]
    if gel["fix"]:
        lines.append(f"Fix: {gel['fix']}")
    if gel["missing"]:
        lines.append(f"dots not seen: {len(gel['missing'])}, {gel['named']}")
    return lines


def _name_facts(status: "Status", labels: dict[str, str]) -> list[str]:
    found = ((label, status.get(key)) for key, label in labels.items())
    return [f"{label}: {value}" for label, value in found if value is not None]


def _list_times(status: "Status") -> list[str]:
    """Returns the facts for a bug report."""
    lines = [
        f"process: {status['pid']}, for {status['uptime_s']:.0f} s",
        f"events: {status['events_hz']:,} per second, {status['events_lost']:,} lost",
        f"slices: {status['slices_hz']:g} per second",
        _describe_picture(status["gel"]),
    ]
    lines += [f"time in {name}: {ms:.3f} ms a slice" for name, ms in status["stage_ms"].items()]
    lines += [
        f"since the start, {name}: p50 {spread['p50']:.3f}, p99 {spread['p99']:.3f}, "
        f"p99.9 {spread['p99.9']:.3f} ms"
        for name, spread in status["stage_spread_ms"].items()
    ]
    return lines


def _describe_picture(gel: "GelFacts") -> str:
    figures = {
        "scale {:.2f} px/mm": gel["px_per_mm"],
        "dots blurred by {:.1f} px": gel["blur_px"],
        "pattern bent by {:.1f} px": gel["bend_px"],
        "flicker {:.0f} Hz": gel["flicker_hz"],
        "moved by {:.1f} mm": gel["moved_mm"],
        "reflections {}": gel["glints"],
    }
    known = [words.format(value) for words, value in figures.items() if value is not None]
    return f"picture: {', '.join(known)}"


def _describe_fatigue(fading: "Fatigue") -> str:
    movement = fading["movement"]
    words = movement.replace("_", " ")
    if fading["needs"] < 1.0:
        return f"fatigue: {words} needs {fading['needs']:.0%} of its range until the next pause"
    return (
        f"fatigue: {words} has faded to {fading['peak_mm']:g} mm. A pause helps, or in user.yaml "
        f"'range.{movement}.full: {fading['full_mm']:g}' or 'fatigue: auto'"
    )
