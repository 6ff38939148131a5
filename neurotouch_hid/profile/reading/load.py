"""Reads profiles and the user's file: every mistake at once, with line, column and a fix."""

import shlex
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Generic, TypeVar

from pydantic import BaseModel, ValidationError

from neurotouch_hid.errors import ProfileError, require_type
from neurotouch_hid.files.faults import Fault, Mark, format_faults, format_path, suggest
from neurotouch_hid.files.small_file import (
    MAX_SETTINGS_BYTES,
    find_real_path,
    may_be_there,
    read_bytes,
    suggest_reading,
)
from neurotouch_hid.files.yaml_document import Node, find_mark, parse_document
from neurotouch_hid.players import find_machine_folder, find_user_file
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.diagnostics.consistency import check_layers
from neurotouch_hid.profile.diagnostics.lint import find_warnings
from neurotouch_hid.profile.diagnostics.schema_errors import locate_faults
from neurotouch_hid.profile.diagnostics.unmet import find_unmet
from neurotouch_hid.profile.reading.inheritance import build_on
from neurotouch_hid.profile.reading.library import find_profile, list_profile_folders
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.profile import Profile
from neurotouch_hid.profile.schema.user import UserSettings

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
        """Returns all faults with the marked lines."""
        return format_faults(self.faults, self.name, self.text)

    def require(self) -> Model:
        """Returns the content of the file.

        Raises:
            ProfileError: there are errors; the message holds them all.
        """
        if self.whole is None:
            errors = [fault for fault in self.faults if fault.severity == "error"]
            raise ProfileError(format_faults(errors, self.name, self.text))
        return self.whole


def load_profile(name_or_path: str | Path, folder: Path | None = None) -> Profile:
    """Returns the profile of this name or at this path, with everything it is built on.

    Args:
        name_or_path: as people name it.
        folder: the person's settings; None means those of this process's user.

    Raises:
        TypeError: the name is neither a text nor a path.
        ProfileError: there is none, or the file says something we cannot do; the message then holds
            all mistakes, each with ``file:line:column`` and the marked line.
    """
    require_type("name_or_path", name_or_path, (str, Path), "a name or path such as 'spacecraft'")
    return check_profile(name_or_path, folder=folder).require()


def check_profile(
    name_or_path: str | Path, unused: Collection[str] = (), folder: Path | None = None
) -> Checked[Profile]:
    """Returns the profile of this name or at this path with all its faults, warnings included.

    Args:
        name_or_path: as people name it.
        unused: movements that the person does not make, of whose use is warned.
        folder: the person's settings; None means those of this process's user.

    Raises:
        ProfileError: there is no such file, or it cannot be read.
    """
    path = find_profile(name_or_path, folder)
    name = make_printable(str(path))
    content = _read(path)  # first: a path that cannot be a path is told there
    chain = (find_real_path(path),)
    return _check_named(content, name, chain, unused, folder, _find_name(path, folder))


def check_listed(path: Path) -> Checked[Profile]:
    """Returns a profile of a list; for one that cannot be read, that is its only fault."""
    try:
        return check_profile(path)
    except ProfileError as error:
        fault = Fault(Mark(0, 0), "", error.message.removesuffix("."), code="NT101")
        return Checked(make_printable(str(path)), "", (fault,))


