"""Writes the one file of a first meeting: recording, prompts, figures and answers."""

import csv
import io
import json
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

from neurotouch_hid import __version__
from neurotouch_hid.doctor.bug_report import list_rules, make_cleaner
from neurotouch_hid.doctor.finding import Finding
from neurotouch_hid.doctor.hello.answers import answer_all, compare
from neurotouch_hid.doctor.hello.rig_fitting import fit_rig_settings
from neurotouch_hid.doctor.hello.rig_settings import FILE, GEL_FILE, CameraKind
from neurotouch_hid.doctor.hello.session import Session, Span
from neurotouch_hid.driver.gel_file import GelFile
from neurotouch_hid.partial_file import PartialFile
from neurotouch_hid.vocabulary import SourceKind

ENDING: Final = ".hello.zip"
LEFT_OUT: Final = (
    "your user name, real name, home folder and the name of this machine",
    "serial numbers of cameras, network and Bluetooth addresses",
    "where the camera is plugged in, and the names of files and folders",
    "your profiles, your calibration and your settings",
    "date and time",
)
_VERSION: Final = 1
_COLUMNS: Final = ("begin_us", "end_us", "prompt", "gesture", "skipped")


def make_report(
    session: Session,
    kind: SourceKind,
    camera: dict[str, Any],
    *,
    is_simulated: bool,
    secrets: Iterable[str] = (),
    stream: Finding | None = None,
) -> dict[str, Any]:
    """Returns all that is known of a rig, ready for JSON and for publication.

    Args:
        session: what was measured.
        kind: the kind of the source.
        camera: what the camera says of itself.
        is_simulated: nothing of it comes from a sensor.
        secrets: serial numbers.
        stream: what the doctor says of the data that came; None if it says nothing.
    """
    figures = session.list_figures()
    answers = answer_all(session, kind, camera, is_simulated=is_simulated, stream=stream)
    report = {
        "version": _VERSION,
        "program": f"neurotouch-hid {__version__}",
        "simulated": is_simulated,
        "source": str(kind),
        "camera": camera,
        "gel": session.gel.layout.name,
        "light": None if session.score is None else session.score.as_json(),
        "prompts": [span.as_json() for span in session.spans],
        "figures": figures,
        "answers": [asdict(each) for each in answers],
        "differences": [asdict(each) for each in compare(figures)],
    }
    cleaned: dict[str, Any] = make_cleaner(list_rules(secrets))(report)
    return {**cleaned, "left_out": list(LEFT_OUT)}


def make_settings(
    session: Session,
    gel: GelFile | None,
    camera: Mapping[str, Any] | None = None,
    *,
    is_simulated: bool,
) -> dict[str, str]:
    """Returns the texts with which the simulator makes more like this rig, by their names.

    Args:
        session: what was measured.
        gel: the gel's file; None for the gel of the paper.
        camera: what the camera says of itself.
        is_simulated: the rig was a simulation.

    Returns:
        The settings, and the gel without its comments and without the part about making it. Empty
        if nothing was measured.
    """
    seen, figures = session.gel, session.list_figures()
    if camera and camera.get("exposure_us", 0) is None:  # the driver has then assumed one
        figures["exposure_us"] = None
    settings = fit_rig_settings(
        figures,
        seen.layout,
        seen.missing,
        camera=_name_camera(session),
        is_simulated=is_simulated,
    )
    if settings is None:
        return {}
    texts = {FILE: settings.format()}
    if gel is not None:
        plain = gel.settings.model_dump(mode="json", exclude_unset=True, exclude={"making"})
        texts[GEL_FILE] = f"{json.dumps(plain, indent=1)}\n"
    return texts


def _name_camera(session: Session) -> CameraKind:
    """Returns what kind of camera the simulator must show."""
    if not session.has_events:
        return "pictures"
    return "events" if session.has_frames else "events-only"


def format_prompts(spans: Iterable[Span]) -> str:
    """Returns the weak labels as CSV: a row for each prompt, with its sensor time in µs."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for span in spans:
        asked = "" if span.prompt.kind is None else span.prompt.kind.label
        writer.writerow((span.begin_us, span.end_us, span.prompt.key, asked, int(span.is_skipped)))
    return text.getvalue()


def write_archive(
    path: Path,
    report: dict[str, Any],
    spans: Iterable[Span],
    recording: Path,
    settings: Mapping[str, str] | None = None,
) -> None:
    """Writes the file, whole or not at all.

    Args:
        path: where it will be; an existing one is replaced.
        report: the report.
        spans: what the person was asked for.
        recording: the recording; it keeps only its ending.
        settings: the texts with which the simulator makes more like it, by their names.

    Raises:
        OSError: it cannot be written.
    """
    with PartialFile(path) as partial, zipfile.ZipFile(_Whole(partial.file), "w") as archive:
        text = json.dumps(report, indent=2, allow_nan=False, default=float) + "\n"
        _add(archive, "hello.json", text)
        _add(archive, "prompts.csv", format_prompts(spans))
        for name, content in (settings or {}).items():
            _add(archive, name, content)
        # ZipInfo without a time: that of the file would tell when this was.
        info = zipfile.ZipInfo(f"recording{recording.suffix}")
        info.file_size = recording.stat().st_size
        with recording.open("rb") as source, archive.open(info, "w") as target:
            while block := source.read(1 << 20):
                target.write(block)


class _Whole:
    """Writes all of each block: an unbuffered file may take a part of it only."""

    def __init__(self, file: io.FileIO) -> None:
        self._file = file

    def write(self, block: bytes, /) -> int:
        """Writes a block; returns its length."""
        rest = memoryview(block)
        length = len(rest)
        while rest:
            rest = rest[self._file.write(rest) :]
        return length

    def flush(self) -> None:
        """Does nothing: nothing waits."""

    def close(self) -> None:
        """Does nothing: the partial file closes it."""


def _add(archive: zipfile.ZipFile, name: str, text: str) -> None:
    archive.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
