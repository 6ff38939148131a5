"""Reads small parts of a zip file that a stranger wrote, with limits.

Every refusal is an ``OSError`` whose ``strerror`` completes "'FILE' cannot be read: ".
"""

import errno
import io
import os
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from neurotouch_hid.files.small_file import open_regular

_MOST_READ: Final = 1 << 20
"""Bytes of one read: the table of contents is read at once, however long it says that it is."""
_METHODS: Final = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


def read_parts(path: Path, names: Sequence[str], most: int) -> dict[str, bytes]:
    """Returns the content of some parts of a zip file, by name; a missing part is left out.

    Args:
        path: the zip file, of any size.
        names: the parts.
        most: the largest number of bytes of a part, unpacked.

    Raises:
        OSError: it cannot be opened, is no regular file or no sound zip file, or a part is larger,
            there twice, encrypted, or packed in an unusual way.
    """
    descriptor = open_regular(path)
    try:
        with _Capped(descriptor) as file, zipfile.ZipFile(file) as archive:
            infos = archive.infolist()
            parts = {}
            for name in names:
                found = [info for info in infos if info.filename == name]
                if len(found) > 1:
                    raise _refuse(path, f"'{name}' is in it twice")
                if found:
                    parts[name] = _read_part(archive, found[0], path, most)
            return parts
    except (zipfile.BadZipFile, zlib.error, EOFError, ValueError, RuntimeError):
        # zipfile lets through a ValueError for a bad place, a RuntimeError for what it cannot do.
        raise _refuse(path, "it is no zip file, or a damaged one") from None


def _read_part(archive: zipfile.ZipFile, info: zipfile.ZipInfo, path: Path, most: int) -> bytes:
    if info.flag_bits & 1:
        raise _refuse(path, f"'{info.filename}' in it is encrypted")
    if info.compress_type not in _METHODS:
        raise _refuse(path, f"'{info.filename}' in it is packed in an unusual way")
    with archive.open(info) as part:
        content = part.read(most + 1)
    if len(content) > most:
        raise _refuse(path, f"'{info.filename}' in it is larger than {most // 1024} kB")
    return content


def _refuse(path: Path, reason: str) -> OSError:
    return OSError(errno.EINVAL, reason, str(path))


class _Capped(io.FileIO):
    """A file that refuses to be read in large pieces; it owns its descriptor."""

    def __init__(self, descriptor: int) -> None:
        super().__init__(descriptor, "r")

    def read(self, size: int | None = -1, /) -> bytes:
        """Returns up to ``size`` bytes.

        Raises:
            BadZipFile: that is more than a zip file of ours needs.
        """
        left = os.fstat(self.fileno()).st_size - self.tell()
        wanted = left if size is None or size < 0 else min(size, left)
        if wanted > _MOST_READ:
            raise zipfile.BadZipFile
        return super().read(wanted) or b""
