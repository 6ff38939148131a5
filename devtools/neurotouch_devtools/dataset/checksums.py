"""Checksums of a folder, in the format of ``sha256sum``, and what differs between two lists."""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Final

CHECKSUMS: Final = "SHA256SUMS"


def list_checksums(folder: Path) -> dict[str, str]:
    """Returns the SHA-256 of each file below a folder but the list itself, by its path there."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name != CHECKSUMS:
            with path.open("rb") as file:
                found[name] = hashlib.file_digest(file, "sha256").hexdigest()
    return found


def format_checksums(checksums: Mapping[str, str]) -> str:
    """Returns the list as ``sha256sum --check`` reads it."""
    return "".join(f"{digest}  {name}\n" for name, digest in checksums.items())


def read_checksums(text: str) -> dict[str, str]:
    """Returns the checksums of such a list, by path."""
    pairs = (line.split("  ", 1) for line in text.splitlines())
    return {name: digest for digest, name in pairs}


def compare_checksums(expected: Mapping[str, str], found: Mapping[str, str]) -> list[str]:
    """Returns a sentence for each file that differs; empty if all are the same."""
    missing = [f"{name} is missing." for name in expected if name not in found]
    strange = [f"{name} does not belong here." for name in found if name not in expected]
    other = [
        f"{name} has other bytes."
        for name, digest in expected.items()
        if found.get(name, digest) != digest
    ]
    return [*missing, *strange, *other]
