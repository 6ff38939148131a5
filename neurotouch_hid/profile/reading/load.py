"""Reads profiles and the user's file: every mistake at once, with line, column and a way out."""

import stat
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Generic, TypeVar

from pydantic import BaseModel, ValidationError

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile.diagnostics.consistency import check_layers
from neurotouch_hid.profile.diagnostics.lint import find_warnings
from neurotouch_hid.profile.diagnostics.unmet import find_unmet
from neurotouch_hid.profile.diagnostics.wording import locate_faults
from neurotouch_hid.profile.document import Node, find_mark, parse_document
from neurotouch_hid.profile.faults import (
    Fault,
    Mark,
    format_faults,
    format_path,
    make_printable,
    suggest,
)
from neurotouch_hid.profile.reading.inheritance import build_on
from neurotouch_hid.profile.reading.library import find_profile, find_user_file
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.profile import Profile
from neurotouch_hid.profile.schema.user import UserSettings

MAX_BYTES: Final = 64 * 1024
MAX_STEPS: Final = 4

Model = TypeVar("Model", bound=BaseModel)


@dataclass(frozen=True, slots=True)
class Checked(Generic[Model]):
    """A file that has been read.

    Attributes:
        name: what the file is called in messages.
        text: its text.
        faults: its errors and warnings, in the order of the file.
        written: what it says, or None if there are errors.
        whole: the same with everything it is built on.
    """

    name: str
    text: str
    faults: tuple[Fault, ...]
    written: Model | None = None
    whole: Model | None = None

    def format(self) -> str:
        """All faults with the marked lines."""
        return format_faults(self.faults, self.name, self.text)

    def require(self) -> Model:
        """What the file says.

        Raises:
            ProfileError: there are errors; the message holds them all.
        """
        if self.whole is None:
            errors = [fault for fault in self.faults if fault.severity == "error"]
            raise ProfileError(format_faults(errors, self.name, self.text))
        return self.whole


def load_profile(name_or_path: str | Path) -> Profile:
    """The profile of this name or at this path, with everything it is built on.

    Raises:
        ProfileError: there is none, or the file says something we cannot do; the message then holds
            all mistakes, each with ``file:line:column`` and the marked line.
    """
    return check_profile(name_or_path).require()


def check_profile(name_or_path: str | Path, unused: Collection[str] = ()) -> Checked[Profile]:
    """The profile of this name or at this path with all its faults, warnings included.

    Args:
        name_or_path: as people name it.
        unused: movements that the person does not make, of whose use is warned.

    Raises:
        ProfileError: there is no such file, or it cannot be read.
    """
    path = find_profile(name_or_path)
    return _check_profile(_read(path), make_printable(str(path)), (path.resolve(),), unused)


def parse_profile(content: bytes, name: str) -> Profile:
    """The profile in the content of a file.

    Args:
        content: UTF-8 text, at most 64 kB.
        name: what the file is called in messages.

    Raises:
        ProfileError: as ``load_profile``.
    """
    return check_content(content, name).require()


def check_content(
    content: bytes, name: str, path: Path | None = None, unused: Collection[str] = ()
) -> Checked[Profile]:
    """The profile in the content of a file with all its faults, before it is saved.

    Args:
        content: UTF-8 text, at most 64 kB.
        name: what the file is called in messages.
        path: the file it takes the place of; it must not be built on that.
        unused: as of ``check_profile``.
    """
    return _check_profile(content, name, () if path is None else (path.resolve(),), unused)


def load_user(path: Path | None = None, *, player: int | None = None) -> UserSettings:
    """Returns the person's own values; those of the reference hand if there is no file.

    Args:
        path: the file; by default ``user.yaml`` in the person's folder.
        player: the player number; None means the one of the environment.

    Raises:
        ProfileError: as ``load_profile``.
    """
    return load_settings(find_user_file(player) if path is None else path, UserSettings)


def load_unused() -> tuple[str, ...]:
    """The movements this person does not make; none where the file that says so is wrong.

    Only this one value is read: to make the models of the whole file costs a fifth of a check.
    """
    try:
        root, _ = parse_document(_decode(_read(find_user_file())))
    except (ProfileError, _UnreadableError):
        return ()
    values = root.value.get("unused") if root is not None and isinstance(root.value, dict) else ()
    return tuple(name for name in MOVEMENTS if isinstance(values, list) and name in values)


def load_settings(path: Path, model: type[Model]) -> Model:
    """What a file of settings says; the model's defaults if there is no file.

    Raises:
        ProfileError: as ``load_profile``.
    """
    with suppress(OSError):  # it may be there, and reading it says what is wrong
        if not path.exists():
            return model()
    name = make_printable(str(path))
    return _check_model(_read(path), name, model, lambda _, settings: (settings, [])).require()


