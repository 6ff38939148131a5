"""``neurotouch evaluate``: the paper's metrics on labelled recordings."""

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.method import choose_method

if TYPE_CHECKING:
    from neurotouch_hid.gesture import Method


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch evaluate play/*.aedat4\n"
    "  neurotouch evaluate play/*.aedat4 --method paper --json play.json"
)
@click.argument(
    "files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE..."
)
@choose_method
@click.option(
    "--json",
    "json_path",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="OUT",
    help="Write all figures to this file.",
)
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=lambda: os.cpu_count() or 1,
    show_default="all cores",
    help="Recordings to play at once.",
)
def command(files: tuple[Path, ...], method: "Method", json_path: Path | None, jobs: int) -> None:
    """Play each FILE.aedat4 and compare what is recognised with FILE.labels.csv beside it."""
    from neurotouch_hid.evaluation import evaluate_files, format_table
    from neurotouch_hid.gesture import GestureConfig

    done = 0

    def tell(path: Path) -> None:
        nonlocal done
        done += 1
        click.echo(f"{done} of {len(files)}: {path}", err=True)

    evaluation = evaluate_files(files, GestureConfig(method=method), jobs=jobs, progress=tell)
    report = evaluation.report()
    if json_path is not None:
        part = json_path.with_name(json_path.name + ".part")
        part.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
        part.replace(json_path)
    click.echo(format_table(report))
