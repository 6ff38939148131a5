"""Where compiled loops are kept, and when they are compiled again.

numba looks whether the file of a loop has changed. But a loop contains the loops that it calls, and
the constants of their files: after an update that changed only these, it would go on as before.
"""

import hashlib
import re
from contextlib import suppress
from functools import cache
from pathlib import Path

from numba.core import caching

_PACKAGE = Path(__file__).parents[1]
_IMPORT = re.compile(rb"^from neurotouch_hid\.([\w.]+) import", re.MULTILINE)


def stamp(path: Path) -> str:
    """Tells one state of a file, and of all of the package that it imports, from another.

    Args:
        path: a Python file.
    """
    digest, found, todo = hashlib.sha256(), set[Path](), [path]
    while todo:
        source = todo.pop()
        if source not in found:
            found.add(source)
            own, imported = _read(source)
            digest.update(own)
            todo += imported
    return digest.hexdigest()


@cache
def _read(path: Path) -> tuple[bytes, list[Path]]:
    """Tells the state of a file, and which of the package it imports."""
    if not path.is_file():  # a folder: of what it is made of, files import what they need
        return b"", []
    source = path.read_bytes()
    names = (name.decode().replace(".", "/") for name in _IMPORT.findall(source))
    return hashlib.sha256(source).digest(), [_PACKAGE / f"{name}.py" for name in names]


@cache
def _remove_others(folder: Path, stem: str, mark: str) -> None:
    """Removes what a file's loops were compiled to in other states of the package."""
    for path in folder.glob(f"{stem}.*.nb[ci]"):
        if mark not in path.name:
            with suppress(OSError):  # a folder of another user, or another process was quicker
                path.unlink()


class _Stamped:
    """Puts the state into the names of the files, too.

    numba reads a file before it compares the state in it. If that file names a class that an update
    has renamed, reading it fails, and the program with it.
    """

    _py_file: str
    _cache_path: str

    def get_source_stamp(self) -> str:
        return stamp(Path(self._py_file))

    def get_disambiguator(self) -> str:
        mark = f"-{self.get_source_stamp()[:12]}."
        _remove_others(Path(self._cache_path), Path(self._py_file).stem, mark)
        return f"{super().get_disambiguator()}{mark[:-1]}"  # type: ignore[misc]  # of the locator


class Chosen(_Stamped, caching.UserProvidedCacheLocator):  # type: ignore[misc]  # numba has no types
    """In ``NUMBA_CACHE_DIR``."""


class Beside(_Stamped, caching.InTreeCacheLocator):  # type: ignore[misc]  # numba has no types
    """Beside the file of the loop."""


class Personal(_Stamped, caching.UserWideCacheLocator):  # type: ignore[misc]  # numba has no types
    """In the user's own cache."""
