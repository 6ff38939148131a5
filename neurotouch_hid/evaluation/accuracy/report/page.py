"""Builds the page of a report: one file without scripts, other files or network."""

import base64
from collections.abc import Callable, Mapping, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

from neurotouch_hid.evaluation.accuracy.origin import Origin
from neurotouch_hid.evaluation.accuracy.report import tables
from neurotouch_hid.evaluation.accuracy.report.bars import Reports
from neurotouch_hid.evaluation.accuracy.report.pictures import ReportPicture

_SECTIONS = (
    ("table", "The paper’s table"),
    ("types", "Types and contact counts"),
    ("intensity", "Accuracy over intensity"),
    ("errors", "Contact distance and intensity error"),
    ("confusion", "Confusion matrix"),
    ("timing", "Time, changes of type and rest"),
    ("confidence", "Confidence"),
    ("labels", "The labels"),
    ("failures", "The worst moments"),
    ("recordings", "Each recording"),
)


def build_page(reports: Reports, pictures: Sequence[ReportPicture], origin: Origin) -> str:
    """Returns the whole page.

    Args:
        reports: figures by method.
        pictures: all figures in order; the first word of a name is its section.
        origin: origin of the figures.
    """
    contents = "".join(f'<li><a href="#{key}">{title}</a></li>' for key, title in _SECTIONS)
    sections = "".join(
        f'<section id="{key}" aria-labelledby="{key}-title">\n<h2 id="{key}-title">{title}</h2>\n'
        f"{_build_section(key, reports, pictures)}</section>\n"
        for key, title in _SECTIONS
    )
    template = Template(files(__package__).joinpath("page.html").read_text(encoding="utf-8"))
    return template.substitute(
        program=escape(origin.program),
        command=f" by <code>{escape(origin.command)}</code>" if origin.command else "",
        date=escape(origin.date),
        introduction=f"<strong>{escape(str(origin))}</strong> {_introduce(reports)}",
        contents=contents,
        sections=sections,
    )


def _introduce(reports: Reports) -> str:
    first = next(iter(reports.values()))
    methods = " and ".join(f"<strong>{escape(name)}</strong>" for name in reports)
    n_files = len(first["files"])
    slices, frames, events = (
        f"{first[key]:,}".replace(",", "\u202f") for key in ("observations", "frames", "events")
    )
    return (
        f"{n_files} recording{'s' if n_files > 1 else ''}, {slices} slices of 10 ms compared with "
        f"labels, {frames} frames, {events} events; {'method' if len(reports) == 1 else 'methods'} "
        f"{methods}."
    )


def _build_section(key: str, reports: Reports, pictures: Sequence[ReportPicture]) -> str:
    shown = [picture for picture in pictures if picture.name.split("-")[0] == key]
    if key == "failures":
        return _build_gallery(list(reports), shown)
    drawn = "".join(_build_picture(picture) for picture in shown)
    if key == "table":
        return tables.build_summary(reports) + drawn
    if key == "timing":
        return _EXPLAIN_TIMING + tables.build_beyond(reports) + drawn
    if key == "recordings":
        return tables.build_files(reports)
    return drawn + _build_numbers(_NUMBERS.get(key), reports)


_NUMBERS: Mapping[str, Callable[[Mapping[str, Any]], str]] = {
    "types": tables.build_types,
    "intensity": tables.build_intensity,
    "errors": tables.build_errors,
    "confusion": tables.build_confusion,
    "confidence": tables.build_reliability,
}
_EXPLAIN_TIMING = """<p>Time: from the moment the labelled intensity reaches 2.5 mm to the first
slice with the labelled type; a gesture that never gets that type counts as infinitely late. A
gesture changes type if another one is recognised after that, or none while the labelled intensity
is still 2.5 mm or more. At rest: no gesture is labelled within half a second.</p>
"""


def _build_numbers(build: Callable[[Mapping[str, Any]], str] | None, reports: Reports) -> str:
    if build is None:
        return ""
    return "".join(
        f"<details><summary>The numbers of method {escape(name)}</summary>\n{build(report)}"
        "</details>\n"
        for name, report in reports.items()
    )


def _build_gallery(methods: Sequence[str], pictures: Sequence[ReportPicture]) -> str:
    parts = [
        "<p>The worst moment of each labelled gesture and each rest, and of those the worst ten. "
        "Rings are labelled contacts, crosses recognised ones; arrows lead from where a marker "
        "rests to where it is; hollow markers are guessed from their neighbours. Severity: the "
        "error of the intensity, plus the larger of both intensities times the sum of 1 for a "
        "wrong type, the share of contacts too many or too few, and the mean contact distance over "
        "a fingertip’s radius of 12 mm, at most 1.</p>\n"
    ]
    for method in methods:
        shown = [p for p in pictures if p.name.rpartition("-")[0] == f"failures-{method}"]
        drawn = "".join(_build_picture(picture) for picture in shown) or "<p>Nothing is wrong.</p>"
        parts.append(f'<h3>Method {escape(method)}</h3>\n<div class="gallery">{drawn}</div>\n')
    return "".join(parts)


def _build_picture(picture: ReportPicture) -> str:
    data = base64.b64encode(picture.svg.encode()).decode()
    return (
        f'<figure><div class="wide"><img id="{escape(picture.name)}" alt="{escape(picture.alt)}" '
        f'src="data:image/svg+xml;base64,{data}"></div>\n'
        f"<figcaption>{escape(picture.caption)}</figcaption></figure>\n"
    )
