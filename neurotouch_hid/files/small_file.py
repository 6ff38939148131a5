"""Reads a small file whole, whatever stands under its name.

A pipe, a device or a folder is refused without waiting for it, a large file before it fills the
memory. Every refusal is an ``OSError`` whose ``strerror`` completes "'FILE' cannot be read: ".
"""

import errno
import os
import stat
from pathlib import Path
from typing import Final

from neurotouch_hid.partial_file import explain_missing_right

MAX_SETTINGS_BYTES: Final = 64 * 1024
"""No file of settings is larger; the shipped profiles have up to 5 kB."""

_KINDS: Final = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def means_path(text: str) -> bool:
    """Returns whether a person who writes this means a file, not the name of something."""
    return "/" in text or text.endswith((".yaml", ".yml"))


def may_be_there(path: Path) -> bool:
    """Returns False only if there is certainly no such file; what else is wrong, reading it says.

    ``Path.exists`` says no from Python 3.14 on also where nobody may look.
    """
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError:
        return True
    return True


def suggest_reading(error: OSError, otherwise: str | None = None) -> str | None:
    """Returns what to do where a file could not be read.

    Args:
        error: what the system, or ``read_bytes``, said.
        otherwise: what to do where no right is missing, and it is not too large.
    """
    if error.errno == errno.EFBIG:
        return "Make it smaller: leave out what is not needed, such as comments."
    is_denied = error.errno in (errno.EACCES, errno.EPERM)
    return explain_missing_right(error, "read it") if is_denied else otherwise


def read_text(path: Path, most: int) -> str:
    """Returns the text of a file, with its own ends of lines.

    Args:
        path: the file.
        most: the largest number of bytes that is read.

    Raises:
        OSError: as ``read_bytes``, or it is not UTF-8.
    """
    content = read_bytes(path, most)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        byte = f"0x{content[error.start]:02x}"
        raise OSError(
            errno.EILSEQ, f"byte {byte} in line {line} is not UTF-8 text", str(path)
        ) from None


def read_bytes(path: Path, most: int) -> bytes:
    """Returns the content of a file.

    Raises:
        OSError: as ``open_regular``, or it is larger than ``most`` bytes.
    """
    descriptor = open_regular(path)
    try:
        content = bytearray()
        while len(content) <= most and (part := os.read(descriptor, most + 1 - len(content))):
            content += part
    finally:
        os.close(descriptor)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it is larger than {most // 1024} kB", str(path))
    return bytes(content)


def find_real_path(path: Path) -> Path:
    """Returns a path without links; a link that leads to itself stays what it is.

    ``Path.resolve`` ends in a ``RuntimeError`` there.
    """
    return Path(os.path.realpath(path))


def open_regular(path: Path) -> int:
    """Returns a descriptor of a regular file, open for reading; the caller closes it.

    Raises:
        OSError: it cannot be opened, or is not a regular file.
    """
    try:
        _check_regular(path, path.stat())  # to open a device can already do something
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except ValueError:  # a NUL, or half a character
        raise OSError(errno.EINVAL, "no file can have this name", str(path)) from None
    try:
        _check_regular(path, os.fstat(descriptor))  # it may be another one since
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


def _check_regular(path: Path, found: os.stat_result) -> None:
    if not stat.S_ISREG(found.st_mode):
        kind = next((name for is_kind, name in _KINDS if is_kind(found.st_mode)), "something else")
        raise OSError(errno.EINVAL, f"it is {kind}, not a file", str(path))
