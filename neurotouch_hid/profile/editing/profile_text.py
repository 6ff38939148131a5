"""The text of a profile with the place of every value; an edit changes one place in it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import Keys, format_faults, format_path
from neurotouch_hid.files.yaml_document import parse_document
from neurotouch_hid.profile.editing.text_layout import (
    Entry,
    Part,
    find_entry,
    find_part,
    read_layout,
)
from neurotouch_hid.profile.editing.yaml_values import format_value


@dataclass(frozen=True)
class ProfileText:
    """The text of a profile or of the user's file.

    Every edit returns a new one, in which comments, order and layout of all else are as before. A
    text is parsed when its values are first needed, and never twice.

    Attributes:
        text: the text.
        name: what the file is called in messages.
    """

    text: str
    name: str = field(default="the file", compare=False)

    def __str__(self) -> str:
        return self.text

    @cached_property
    def document(self) -> Any:
        """The plain value of the text.

        Raises:
            ProfileError: it is not YAML that a profile may be made of.
        """
        root, faults = parse_document(self.text)
        if root is None or any(fault.code in ("NT104", "NT105") for fault in faults):
            raise ProfileError(format_faults(faults, self.name, self.text))
        return root.value

    @cached_property
    def layout(self) -> Part:
        """The place of every value.

        Raises:
            ProfileError: as ``document``.
        """
        _ = self.document  # refuses harmful text before its layout is read
        return read_layout(self.text)

    def find(self, keys: Keys) -> Any:
        """Returns the value at the end of a path of keys; None if there is none."""
        value = self.document
        for key in keys:
            if isinstance(value, dict):
                value = value.get(key)
            elif isinstance(value, list) and isinstance(key, int):
                value = value[key]
            else:
                return None
        return value

    def encode(self) -> bytes:
        """Returns the text as it is in a file."""
        return self.text.encode("utf-8", "surrogatepass")

    def rewrite(self, text: str) -> "ProfileText":
        """Returns another text of the same file."""
        return ProfileText(text, self.name)

    def replace(self, keys: Keys, value: Any) -> "ProfileText":
        """Returns the text with another value at a place; quotes around a word stay as they are.

        Raises:
            ProfileError: there is no such place.
        """
        entry = find_entry(self.layout, keys)
        begin, style, new = entry.part.begin, entry.part.style, format_value(value)
        if style in ("'", '"') and isinstance(value, str):
            quoted = format_value(f"{value}:", style)  # the colon calls for quotes
            new = quoted[:-2] + quoted[-1]
        elif style == "block" and isinstance(entry.key, str):
            begin, new = self.text.index(":", entry.key_end) + 1, f" {new}"
        return self._splice(begin, entry.part.end, new)

    def insert(self, keys: Keys, key: str, value: Any, order: Sequence[str] = ()) -> "ProfileText":
        """Returns the text with a further key in a mapping.

        Args:
            keys: the path of the mapping; empty for the whole document.
            key: the new key.
            value: its value.
            order: how the keys of a block follow one another; by default the new one comes last.

        Raises:
            ProfileError: there is no such mapping.
        """
        part = find_part(self.layout, keys)
        pair = f"{format_value(key)}: {format_value(value)}"
        if part.is_list or part.style not in ("flow", "block"):
            raise ProfileError(f"'{format_path(keys)}' has no keys.")
        if part.style == "flow":
            return self._insert_in_flow(part, pair)
        before = list(order[: order.index(key)]) if key in order else []
        known = [entry for entry in part.entries if entry.key in before]
        after = known[-1] if known else part.entries[-1]
        return self.insert_lines(after.part.end, [" " * part.column + pair])

    def append(self, keys: Keys, item: dict[str, Any]) -> "ProfileText":
        """Returns the text with a further mapping at the end of a list; in a block, a key a line.

        Raises:
            ProfileError: there is no such list.
        """
        part = find_part(self.layout, keys)
        if not part.is_list:
            raise ProfileError(f"'{format_path(keys)}' is not a list.")
        if part.style == "flow":
            return self._insert_in_flow(part, format_value(item))
        lines = [f"  {key}: {format_value(value)}" for key, value in item.items()]
        lines[0] = f"-{lines[0][1:]}"
        return self.insert_lines(part.end, [" " * part.column + line for line in lines])

    def insert_lines(self, after: int, lines: Sequence[str]) -> "ProfileText":
        """Returns the text with further lines below that of the character ``after``."""
        end = _find_line_end(self.text, after)
        newline = "\r\n" if "\r\n" in self.text else "\n"
        begin = "" if self.text[:end].endswith("\n") else newline
        return self._splice(end, end, begin + newline.join(lines) + newline)

    def remove(self, keys: Keys) -> "ProfileText":
        """Returns the text without a key or an item; what it leaves empty goes too.

        A comment right above an item goes with it if the item is alone under it; above several
        items it stays.

        Raises:
            ProfileError: there is no such place.
        """
        entry = find_entry(self.layout, keys)
        parent = find_part(self.layout, keys[:-1])
        if len(parent.entries) == 1 and len(keys) > 1:
            return self.remove(keys[:-1])
        if parent.style == "flow":
            return self._remove_from_flow(parent, entry)
        begin = _find_line_begin(self.text, entry.begin)
        end = _find_line_end(self.text, entry.part.end)
        if parent.is_list:
            begin = _find_dash(self.text, entry.begin, parent.column)
            return self._splice(_find_comment(self.text, begin, end), end)
        if self.text[begin : entry.begin].strip():  # the first key of an item, beside its dash
            return self._splice(entry.begin, parent.entries[1].begin)
        return self._splice(begin, end)

    def _insert_in_flow(self, part: Part, item: str) -> "ProfileText":
        if not part.entries:
            return self._splice(part.begin + 1, part.end - 1, item)
        end = part.entries[-1].part.end
        return self._splice(end, end, f", {item}")

    def _remove_from_flow(self, parent: Part, entry: Entry) -> "ProfileText":
        i = parent.entries.index(entry)
        if i > 0:
            return self._splice(parent.entries[i - 1].part.end, entry.part.end)
        following = parent.entries[1].begin if len(parent.entries) > 1 else entry.part.end
        return self._splice(entry.begin, following)

    def _splice(self, begin: int, end: int, new: str = "") -> "ProfileText":
        return self.rewrite(self.text[:begin] + new + self.text[end:])


def _find_line_begin(text: str, at: int) -> int:
    return text.rfind("\n", 0, at) + 1


def _find_line_end(text: str, at: int) -> int:
    """Returns the first character of the line below."""
    return text.find("\n", at) + 1 or len(text)


def _find_dash(text: str, at: int, column: int) -> int:
    """Returns the beginning of the line in which an item's dash is."""
    begin = _find_line_begin(text, at)
    while text[begin + column] != "-" or text[begin : begin + column].strip():
        begin = _find_line_begin(text, begin - 1)
    return begin


def _find_comment(text: str, begin: int, end: int) -> int:
    """Returns the beginning of the comment that goes with the lines from ``begin`` to ``end``."""
    below = text[end : _find_line_end(text, end)].strip() if end < len(text) else ""
    if below.startswith("-"):
        return begin
    while begin > 0:
        above = _find_line_begin(text, begin - 1)
        if not text[above:begin].lstrip().startswith("#"):
            break
        begin = above
    return begin
