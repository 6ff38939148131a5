"""Keeps the files of compiled kernels: finds their place, and knows a damaged one."""

import os
from collections.abc import Callable
from contextlib import suppress
from functools import cache, cached_property
from hashlib import sha1, sha256
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, Final

from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.process.source_stamp import stamp

_DIGEST_BYTES: Final = sha256().digest_size
_BESIDE: Final = "__pycache__"
_troubles: list[str] = []


class KernelFiles:
    """Files of one kernel.

    Args:
        function: the kernel in Python.

    Attributes:
        name: begins the name of each.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self._source = Path(function.__code__.co_filename)
        self._state = stamp(self._source)[:12]
        line = function.__code__.co_firstlineno
        self.name = f"{self._source.stem}.{function.__qualname__}-{line}-{self._state}"

    @cached_property
    def folder(self) -> Path:
        """The folder in which they are written, without those of other states of the package."""
        folder = _find_folder(self._source.parent)
        _remove_others(folder, self._source.stem, self._state)
        return folder

    def find_path(self, key: object, ending: str) -> Path:
        """Returns the path of one file.

        Args:
            key: everything that it depends on, apart from the source; its ``repr`` counts.
            ending: of its name.
        """
        return _find_folder(self._source.parent) / self._make_name(key, ending)

    def find_packaged(self, key: object, ending: str) -> Path:
        """Returns the path of a file that a package brings along, beside Python's own cache.

        Python runs what is in that folder: a person who may write there may change the program.
        """
        return self._source.parent / _BESIDE / self._make_name(key, ending)

    def _make_name(self, key: object, ending: str) -> str:
        digest = sha256(repr(key).encode()).hexdigest()[:16]
        return f"{self.name}.{digest}.{ending}"


def read_checked(path: Path) -> memoryview | None:
    """Returns what ``write_checked`` has written; what is damaged is removed, and gives None."""
    try:
        content = memoryview(path.read_bytes())
    except OSError:
        return None
    if sha256(content[_DIGEST_BYTES:]).digest() == content[:_DIGEST_BYTES]:
        return content[_DIGEST_BYTES:]
    remove(path)
    return None


def write_checked(path: Path, content: bytes) -> None:
    """Writes a file that begins with a digest of its content, or remembers why it cannot."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, sha256(content).digest() + content)
    except OSError as error:
        _troubles.append(
            f"What was compiled for this processor cannot be kept in '{path.parent}': "
            f"{error.strerror}. Each start will compile it again."
        )


def remove(path: Path) -> None:
    """Removes a file, if that is allowed."""
    with suppress(OSError):
        path.unlink()


def find_cache_trouble() -> str:
    """Returns a sentence about why a compiled kernel could not be kept; empty if all were."""
    return next(iter(_troubles), "")


@cache
def _find_folder(beside: Path) -> Path:
    """Returns where the kernels of a folder are kept.

    That is in ``NUMBA_CACHE_DIR``, beside their source or in the person's own cache, whichever can
    be written. If none can, it is the first that is asked for: it may hold what fits.

    Args:
        beside: the folder of their source.
    """
    name = f"{beside.name}_{sha1(str(beside).encode(), usedforsecurity=False).hexdigest()}"
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    places = [Path(chosen, name)] if chosen else []
    places.append(beside / _BESIDE)
    personal = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not personal.is_absolute():
        with suppress(RuntimeError):  # nobody knows the home
            personal = Path("~/.cache").expanduser()
    if personal.is_absolute():
        places.append(personal / "neurotouch" / name)
    return next(filter(_is_writable, places), places[0])


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


@cache
def _remove_others(folder: Path, stem: str, state: str) -> None:
    """Removes what a file's kernels were compiled to in other states of the package."""
    for path in folder.glob(f"{stem}.*"):
        is_kept = path.suffix in {".nbc", ".nbi", ".code"}
        if is_kept and f"-{state}." not in path.name:
            remove(path)  # fails in a folder of another user, or if another process was quicker
