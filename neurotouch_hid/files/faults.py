"""A mistake in a file of settings, with its place, and how a list of them is shown."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Final, Literal

from neurotouch_hid.printable import make_printable

SHOWN_FAULTS: Final = 20
SHOWN_COLUMNS: Final = 100
_LINE_BREAK: Final = re.compile("\r\n|[\r\n\x85\u2028\u2029]")  # what the YAML reader counts

Keys = tuple[str | int, ...]
"""The path of a place in a document: keys of mappings, indices of lists."""


@dataclass(frozen=True, slots=True, order=True)
class Mark:
    """A stretch of one line: ``line`` and ``column`` count from 0, ``length`` is in characters."""

    line: int
    column: int
    length: int = 1


@dataclass(frozen=True, slots=True, order=True)
class Fault:
    """One mistake.

    Attributes:
        mark: where it is.
        path: the keys that lead to it, ``bindings[0].do.axis``; empty at the top.
        sentence: what is wrong.
        hint: what is shown beside the caret, or empty.
        code: its stable code, see ``codes``.
    """

    mark: Mark
    path: str
    sentence: str
    hint: str = ""
    code: str = "NT102"

    @property
    def severity(self) -> Literal["error", "warning"]:
        """A warning (NT2xx) does not keep a profile from being loaded."""
        return "warning" if self.code.startswith("NT2") else "error"


def format_path(keys: Iterable[str | int]) -> str:
    """Returns the keys that lead to a place, ``("bindings", 0, "do")`` as ``bindings[0].do``."""
    path = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in keys)
    return make_printable(path.removeprefix("."))


def suggest(word: str, known: Sequence[str]) -> str:
    """Returns ``did you mean 'zoom'?``, or nothing if no known word is near."""
    near = find_near(word, known)
    return f"did you mean '{near}'?" if near is not None else ""


def find_near(word: str, known: Sequence[str]) -> str | None:
    """Returns the known word that is nearest to a misspelt one.

    A word that begins with what was typed goes first: ``on`` is short for ``on_mm``. A word of half
    the length is no slip, unless it is a part: ``bb`` is ``b``, ``jump`` is not ``up``.
    """
    word = word[:SHOWN_COLUMNS].lower()
    longer = [each for each in known if each.startswith(f"{word}_")]
    alike = [each for each in known if 2 * len(each) > len(word) or each in word]
    near = longer or get_close_matches(word, alike, n=1)
    return near[0] if near else None


def format_faults(faults: Iterable[Fault], name: str, text: str) -> str:
    """Writes every fault as ``name:line:column: error[code]: path: sentence``, with its line."""
    ordered = sorted(set(faults))
    lines = _LINE_BREAK.split(text)
    blocks = [_format_fault(fault, name, lines) for fault in ordered[:SHOWN_FAULTS]]
    if len(ordered) > SHOWN_FAULTS:
        blocks.append(f"{name}: {len(ordered) - SHOWN_FAULTS} more")
    return "\n".join(blocks)


def describe_fault(fault: Fault) -> str:
    """Returns a fault in one sentence, for people who see no file, and its hint as another."""
    about = f", '{fault.path}'" if fault.path else ""
    hint = f" {fault.hint[:1].upper()}{fault.hint[1:]}" if fault.hint else ""
    return f"Line {fault.mark.line + 1}{about}: {fault.sentence}.{hint}"


def _format_fault(fault: Fault, name: str, lines: Sequence[str]) -> str:
    mark = fault.mark
    place = f"{name}:{mark.line + 1}:{mark.column + 1}: {fault.severity}[{fault.code}]: "
    header = place + (f"{fault.path}: " if fault.path else "") + fault.sentence
    line = lines[mark.line] if mark.line < len(lines) else ""
    first = max(0, mark.column - SHOWN_COLUMNS // 2) if len(line) > SHOWN_COLUMNS else 0
    excerpt = make_printable(line[first : first + SHOWN_COLUMNS]).rstrip()
    column = mark.column - first
    carets = "^" * max(1, min(mark.length, len(excerpt) - column))
    hint = f" {fault.hint}" if fault.hint else ""
    return f"{header}\n{mark.line + 1:>6} | {excerpt}\n{'':>6} | {'':>{column}}{carets}{hint}"
