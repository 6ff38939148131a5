"""Writes a report, complete or not at all."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path

from neurotouch_hid.evaluation.accuracy.files import Evaluation, combine_reports
from neurotouch_hid.evaluation.accuracy.origin import Origin
from neurotouch_hid.evaluation.accuracy.report.folder import FIGURES, NUMBERS, PAGE, fill_folder
from neurotouch_hid.evaluation.accuracy.report.page import build_page
from neurotouch_hid.evaluation.accuracy.report.pictures import draw_pictures


def write_report(
    folder: Path,
    evaluations: Mapping[str, Evaluation],
    origin: Origin,
    progress: Callable[[str], None] = lambda _: None,
) -> None:
    """Writes ``report.html``, ``report.json`` and ``figures/*.svg``.

    Args:
        folder: created; an empty one or an older report is replaced.
        evaluations: by method, of the same recordings; at least one.
        origin: origin of the figures.
        progress: called with a sentence at each step.

    Raises:
        NeuroTouchError: the folder cannot be written, or it contains other files.
    """
    reports = {method: evaluation.report() for method, evaluation in evaluations.items()}
    with fill_folder(folder) as new:
        pictures = list(draw_pictures(evaluations, reports, progress))
        for picture in pictures:
            (new / FIGURES / f"{picture.name}.svg").write_text(picture.svg, encoding="utf-8")
        numbers = json.dumps(combine_reports(reports, origin), indent=2) + "\n"
        (new / NUMBERS).write_text(numbers, encoding="utf-8")
        page = build_page(reports, pictures, origin)
        # A file may have a name that is no UTF-8.
        (new / PAGE).write_text(page, encoding="utf-8", errors="replace")
