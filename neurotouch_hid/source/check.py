"""Refuses a source that cannot be opened, before any library to play it is loaded."""

import difflib
from pathlib import Path
from typing import Final

from neurotouch_hid.errors import SourceError
from neurotouch_hid.plugins import SOURCES, list_plugins
from neurotouch_hid.source.davis.enumeration import choose_camera, find_cameras
from neurotouch_hid.vocabulary import (
    RECORDING_ENDINGS,
    RUNNING_DRIVER,
    SourceKind,
    find_source_kind,
)

FORMS: Final = (
    *("davis:", "davis:SERIAL", "video:", "video:NAME", "events:", "events:SERIAL"),
    *("file:NAME.aedat4", "file:NAME.mkv", "sim:NAME", RUNNING_DRIVER),
)
"""How the sources of this package are written."""


def check_source(spec: str) -> None:
    """Checks a source as far as possible without opening it, and without numpy if it is none.

    Args:
        spec: the source as a person writes it.

    Raises:
        SourceError: there is no such source, or no such camera is plugged in.
        RecordingError: the file is missing, or is no recording.
    """
    kind, rest = find_source_kind(spec), spec.partition(":")[2]
    if kind is SourceKind.SIMULATION:
        from neurotouch_hid.source.simulator.scenes import read_simulation  # noqa: PLC0415

        read_simulation(rest)
    elif kind is SourceKind.CAMERA:
        choose_camera(find_cameras(), rest)
    elif kind is SourceKind.VIDEO:
        from neurotouch_hid.source.video.enumeration import (  # noqa: PLC0415
            find_video_cameras,
            select_video_cameras,
        )

        select_video_cameras(find_video_cameras(), rest)
    elif kind is SourceKind.EVENTS:
        from neurotouch_hid.source.events.enumeration import (  # noqa: PLC0415
            choose_event_camera,
            find_event_cameras,
        )
        from neurotouch_hid.source.events.library import load_library  # noqa: PLC0415

        choose_event_camera(find_event_cameras(load_library()), rest)
    elif kind is SourceKind.RECORDING:
        from neurotouch_hid.recording.check import check_recording  # noqa: PLC0415

        check_recording(find_path(spec))
    elif kind is SourceKind.DRIVER:
        if rest:
            raise refuse_source(spec)
    elif kind is SourceKind.OTHER and not _is_offered(spec):
        raise refuse_source(spec)


def _is_offered(spec: str) -> bool:
    kind, colon, _ = spec.partition(":")
    return bool(colon) and kind in list_plugins(SOURCES)


def find_path(spec: str) -> Path:
    """Returns the recording of a source.

    Raises:
        SourceError: it has no name.
    """
    rest = spec.removeprefix("file:")
    if not rest:
        raise SourceError(
            "'file:' needs the name of a recording.", hint="For example: file:play.aedat4"
        )
    return Path(rest)


def refuse_source(spec: str) -> SourceError:
    """Returns the error for a name that is no source, with the one that was meant."""
    from neurotouch_hid.source.simulator.scenes import scene_names  # noqa: PLC0415

    kind, _, rest = spec.partition(":")
    forms = [*FORMS, *(f"{name}:" for name in list_plugins(SOURCES))]
    scenes = scene_names()
    if not spec:
        return SourceError("The source is empty.", hint=f"Give one of {', '.join(forms)}.")
    if find_source_kind(spec) is SourceKind.DRIVER:
        hint = f"Write {RUNNING_DRIVER} alone. The player number says whose driver it is."
    elif spec in scenes or rest in scenes:
        hint = f"Did you mean sim:{spec if spec in scenes else rest}?"
    elif Path(spec).is_dir():
        hint = f"It is a folder. Give a recording in it: file:{spec}/NAME.aedat4"
    elif Path(spec).is_file():
        hint = f"Recordings end in {', '.join(RECORDING_ENDINGS)}; if it is one: file:{spec}"
    elif near := difflib.get_close_matches(f"{kind.lower()}:", forms, 1, 0.75):
        hint = f"Did you mean {near[0]}{rest}?"
    else:
        hint = f"Give one of {', '.join(forms)}."
    return SourceError(f"'{spec}' is not a source.", hint=hint)
