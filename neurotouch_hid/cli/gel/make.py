"""``neurotouch gel make``: writes the files for a maker into a folder."""

from pathlib import Path

import click

from neurotouch_hid.cli.ui.options import gel_option
from neurotouch_hid.cli.ui.output import echo


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch gel make my-gel\n"
    "  neurotouch gel make my-gel --gel try.yaml --force\n\n"
    "Solids need: pip install 'neurotouch-hid[gel]'. Nobody has built a gel from these files yet."
)
@click.argument("out", type=click.Path(path_type=Path, file_okay=False))
@gel_option
@click.option("--force", is_flag=True, help="Write into a folder that is not empty.")
def command(out: Path, gel: str | None, force: bool) -> None:
    """Write moulds, body, stencil, wiring, parts list and instructions into the folder OUT.

    The way that gel.yaml names decides which files. The same file gives the same bytes.
    """
    from neurotouch_hid.driver.gel_file import find_gel_file, load_gel_file
    from neurotouch_hid.gel_making.folder import PAGE, make_files, write_folder
    from neurotouch_hid.gel_making.plan import make_plan

    gel_file = load_gel_file(find_gel_file(gel))
    plan = make_plan(gel_file.settings)
    files = make_files(plan, gel_file.content)
    write_folder(out, files, replace=force)
    echo(f"{len(files)} files for {gel_file.name} (way '{plan.way}') are in {out}.")
    solids = (path.name for path in out.iterdir() if path.suffix in {".stl", ".3mf"})
    if others := sorted(set(solids) - set(files)):
        echo(f"In the folder, but not of this plan: {', '.join(others)}.")
    echo(f"Begin with {out / PAGE}. Nobody has built this yet.")
