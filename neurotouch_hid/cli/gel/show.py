"""``neurotouch gel show``: draws the gel and its camera, with all measures."""

from pathlib import Path

import click
import numpy as np

from neurotouch_hid.cli.ui.options import OutFile, complete_gel
from neurotouch_hid.cli.ui.output import echo, json_option, plain_option, print_json, save_text
from neurotouch_hid.errors import NeuroTouchError

_COLUMNS, _ROWS = 61, 31


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch gel show\n"
    "  neurotouch gel show paper\n"
    "  neurotouch gel show my.yaml --svg gel.svg\n"
    "  neurotouch gel show --json"
)
@click.argument("file", required=False, metavar="[FILE or NAME]", shell_complete=complete_gel)
@click.option("--svg", type=OutFile(), help="Draw gel, camera and field of view into this file.")
@plain_option
@json_option
def command(file: str | None, svg: Path | None, plain: bool, as_json: bool) -> None:
    """Draw the gel with its camera; without FILE, yours, or the paper's if you have none."""
    from neurotouch_hid.driver.gel_file import find_gel_file, load_gel_file
    from neurotouch_hid.gel_making.drawings import draw_cut
    from neurotouch_hid.gel_making.plan import make_plan

    gel_file = load_gel_file(find_gel_file(file))
    plan = make_plan(gel_file.settings, is_made=True)
    fault = None
    try:
        make_plan(gel_file.settings)
    except NeuroTouchError as error:
        fault = error
    if svg is not None:
        save_text(svg, draw_cut(plan).write_svg())
    gel, camera = plan.gel, plan.camera
    facts: dict[str, object] = {
        "file": gel_file.name,
        "name": gel.name,
        "way": plan.way,
        "dots": gel.n_markers,
        "dot_mm": gel.dot_mm,
        "pitch_mm": round(gel.pitch_mm, 3),
        "radius_mm": plan.radius,
        "height_mm": plan.height,
        "camera": camera.name,
        "picture_px": [camera.width_px, camera.height_px],
        "view_deg": camera.view_deg,
        "distance_mm": round(plan.distance, 1),
        "px_per_mm": round(plan.px_per_mm, 2),
        "fill": round(plan.measure_fill(), 3),
        "body_mm": round(-plan.bottom_z, 1),
        "reflections_mm": plan.find_reflections(),
        "cannot_be_made": fault and fault.message,
    }
    if as_json:
        print_json(facts)
        return
    if not plain:
        echo(_draw(plan.gel.points_mm / plan.radius))
    echo(f"{gel_file.name}: gel '{gel.name}', way '{plan.way}'")
    echo(
        f"{gel.n_markers} dots of {gel.dot_mm:g} mm, {gel.pitch_mm:.3g} mm apart, on a gel "
        f"{2 * plan.radius:.4g} mm wide and {plan.height:g} mm high."
    )
    echo(
        f"Camera '{camera.name}': {camera.width_px} x {camera.height_px} px, "
        f"{camera.view_deg:g}° from top to bottom."
    )
    echo(f"From the rim to the lens: {plan.distance:.0f} mm. Scale: {plan.px_per_mm:.1f} px/mm.")
    echo(f"The gel fills {100 * plan.measure_fill():.0f} % of the picture's height.")
    if places := ", ".join(f"{each:g}" for each in plan.find_reflections()):
        echo(f"A shiny skin would mirror the LEDs {places} mm from the middle: make it dull.")
    if fault is not None:
        echo(f"WARNING: This gel cannot be made. {fault.message}")
        echo(f"Fix: {fault.hint}")
    if svg is not None:
        echo(f"The drawing is {svg}.")


def _draw(points: "np.ndarray[tuple[int, int], np.dtype[np.float64]]") -> str:
    """Returns the dots as text; points are (n, 2), 1 is the rim."""
    lines = [[" "] * _COLUMNS for _ in range(_ROWS)]

    def put(x: float, y: float, letter: str) -> None:
        column, row = round(0.5 * (_COLUMNS - 1) * (1 + x)), round(0.5 * (_ROWS - 1) * (1 + y))
        lines[row][column] = letter

    for angle in np.linspace(0.0, 2.0 * np.pi, 160):
        put(float(np.cos(angle)), float(np.sin(angle)), ".")
    for x, y in points.tolist():
        put(x, y, "o")
    return "\n".join("".join(line).rstrip() for line in lines)