def check_user(content: bytes, name: str) -> Checked[UserSettings]:
    """The user's file with all its faults."""
    return _check_model(content, name, UserSettings, lambda _, settings: (settings, []))


Finish = Callable[[Node, Model], tuple[Model | None, list[Fault]]]


def _check_model(
    content: bytes, name: str, model: type[Model], finish: Finish[Model]
) -> Checked[Model]:
    """Text, YAML and model one after the other; ``finish`` sees a whole document."""
    try:
        text = _decode(content)
    except _UnreadableError as refusal:
        return Checked(name, refusal.text, (refusal.fault,))
    root, faults = parse_document(text)
    if root is None:
        return Checked(name, text, tuple(faults))
    written: Model | None = None
    try:
        written = model.model_validate(root.value)
    except ValidationError as error:
        known = {fault.mark for fault in faults}
        found = locate_faults(error, root, model)
        faults += [fault for fault in found if fault.mark not in known]
    whole = None
    if isinstance(root.value, dict) and model is Profile:
        faults += _find_missing(root)
    if written is not None and not faults:
        whole, faults = finish(root, written)
        if any(fault.severity == "error" for fault in faults):
            whole = None
    return Checked(name, text, tuple(sorted(set(faults))), written if whole else None, whole)


def _check_profile(
    content: bytes, name: str, chain: tuple[Path, ...], unused: Collection[str] = ()
) -> Checked[Profile]:
    """As ``check_content``; ``chain`` are the files that lead here by ``extends``."""

    def finish(root: Node, profile: Profile) -> tuple[Profile | None, list[Fault]]:
        whole, faults = profile, []
        for i, base_name in enumerate(profile.extends):
            keys = ("extends", i)
            base, code, sentence = _load_base(base_name, chain)
            if base is None:
                faults.append(Fault(find_mark(root, keys), format_path(keys), sentence, code=code))
            else:
                whole = build_on(whole, base)
        if faults:
            return None, faults
        faults = check_layers(profile, whole, root)
        if not faults:
            faults = find_warnings(profile, whole, root) + find_unmet(profile, whole, root, unused)
        return whole, faults

    return _check_model(content, name, Profile, finish)


def _load_base(name: str, chain: tuple[Path, ...]) -> tuple[Profile | None, str, str]:
    """The profile another one is built on, or the code of a fault and its sentence."""
    try:
        path = find_profile(name)
        if path.resolve() in chain:
            return None, "NT131", f"'{name}' is built on this profile itself"
        if len(chain) >= MAX_STEPS:
            return None, "NT131", f"'{name}' is built on too many others, one on the other"
        content = _read(path)
    except ProfileError as error:
        return None, "NT130", error.message
    checked = _check_profile(content, make_printable(str(path)), (*chain, path.resolve()))
    if checked.whole is None:
        first = checked.format().split("\n", 1)[0]
        return None, "NT132", f"'{name}' has errors: {first}"
    return checked.whole, "", ""


def _find_missing(root: Node) -> list[Fault]:
    """A profile has bindings of its own or of others."""
    sources = ("bindings", "layers", "extends")
    if any(key in root.keys or any(suggest(k, [key]) for k in root.keys) for key in sources):
        return []
    return [Fault(root.mark, "", "the key 'bindings' is missing", code="NT111")]


class _UnreadableError(Exception):
    """The content is no text we read."""

    def __init__(self, fault: Fault, text: str) -> None:
        self.fault, self.text = fault, text


def _decode(content: bytes) -> str:
    if len(content) > MAX_BYTES:
        sentence = f"the file is larger than {MAX_BYTES // 1024} kB"
        raise _UnreadableError(Fault(Mark(0, 0), "", sentence, code="NT101"), "")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8", "replace")
        place = Mark(before.count("\n"), len(before) - before.rfind("\n") - 1)
        sentence = f"byte 0x{content[error.start]:02x} is not UTF-8 text"
        fault = Fault(place, "", sentence, code="NT101")
        raise _UnreadableError(fault, content.decode("utf-8", "replace")) from None


def _read(path: Path) -> bytes:
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise ProfileError(f"{path} is not a file", hint="Give the path of a .yaml file.")
        with path.open("rb") as file:
            return file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise ProfileError(
            f"the profile file {path} does not exist", hint="Without a '/', a name is looked up."
        ) from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise ProfileError(f"the profile file {path} cannot be read: {reason}") from None
