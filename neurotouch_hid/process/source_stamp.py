"""Tells one state of a kernel's source from another, with all that is compiled into it.

A kernel contains the kernels that it calls, and the constants of their files.
"""

import hashlib
import re
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).parents[1]
_IMPORT = re.compile(rb"^from neurotouch_hid\.([\w.]+) import", re.MULTILINE)


@cache
def stamp(path: Path) -> str:
    """Returns a digest of a file and of every file of the package that it imports.

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
    """Returns the digest of one file, and the files of the package that it imports."""
    if not path.is_file():  # a folder: of what it is made of, files import what they need
        return b"", []
    source = path.read_bytes()
    names = (name.decode().replace(".", "/") for name in _IMPORT.findall(source))
    return hashlib.sha256(source).digest(), [_PACKAGE / f"{name}.py" for name in names]
