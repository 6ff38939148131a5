"""Reads a profile file: every mistake in it at once, each with its line, column and a way out."""

import stat
from pathlib import Path
from typing import Final

from pydantic import ValidationError

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile.document import parse_document
from neurotouch_hid.profile.faults import Fault, Mark, format_faults, make_printable
from neurotouch_hid.profile.library import find_profile
from neurotouch_hid.profile.schema import Profile
from neurotouch_hid.profile.wording import locate_faults

MAX_BYTES: Final = 64 * 1024


def load_profile(name_or_path: str | Path) -> Profile:
    """The profile of this name or at this path.

    Raises:
        ProfileError: there is none, or the file says something we cannot do; the message then holds
            all mistakes, each with ``file:line:column`` and the marked line.
    """
    path = find_profile(name_or_path)
    return parse_profile(_read(path), name=make_printable(str(path)))


def parse_profile(content: bytes, name: str) -> Profile:
    """The profile in the content of a file.

    Args:
        content: UTF-8 text, at most 64 kB.
        name: what the file is called in messages.

    Raises:
        ProfileError: as ``load_profile``.
    """
    if len(content) > MAX_BYTES:
        raise ProfileError(
            f"{name}: the file is larger than {MAX_BYTES // 1024} kB",
            hint="A profile is a small text file; is this one?",
        )
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8", "replace")
        place = Mark(before.count("\n"), len(before) - before.rfind("\n") - 1)
        fault = Fault(place, "", f"byte 0x{content[error.start]:02x} is not UTF-8 text")
        raise _refuse([fault], name, content.decode("utf-8", "replace")) from None
    root, faults = parse_document(text)
    if root is not None:
        try:
            profile = Profile.model_validate(root.value)
        except ValidationError as error:
            known = {fault.mark for fault in faults}
            faults += [fault for fault in locate_faults(error, root) if fault.mark not in known]
        else:
            if not faults:
                return profile
    raise _refuse(faults, name, text)


def _refuse(faults: list[Fault], name: str, text: str) -> ProfileError:
    return ProfileError(format_faults(faults, name, text))


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
