"""Finds profiles: in the person's own folder first, then the machine's, then the shipped.

``folder`` is always the folder of a person's settings; None means those of this process's user.
"""

import re
import unicodedata
from pathlib import Path
from typing import Final

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import suggest
from neurotouch_hid.files.small_file import means_path
from neurotouch_hid.players import find_config_folder, find_machine_folder, look_into
from neurotouch_hid.printable import make_printable
from neurotouch_hid.resources import PACKAGE_FOLDER, find_resources
from neurotouch_hid.vocabulary import NAME_PATTERN

OWN_VALUES: Final = "user"
"""What commands call the person's own values; no profile has this name."""


def find_shipped_folder(package: Path = PACKAGE_FOLDER) -> Path:
    """Returns the folder of the shipped profiles."""
    return find_resources("profiles", package)


def find_user_folder(folder: Path | None = None) -> Path:
    """Returns the folder for the person's own profiles; it need not exist."""
    return (folder or find_config_folder()) / "profiles"


def list_changeable_folders(folder: Path | None = None) -> list[Path]:
    """Returns the folders of profiles that are not shipped, the first one searched first.

    They need not exist.
    """
    own, machine = find_user_folder(folder), find_machine_folder() / "profiles"
    return list(dict.fromkeys([own, machine]))


def list_profile_folders(folder: Path | None = None) -> list[Path]:
    """Returns the folders of profiles, the first one searched first; they need not exist."""
    return [*list_changeable_folders(folder), find_shipped_folder()]


def list_profiles(folder: Path | None = None) -> dict[str, Path]:
    """Returns every profile that can be loaded by name, sorted; a person's own hides others.

    Raises:
        ProfileError: a folder is there and cannot be looked into.
    """
    found = {
        path.stem: path
        for place in reversed(list_profile_folders(folder))
        for path in look_into(place)
        if path.suffix == ".yaml" and re.fullmatch(NAME_PATTERN, path.stem) and path.is_file()
    }
    return dict(sorted(found.items()))


def list_misnamed() -> dict[Path, Path]:
    """Returns the profile files that no name leads to, because of their own names.

    Returns:
        Each with a free path in its folder that would do.

    Raises:
        ProfileError: as ``list_profiles``.
    """
    found: dict[Path, Path] = {}
    for place in list_changeable_folders():
        for path in look_into(place):
            if path.name.startswith("."):
                continue
            named = path.suffix == ".yaml" and re.fullmatch(NAME_PATTERN, path.stem)
            if path.suffix.lower() in (".yaml", ".yml") and not named and path.is_file():
                stem, n = propose_name(path.stem) or "profile", 1
                free = path.with_name(f"{stem}.yaml")
                while free.exists():
                    n += 1
                    free = path.with_name(f"{stem[:60]}-{n}.yaml")
                found[path] = free
    return found


def propose_name(wrong: str) -> str:
    """Returns a name that can be used and resembles a wrong one, or nothing."""
    plain = unicodedata.normalize("NFKD", wrong.lower())  # an accent is a character of its own
    words = re.findall(r"[a-z0-9_]+", plain.encode("ascii", "ignore").decode())
    return "-".join(words)[:64].strip("-")


def find_profile(name_or_path: str | Path, folder: Path | None = None) -> Path:
    """Returns the file of a profile.

    Args:
        name_or_path: a path (see ``means_path``) or a name.
        folder: the person's settings.

    Raises:
        ProfileError: no profile has this name, or the folders cannot be read.
    """
    if isinstance(name_or_path, Path) or means_path(name_or_path):
        return Path(name_or_path)
    known = list_profiles(folder)
    if name_or_path in known:
        return known[name_or_path]
    near = suggest(name_or_path, list(known))
    raise ProfileError(
        f"No profile is called '{make_printable(name_or_path[:64])}'.",
        hint=f"{near[:1].upper()}{near[1:]}" or "List them: neurotouch profile list",
    )