def parse_profile(content: bytes, name: str) -> Profile:
    """Returns the profile in the content of a file.

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
    """Returns the profile in the content of a file with all its faults, before it is saved.

    Args:
        content: UTF-8 text, at most 64 kB.
        name: what the file is called in messages.
        path: the file it takes the place of; it must not be built on that.
        unused: as of ``check_profile``.
    """
    if path is None:
        return _check_profile(content, name, (), unused)
    return _check_named(content, name, (find_real_path(path),), unused, None, _find_name(path))


def load_user(*, player: int | None = None, folder: Path | None = None) -> UserSettings:
    """Returns the person's own values.

    Without a file they are the machine's, and without those the reference hand's.

    Args:
        player: the player number; None means the one of the environment.
        folder: the person's settings; None means those of this process's user.

    Raises:
        ProfileError: as ``load_profile``.
    """
    return load_settings(find_values(player, folder), UserSettings)


def find_values(player: int | None = None, folder: Path | None = None) -> Path:
    """Returns the file whose values apply, the person's or the machine's; it need not exist."""
    own = find_user_file(player, folder)
    return own if may_be_there(own) else find_user_file(player, find_machine_folder())


def load_unused() -> tuple[str, ...]:
    """Returns the movements this person does not make; none where the file that says so is wrong.

    Only this one value is read: to make the models of the whole file costs a fifth of a check.
    """
    try:
        root, _ = parse_document(_decode(_read(find_values())))
    except (ProfileError, _UnreadableError):
        return ()
    values = root.value.get("unused") if root is not None and isinstance(root.value, dict) else ()
    return tuple(name for name in MOVEMENTS if isinstance(values, list) and name in values)


def load_settings(path: Path, model: type[Model]) -> Model:
    """Returns the content of a settings file; the model's defaults if there is none.

    Raises:
        ProfileError: as ``load_profile``.
    """
    if not may_be_there(path):
        return model()
    content = _read(path, "settings", suggest_moving(path))
    return parse_settings(content, make_printable(str(path)), model)


def suggest_moving(path: Path) -> str:
    """Returns what to do where something else is in the place of a settings file."""
    name = shlex.quote(str(path))
    return f"Move it away, and the defaults apply: mv {name} {name}.old"


def parse_settings(content: bytes, name: str, model: type[Model]) -> Model:
    """Returns the content of a settings file that has been read.

    Args:
        content: UTF-8 text, at most 64 kB.
        name: what the file is called in messages.
        model: of its content.

    Raises:
        ProfileError: as ``load_profile``.
    """
    return _check_model(content, name, model, lambda _, settings: (settings, [])).require()


def check_user(content: bytes, name: str) -> Checked[UserSettings]:
    """Returns the user's file with all its faults."""
    return _check_model(content, name, UserSettings, lambda _, settings: (settings, []))


def holds_values(content: bytes) -> bool:
    """Returns whether the content of a file is a person's own values, and no profile."""
    try:
        root, _ = parse_document(_decode(content))
    except _UnreadableError:
        return False
    keys = set(root.keys) if root is not None and isinstance(root.value, dict) else set()
    of_profile = {"name", "bindings", "layers", "extends"}
    return bool(keys) and not keys & of_profile and keys <= set(UserSettings.model_fields)


Finish = Callable[[Node, Model], tuple[Model | None, list[Fault]]]


def _check_model(
    content: bytes, name: str, model: type[Model], finish: Finish[Model]
) -> Checked[Model]:
    """Returns text, YAML and model one after the other; ``finish`` sees a whole document."""
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
    is_other = any(fault.code == "NT119" for fault in faults)  # a version with other keys
    if isinstance(root.value, dict) and model is Profile and not is_other:
        faults += _find_missing(root)
    if written is not None and not faults:
        whole, faults = finish(root, written)
        if any(fault.severity == "error" for fault in faults):
            whole = None
    return Checked(name, text, tuple(sorted(set(faults))), written if whole else None, whole)


def _find_name(path: Path, folder: Path | None = None) -> str | None:
    """Returns the name that leads to a file, whatever it calls itself; None if none does."""
    return path.stem if path.absolute().parent in list_profile_folders(folder) else None


def _check_named(
    content: bytes,
    name: str,
    chain: tuple[Path, ...],
    unused: Collection[str],
    folder: Path | None,
    called: str | None,
) -> Checked[Profile]:
    """Checks a profile that has the name ``called``; of another name in the file is warned."""
    checked = _check_profile(content, name, chain, unused, folder)
    if checked.whole is None or called in (None, checked.whole.name):
        return checked
    root, _ = parse_document(checked.text)
    assert root is not None  # noqa: S101  it has just been read
    sentence = f"the file's own name counts, so this profile is called '{called}'"
    hint = f"write 'name: {called}', or rename the file"
    fault = Fault(find_mark(root, ("name",)), "name", sentence, hint, "NT214")
    models = (checked.written, checked.whole)
    written, whole = (each and each.model_copy(update={"name": called}) for each in models)
    faults = tuple(sorted((*checked.faults, fault)))
    return Checked(name, checked.text, faults, written, whole)


