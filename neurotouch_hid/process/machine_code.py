"""Links the machine code of a kernel, as an ELF object has it, to what only needs addresses.

Source: System V Application Binary Interface, and its AMD64 supplement for the relocations.
"""

import struct
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

_PAGE_BYTES: Final = 4096
_ENVIRONMENT: Final = "_ZN08NumbaEnv"
"""numba's names of variables that point to an Environment begin so."""

_LOCKED: Final = {"NRT_incref": b"\xf0\x48\xff\x07", "NRT_decref": b"\xf0\x48\xff\x0f"}
"""numba's functions that count who uses an array, and the instruction that counts: ``lock inc`` and
``lock dec``. The first byte is the lock."""
_NOTHING: Final = 0x90  # the instruction that does nothing
_MOST_COUNTING: Final = 16  # bytes of such a function up to the end of that instruction

_HEADER: Final = struct.Struct("<16sHHIQQQIHHHHHH")
_SECTION: Final = struct.Struct("<IIQQQQIIQQ")
_SYMBOL: Final = struct.Struct("<IBBHQQ")
_RELOCATION: Final = struct.Struct("<QQq")
_X86_64: Final = 62
_SYMBOLS, _RELOCATIONS, _NO_CONTENT = 2, 4, 8  # types of sections
_WRITABLE, _IN_MEMORY, _THREAD_LOCAL = 1, 2, 0x400  # their flags
_COMMON: Final = 0xFFF2  # instead of the number of a section: a variable, zero at the beginning
_ABSOLUTE, _RELATIVE = 1, 24  # relocations of 64 bits
_UNWINDING: Final = ".eh_frame"
"""Only exceptions of C++ need this section, and numba's are none."""


class CannotLinkError(Exception):
    """An object has something that this module does not know."""


class LinkedCode(NamedTuple):
    """Machine code in one piece; its places are offsets in bytes from its beginning.

    Attributes:
        content: code and constants; zeros at places that get an address.
        data_start: where variables begin, a multiple of a page.
        size: bytes with the variables, which begin as zero.
        entry: place of the function that is called.
        inner: n x 2 int64: a place, and the place of this code whose address it gets.
        outer: n x 3 int64: a place, the number of the symbol whose address it gets, and what is
            added to that.
        symbols: names of the symbols elsewhere.
        environments: constants of each environment of numba, by the place that gets its address;
            the first belongs to the function.
    """

    content: bytes
    data_start: int
    size: int
    entry: int
    inner: NDArray[np.int64]
    outer: NDArray[np.int64]
    symbols: tuple[str, ...]
    environments: dict[int, list[Any]]


class _Section(NamedTuple):
    name: int
    kind: int
    flags: int
    address: int
    offset: int
    size: int
    link: int
    info: int
    alignment: int
    entry_size: int


def link(code: bytes, entry: str, environments: dict[str, list[Any]]) -> LinkedCode:
    """Returns the linked code of a relocatable object.

    Args:
        code: the object, in ELF for x86-64.
        entry: name of the function that is called.
        environments: constants of numba's environments, by their names; the function's own first.

    Raises:
        CannotLinkError: it is for another processor, or has something unknown.
    """
    try:
        return _Linker(code).link(entry, environments)
    except (struct.error, LookupError, ValueError, StopIteration) as error:
        raise CannotLinkError(str(error)) from error


class _Linker:
    def __init__(self, code: bytes) -> None:
        self._code = code
        magic, _, machine, *_, start, _, _, _, _, _, n, names = _HEADER.unpack_from(code)
        if magic[:6] != b"\x7fELF\x02\x01" or machine != _X86_64:
            raise CannotLinkError("not for x86-64")
        places = range(start, start + n * _SECTION.size, _SECTION.size)
        self._sections = [_Section._make(_SECTION.unpack_from(code, place)) for place in places]
        self._names = self._sections[names]
        self._content = bytearray()
        self._starts: dict[int, int] = {}
        self._inner: list[tuple[int, int]] = []
        self._outer: list[tuple[int, int, int]] = []
        self._symbols: dict[str, int] = {}
        self._variables: dict[str, int] = {}

    def link(self, entry: str, environments: dict[str, list[Any]]) -> LinkedCode:
        for k, section in enumerate(self._sections):
            if section.flags & _IN_MEMORY and section.size:
                self._place(k, section)
        data_start = len(self._content) + -len(self._content) % _PAGE_BYTES
        symbols = self._read_symbols(data_start)
        for name, place in symbols:
            if name in _LOCKED and place is not None:
                self._unlock(_LOCKED[name], place)
        for section in self._sections:
            if section.kind == _RELOCATIONS and section.info in self._starts:
                start, end = section.offset, section.offset + section.size
                for offset, info, addend in _RELOCATION.iter_unpack(self._code[start:end]):
                    place = self._starts[section.info] + offset
                    self._relocate(place, info & 0xFFFFFFFF, symbols[info >> 32], addend)
        return LinkedCode(
            bytes(self._content),
            data_start,
            data_start + 8 * len(self._variables),
            next(place for name, place in symbols if name == entry and place is not None),
            np.array(self._inner, np.int64).reshape(-1, 2),
            np.array(self._outer, np.int64).reshape(-1, 3),
            tuple(self._symbols),
            {self._variables[name]: each for name, each in environments.items()},
        )

    def _place(self, k: int, section: _Section) -> None:
        if self._read_name(self._names, section.name) == _UNWINDING:
            return
        if section.flags & (_WRITABLE | _THREAD_LOCAL) or section.kind == _NO_CONTENT:
            raise CannotLinkError("variables")
        self._content += bytes(-len(self._content) % max(section.alignment, 1))
        self._starts[k] = len(self._content)
        self._content += self._code[section.offset : section.offset + section.size]

    def _read_symbols(self, data_start: int) -> list[tuple[str, int | None]]:
        """Returns name and place of each symbol; those from elsewhere have no place."""
        (table,) = (each for each in self._sections if each.kind == _SYMBOLS)
        found: list[tuple[str, int | None]] = []
        content = self._code[table.offset : table.offset + table.size]
        for name_at, _, _, section, value, size in _SYMBOL.iter_unpack(content):
            name = self._read_name(self._sections[table.link], name_at)
            place = None
            if section in self._starts:
                place = self._starts[section] + value
            elif section == _COMMON:
                if not name.startswith(_ENVIRONMENT) or size != 8:
                    raise CannotLinkError(f"variable {name}")
                place = self._variables[name] = data_start + 8 * len(self._variables)
            found.append((name, place))
        return found

    def _unlock(self, counting: bytes, place: int) -> None:
        """Lets a function count without a lock, which takes three times as long as to count.

        Each call of a kernel counts for itself what it uses, and a kernel has one thread.
        """
        at = self._content.find(counting, place, place + _MOST_COUNTING)
        if at >= 0:
            self._content[at] = _NOTHING

    def _relocate(self, place: int, kind: int, symbol: tuple[str, int | None], addend: int) -> None:
        name, target = symbol
        if kind == _ABSOLUTE and target is not None:
            self._inner.append((place, target + addend))
        elif kind == _ABSOLUTE and name:
            number = self._symbols.setdefault(name, len(self._symbols))
            self._outer.append((place, number, addend))
        elif kind == _RELATIVE and target is not None:
            self._content[place : place + 8] = struct.pack("<q", target + addend - place)
        else:
            raise CannotLinkError(f"relocation {kind} to {name or 'nothing'}")

    def _read_name(self, names: _Section, offset: int) -> str:
        begin = names.offset + offset
        return self._code[begin : self._code.index(b"\0", begin)].decode()
