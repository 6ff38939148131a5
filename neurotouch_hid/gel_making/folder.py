"""Writes the folder with all that a maker needs."""

from pathlib import Path
from typing import Final

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.gel_making.drawings import draw_cut, draw_dots, draw_wiring
from neurotouch_hid.gel_making.mesh_files import write_3mf, write_stl
from neurotouch_hid.gel_making.page import write_page
from neurotouch_hid.gel_making.parts import Part, make_parts, measure_silicone
from neurotouch_hid.gel_making.plan import Plan
from neurotouch_hid.gel_making.shopping import list_needs, write_csv
from neurotouch_hid.gel_making.stencil import draw_stencil
from neurotouch_hid.partial_file import write_whole

PAGE: Final = "README.html"
_COLOURS: Final = {"dome-dark": "#202020", "dome-light": "#F8F8F8"}


def make_files(plan: Plan, gel_file: bytes) -> dict[str, bytes]:
    """Returns the content of each file, by its name; the same plan gives the same bytes.

    Args:
        plan: the measures.
        gel_file: content of ``gel.yaml``.

    Raises:
        NeuroTouchError: the library for solids is missing.
    """
    parts = make_parts(plan)
    needs = list_needs(plan, measure_silicone(plan) if plan.way == "cast" else 0.0)
    stencil = draw_stencil(plan)
    files = {
        PAGE: write_page(plan, parts, needs).encode(),
        "gel.yaml": gel_file,
        "parts.csv": write_csv(needs).encode(),
        "cut.svg": draw_cut(plan).write_svg().encode(),
        "picture.svg": draw_dots(plan).write_svg().encode(),
        "stencil.svg": stencil.write_svg().encode(),
        "stencil.pdf": stencil.write_pdf(),
    }
    if parts:
        files["wiring.svg"] = draw_wiring().write_svg().encode()
    files |= {f"{part.file}.stl": write_stl(part.solid) for part in parts}
    if dome := {part.file: (part.solid, _COLOURS[part.file]) for part in _find_dome(parts)}:
        files["dome.3mf"] = write_3mf(dome)
    return files


def write_folder(out: Path, files: dict[str, bytes], *, replace: bool = False) -> None:
    """Writes files into a folder, which is made.

    Args:
        out: the folder.
        files: content by name.
        replace: also into a folder that is not empty; other files in it stay.

    Raises:
        NeuroTouchError: it cannot be written, or is not empty.
    """
    try:
        if out.is_dir() and any(out.iterdir()) and not replace:
            raise NeuroTouchError(
                f"The folder '{out}' is not empty.",
                hint="Choose another folder, or add --force to replace the files of a gel in it.",
            )
        out.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            write_whole(out / name, content)
    except OSError as error:
        raise NeuroTouchError.of_writing(out, error) from error


def _find_dome(parts: list[Part]) -> list[Part]:
    return [part for part in parts if part.file in _COLOURS]