def _check_profile(
    content: bytes,
    name: str,
    chain: tuple[Path, ...],
    unused: Collection[str] = (),
    folder: Path | None = None,
) -> Checked[Profile]:
    """Checks like ``check_content``; ``chain`` are the files that lead here by ``extends``."""

    def finish(root: Node, profile: Profile) -> tuple[Profile | None, list[Fault]]:
        whole, faults = profile, []
        for i, base_name in enumerate(profile.extends):
            keys = ("extends", i)
            base, code, sentence = _load_base(base_name, chain, folder)
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


def _load_base(
    name: str, chain: tuple[Path, ...], folder: Path | None
) -> tuple[Profile | None, str, str]:
    """Returns the profile another one is built on, or the code of a fault and its sentence."""
    try:
        path = find_profile(name, folder)
        if find_real_path(path) in chain:
            return None, "NT131", f"'{name}' is built on this profile itself"
        if len(chain) >= MAX_STEPS:
            return None, "NT131", f"'{name}' is built on too many others, one on the other"
        content = _read(path)
    except ProfileError as error:
        told = error.message[:1].lower() + error.message[1:].rstrip(".")
        if (error.hint or "").startswith("Did you mean"):
            told += f"; d{(error.hint or '')[1:].partition('? ')[0]}?"
        return None, "NT130", told
    printable = make_printable(str(path))
    checked = _check_profile(content, printable, (*chain, find_real_path(path)), folder=folder)
    if checked.whole is None:
        first = checked.format().split("\n", 1)[0]
        return None, "NT132", f"'{name}' has errors: {first}"
    return checked.whole, "", ""


def _find_missing(root: Node) -> list[Fault]:
    """Returns the fault of a profile with no bindings, neither its own nor those of others."""
    sources = ("bindings", "layers", "extends")
    if any(key in root.keys or any(suggest(k, [key]) for k in root.keys) for key in sources):
        return []
    return [Fault(root.mark, "", "the key 'bindings' is missing", code="NT111")]


class _UnreadableError(Exception):
    """The content is not text in UTF-8."""

    def __init__(self, fault: Fault, text: str) -> None:
        self.fault, self.text = fault, text


def _decode(content: bytes) -> str:
    if len(content) > MAX_SETTINGS_BYTES:
        sentence = f"the file is larger than {MAX_SETTINGS_BYTES // 1024} kB"
        raise _UnreadableError(Fault(Mark(0, 0), "", sentence, code="NT101"), "")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8", "replace")
        place = Mark(before.count("\n"), len(before) - before.rfind("\n") - 1)
        sentence = f"byte 0x{content[error.start]:02x} is not UTF-8 text"
        fault = Fault(place, "", sentence, code="NT101")
        raise _UnreadableError(fault, content.decode("utf-8", "replace")) from None


def _read(
    path: Path, kind: str = "profile", otherwise: str = "Give the path of a .yaml file."
) -> bytes:
    """Returns the content of a file.

    Args:
        path: the file.
        kind: of file, for the error.
        otherwise: the fix where the file is there and no right is missing.

    Raises:
        ProfileError: it is not there, or cannot be read.
    """
    try:
        return read_bytes(path, MAX_SETTINGS_BYTES)
    except FileNotFoundError:
        raise ProfileError(
            f"The {kind} file {path} does not exist.",
            hint="Check the path. The profiles by name: neurotouch profile list",
        ) from None
    except OSError as error:
        raise ProfileError(
            f"The {kind} file {path} cannot be read: {error.strerror}.",
            hint=suggest_reading(error, otherwise),
        ) from None
