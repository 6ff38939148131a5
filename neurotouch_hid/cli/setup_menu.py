"""The entry in the desktop's menu of programs, for people who installed with pipx or uv."""

import os
import re
import shutil
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Final

from neurotouch_hid.desktop import find_data_folder
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.resources import find_resources

_NAME: Final = "neurotouch-hid.desktop"
_SYSTEM_FOLDERS: Final = "/usr/local/share:/usr/share"
_RESERVED: Final = re.compile(r'[\s"\'\\><~|&;$*?#()`]')
"""Characters that a program in ``Exec`` may have only in quotes (Desktop Entry Specification)."""


def find_menu_entry(environment: Mapping[str, str]) -> Path:
    """Returns where this person's entry is, or would be."""
    return find_data_folder(environment) / "applications" / _NAME


def needs_menu_entry(environment: Mapping[str, str]) -> bool:
    """Returns False for root, who has no menu, and where a package brings an entry for all."""
    if os.geteuid() == 0:
        return False
    folders = (environment.get("XDG_DATA_DIRS") or _SYSTEM_FOLDERS).split(":")
    return not any((Path(folder) / "applications" / _NAME).exists() for folder in folders if folder)


def install_menu_entry(entry: Path) -> None:
    """Writes the entry, which starts this installation.

    Raises:
        NeuroTouchError: it cannot be written, or the program is not a file.
    """
    program = Path(sys.prefix, "bin", "neurotouch")
    if not program.exists():  # installed without an environment of its own
        found = shutil.which("neurotouch")
        if found is None:
            raise NeuroTouchError(
                "The menu gets no entry: the command 'neurotouch' is not in PATH.",
                hint="Install the program with pipx, then type this again.",
            )
        program = Path(found)
    text = (find_resources("desktop") / _NAME).read_text(encoding="utf-8")
    try:
        entry.parent.mkdir(parents=True, exist_ok=True)
        write_whole(entry, make_menu_entry(text, program).encode())
    except OSError as error:
        raise NeuroTouchError(
            f"The menu gets no entry: {error.filename}: {error.strerror}.",
            hint="The command can safely be run again.",
        ) from error


def make_menu_entry(text: str, program: Path) -> str:
    """Returns an entry that starts the program by its path.

    The menu does not always look where pipx puts commands. ``TryExec`` hides the entry once the
    program is gone, so 'pipx uninstall' alone leaves nothing that can be seen.

    Args:
        text: the entry of the packages, which start ``neurotouch``.
        program: its absolute path.
    """
    path = str(program)
    word = path.replace("%", "%%")
    if _RESERVED.search(word):
        word = '"' + re.sub(r'(["`$\\])', r"\\\1", word) + '"'
    # Each value is a string, in which a backslash is written twice, too.
    word, path = (each.replace("\\", "\\\\") for each in (word, path))
    text = text.replace("Exec=neurotouch ", f"TryExec={path}\nExec={word} ", 1)
    return text.replace("Exec=neurotouch ", f"Exec={word} ")


def remove_menu_entry(entry: Path) -> None:
    """Removes the entry, and its folder if it was the only one."""
    entry.unlink(missing_ok=True)
    with suppress(OSError):
        entry.parent.rmdir()
