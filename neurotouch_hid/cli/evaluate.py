"""``neurotouch evaluate``: measures the paper's metrics on labelled recordings."""

import os
import shlex
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import click

from neurotouch_hid.cli.ui.options import MethodName, OutFile, gel_option, rate_option
from neurotouch_hid.cli.ui.output import echo, save_json


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch evaluate play/*.aedat4\n"
    "  neurotouch evaluate play/*.aedat4 --method paper --json play.json\n"
    "  neurotouch evaluate play/*.aedat4 --method neurotouch --method paper --report play-report"
)
@click.argument(
    "files",
    nargs=-1,
    required=True,
    type=click.Path(path_type=Path, readable=False),
    metavar="FILE...",
)
@click.option(
    "--method",
    "methods",
    type=MethodName(),
    default=("neurotouch",),
    multiple=True,
    show_default=True,
    help="Method of recognition; give it several times to compare methods.",
)
@click.option(
    "--json",
    "json_path",
    type=OutFile(),
    metavar="OUT",
    help="Write all figures to this file; of several methods, the first at the top and each "
    "under methods.NAME.",
)
@click.option(
    "--report",
    "report_path",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Write a page with all figures, the paper's beside them, and the worst moments.",
)
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=lambda: os.cpu_count() or 1,
    show_default="all cores",
    help="Recordings to play at once.",
)
@rate_option
@gel_option
def command(
    files: tuple[Path, ...],
    methods: tuple[str, ...],
    rate_hz: float | None,
    gel: str | None,
    json_path: Path | None,
    report_path: Path | None,
    jobs: int,
) -> None:
    """Play each FILE and compare the recognised gestures with its labels, FILE.labels.csv.

    A FILE is a recording, NAME.aedat4, or a video clip, NAME.avi, NAME.mkv or NAME.mp4.
    """
    from neurotouch_hid.recording import check_labelled

    files = tuple(dict.fromkeys(files))  # one that two patterns name counts once
    check_labelled(files)
    from neurotouch_hid.driver import REFERENCE
    from neurotouch_hid.evaluation.accuracy import (
        Evaluation,
        combine_reports,
        evaluate_files,
        format_table,
        trace_origin,
    )

    if report_path is not None:
        from neurotouch_hid.evaluation.accuracy.report import check_folder, write_report

        check_folder(report_path)
    methods = tuple(dict.fromkeys(methods))
    echo("Playing ...", err=True)
    evaluations = dict[str, Evaluation]()
    done = 0

    def tell(path: Path) -> None:
        nonlocal done
        done += 1
        echo(f"{done} of {len(files) * len(methods)}: {path}", err=True)

    for method in methods:
        if len(methods) > 1:
            echo(f"Method {method}", err=True)
        options = replace(REFERENCE, method=method, rate_hz=rate_hz, gel=gel)
        evaluations[method] = evaluate_files(
            files, options, jobs=jobs, progress=tell, announce=partial(echo, err=True)
        )
    reports = {method: evaluation.report() for method, evaluation in evaluations.items()}
    origin = trace_origin(files, shlex.join(["neurotouch", *sys.argv[1:]]))
    if json_path is not None:
        save_json(json_path, combine_reports(reports, origin))
    if report_path is not None:
        write_report(report_path, evaluations, origin, lambda doing: echo(doing, err=True))
    echo(f"{origin} {origin.program}, {origin.date}.")
    for name, report in reports.items():
        if len(reports) > 1:
            echo(f"\nmethod {name}")
        echo(format_table(report))
    if report_path is not None:
        echo(f"\nThe report is in {report_path / 'report.html'}.")
