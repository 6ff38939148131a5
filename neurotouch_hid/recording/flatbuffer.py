"""Reads a table of a FlatBuffer that may be damaged: no look leaves its bytes.

A buffer begins with the position of its table and its name. A table begins with how far before it
its *vtable* lies, which has two sizes and for each field where it is in the table, or 0.
All numbers are little-endian, all positions count from their own place on.
"""

import struct


class FlatTable:
    """The root table of a buffer.

    Args:
        data: the buffer, without the size that stands in front of it.
        name: the four letters that such a buffer bears.

    Raises:
        ValueError: it is of another kind, or damaged; so do all methods.
    """

    def __init__(self, data: bytes | memoryview, name: bytes) -> None:
        self._data = data
        if data[4:8] != name:
            raise ValueError(f"no {name.decode()}")
        self._at = self._unpack("<I", 0)
        self._fields = self._at - self._unpack("<i", self._at)
        self._end = self._unpack("<H", self._fields)

    def number(self, field: int, kind: str, default: int = 0) -> int:
        """Returns a number.

        Args:
            field: which one; they count from 0.
            kind: its type, as ``struct`` writes it.
            default: what it is where the table leaves it out.
        """
        at = self._find(field)
        return default if at is None else self._unpack(kind, at)

    def vector(self, field: int, item_bytes: int) -> tuple[int, int]:
        """Returns where the items of a vector begin, and how many there are; (0, 0) without it."""
        at = self._find(field)
        if at is None:
            return 0, 0
        begin = at + self._unpack("<I", at) + 4
        n = self._unpack("<I", begin - 4)
        if begin + n * item_bytes > len(self._data):
            raise ValueError("a vector reaches beyond the end")
        return begin, n

    def _find(self, field: int) -> int | None:
        slot = 4 + 2 * field
        offset = self._unpack("<H", self._fields + slot) if slot + 2 <= self._end else 0
        return self._at + offset if offset else None

    def _unpack(self, kind: str, at: int) -> int:
        try:
            if at >= 0:  # what is less would count from the end
                return int(struct.unpack_from(kind, self._data, at)[0])
        except struct.error:
            pass
        raise ValueError("a field lies outside")
