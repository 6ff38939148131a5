"""The gel before the camera: which file describes it, and what that says."""

import os
from base64 import b64decode
from pathlib import Path
from typing import Final, NamedTuple

from neurotouch_hid.client import ask
from neurotouch_hid.driver.gel_settings import GelSettings
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.small_file import (
    MAX_SETTINGS_BYTES,
    may_be_there,
    means_path,
    read_bytes,
    suggest_reading,
)
from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.players import find_user_file
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.reading import parse_settings
from neurotouch_hid.recording import gel_path
from neurotouch_hid.status import explain_missing
from neurotouch_hid.vocabulary import RUNNING_DRIVER, SourceKind, find_source_kind

FILE: Final = "gel.yaml"
SUFFIX: Final = ".gel.yaml"

_PAPER: Final = (
    b"version: 1\nname: paper\nlayout: {kind: square, pitch_mm: 4, radius_mm: 30}\n"
    b"dot_mm: 1\ndots: light\ndome_height_mm: 15\n"
    b"making:\n  camera: {name: davis346, width_px: 346, height_px: 260, view_deg: 43.7, "
    b"fill: 0.58, lens_mm: 31, pupil_mm: 30, below_mm: 65}\n"
)
"""The gel of the paper as a file, at the paper's scale: 30 px are 12 mm; its lens is our guess."""


class GelFile(NamedTuple):
    """The content of a gel's file.

    Attributes:
        settings: its values.
        content: the file.
        name: its path, printable.
    """

    settings: GelSettings
    content: bytes
    name: str


def load_gel_file(path: Path | None) -> GelFile:
    """Returns what a gel file says; without one, what it would say of the gel of the paper.

    Raises:
        ProfileError: there is no such file, or it is wrong; every mistake has line and column.
    """
    content = _PAPER if path is None else _read_file(path)
    name = "the gel of the paper" if path is None else make_printable(str(path))
    return GelFile(parse_settings(content, name, GelSettings), content, name)


def find_gel_folder(player: int | None = None) -> Path:
    """Returns the folder of the person's gel files; of a service, the machine's."""
    return find_user_file(player).parent


def find_gel_file(
    chosen: str | None = None, source: str = "", player: int | None = None, *, personal: bool = True
) -> Path | None:
    """Returns the file of the gel that applies; None for the gel of the paper.

    Args:
        chosen: the path of a file, or the name of one in ``find_gel_folder``; ``paper`` is the
            gel of the paper. None: not chosen.
        source: the source as a person writes it. ``NAME.gel.yaml`` beside a recording applies to
            it; a simulation has the gel of the paper.
        player: the player number; None means the one of the environment.
        personal: the person's ``gel.yaml`` applies where nothing else does.
    """
    if chosen == PAPER_GEL.name:
        return None
    if chosen is not None:
        own = find_gel_folder(player) / f"{chosen}{SUFFIX}"
        # A Path would raise RuntimeError for the home of an unknown user.
        return Path(os.path.expanduser(chosen)) if means_path(chosen) else own  # noqa: PTH111
    kind = find_source_kind(source)
    if kind is SourceKind.SIMULATION:
        return None
    if kind is SourceKind.RECORDING:
        beside = gel_path(source.removeprefix("file:"))
        if beside.exists():
            return beside
    own = find_gel_folder(player) / FILE
    return own if personal and may_be_there(own) else None


class ChosenGel(NamedTuple):
    """A gel and what its file says.

    Attributes:
        gel: the gel.
        file: content of its file; empty for the gel of the paper, which needs none.
    """

    gel: Gel
    file: bytes


def choose_gel(
    chosen: str | None = None, source: str = "", player: int | None = None, *, personal: bool = True
) -> ChosenGel:
    """Returns the gel that applies; the arguments are those of ``find_gel_file``.

    Where nothing is chosen for ``driver:``, the running driver is asked for its gel.

    Raises:
        ProfileError: the file is missing or wrong.
        DriverError: the running driver does not answer, or it refuses.
    """
    if chosen is None and source == RUNNING_DRIVER:
        return _ask_driver(player)
    path = find_gel_file(chosen, source, player, personal=personal)
    if path is None:
        return ChosenGel(PAPER_GEL, b"")
    return parse_gel(_read_file(path), make_printable(str(path)))


def parse_gel(content: bytes, name: str) -> ChosenGel:
    """Returns the gel of a file that has been read.

    Args:
        content: the file.
        name: what it is called in messages.

    Raises:
        ProfileError: it is wrong; every mistake has line and column.
    """
    return ChosenGel(parse_settings(content, name, GelSettings).make(), content)


def _read_file(path: Path) -> bytes:
    """Returns the content of a gel file.

    Raises:
        ProfileError: it is missing, or cannot be read.
    """
    name = make_printable(str(path))
    if not may_be_there(path):
        raise ProfileError(
            f"There is no gel file '{name}'.",
            hint=f"Give the path of a file, or a NAME: {find_gel_folder()}/NAME{SUFFIX}.",
        )
    try:
        return read_bytes(path, MAX_SETTINGS_BYTES)
    except OSError as error:
        reason = f"'{name}' cannot be read: {error.strerror}."
        raise ProfileError(reason, hint=suggest_reading(error)) from error


def _ask_driver(player: int | None) -> ChosenGel:
    """Returns the gel that the running driver plays.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """
    file = ask("gel", player=player).get("file")
    try:
        content = b64decode(file, validate=True) if isinstance(file, str) else None
    except ValueError:
        content = None
    if content is None:
        raise explain_missing("file")
    if not content:
        return ChosenGel(PAPER_GEL, b"")
    return parse_gel(content, f"{FILE} of the running driver")
