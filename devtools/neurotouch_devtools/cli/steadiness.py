"""``neurotouch bench profile``: measures the tremor filters, and the cost of a profile."""

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from neurotouch_hid.cli.ui.output import json_option, print_json

if TYPE_CHECKING:
    from neurotouch_devtools.bench.steadiness import Steadiness


@click.command(
    name="profile",
    epilog="\b\nExamples:\n"
    "  neurotouch bench profile\n"
    "  neurotouch bench profile --json | jq .filters.medium",
)
@json_option
def command(as_json: bool) -> None:
    """Measure the remaining tremor and the delay of each filter, and the cost of a profile.

    Beside each figure, in brackets, is the value the filter was designed for. The signals are
    made by a program: they say nothing about a person.
    """
    from neurotouch_devtools.bench.steadiness import (
        DESIGN,
        GOAL_MS,
        measure_engine,
        measure_filter,
    )

    measured = {name: measure_filter(name) for name in DESIGN}
    cost = measure_engine()
    if as_json:
        filters: dict[str, Any] = {
            name: {"measured": asdict(measured[name]), "design": asdict(DESIGN[name])}
            for name in DESIGN
        }
        print_json({"filters": filters, "engine_ms": {**cost, "goal": GOAL_MS}})
        return
    for name, design in DESIGN.items():
        click.echo(_describe(name, measured[name], design))
    click.echo(
        f"a slice with {cost['bindings']:.0f} bindings costs {cost['median']:.3f} ms, "
        f"p99 {cost['p99']:.3f} ms (goal {GOAL_MS:g} ms)"
    )


def _describe(name: str, measured: "Steadiness", design: "Steadiness") -> str:
    left = ", ".join(
        f"{percent:.0f} ({design.left[hz]:.0f}) % at {hz} Hz"
        for hz, percent in measured.left.items()
    )
    return (
        f"{name} leaves of a tremor {left}; delays a press by {measured.press_ms:.0f} "
        f"({design.press_ms:.0f}) ms, a release by {measured.release_ms:.0f} "
        f"({design.release_ms:.0f}) ms, a slow ramp by {measured.ramp_ms:.0f} "
        f"({design.ramp_ms:.0f}) ms"
    )
