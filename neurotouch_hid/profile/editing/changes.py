"""Edits of a text at exactly one place; comments, order and layout of all else stay.

Every function takes a text and gives a new one.
"""

from collections.abc import Sequence
from typing import Any

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import Keys, format_path
from neurotouch_hid.profile.editing.layout import Entry, Part, find_entry, find_part, read_layout
from neurotouch_hid.profile.editing.values import format_value


def replace_value(text: str, keys: Keys, value: Any) -> str:
    """Returns the text with another value at a place; a quoted word stays quoted in the same way.

    Raises:
        ProfileError: there is no such place.
    """
    entry = find_entry(_read(text), keys)
    part = entry.part
    if part.style in ("'", '"') and isinstance(value, str):
        quoted = format_value(f"{value}:", part.style)  # the colon calls for quotes
        return text[: part.begin] + quoted[:-2] + quoted[-1] + text[part.end :]
    if part.style == "block" and isinstance(entry.key, str):
        colon = text.index(":", entry.key_end) + 1
        return text[:colon] + " " + format_value(value) + text[part.end :]
    return text[: part.begin] + format_value(value) + text[part.end :]


def insert_key(text: str, keys: Keys, key: str, value: Any, order: Sequence[str] = ()) -> str:
    """Returns the text with a further key in a mapping.

    Args:
        text: the text.
        keys: the way to the mapping; empty for the whole document.
        key: the new key.
        value: its value.
        order: how the keys of a block follow one another; by default the new one comes last.

    Raises:
        ProfileError: there is no such mapping.
    """
    part = find_part(_read(text), keys)
    pair = f"{format_value(key)}: {format_value(value)}"
    if part.is_list or part.style not in ("flow", "block"):
        raise ProfileError(f"'{format_path(keys)}' has no keys.")
    if part.style == "flow":
        return _insert_in_flow(text, part, pair)
    before = list(order[: order.index(key)]) if key in order else []
    known = [entry for entry in part.entries if entry.key in before]
    after = known[-1] if known else part.entries[-1]
    return _insert_line(text, after.part.end, " " * part.column + pair)


def append_item(text: str, keys: Keys, value: dict[str, Any]) -> str:
    """Returns the text with a further mapping at the end of a list; in a block list, a key a line.

    Raises:
        ProfileError: there is no such list.
    """
    part = find_part(_read(text), keys)
    if not part.is_list:
        raise ProfileError(f"'{format_path(keys)}' is not a list.")
    if part.style == "flow":
        return _insert_in_flow(text, part, format_value(value))
    dash = " " * part.column + "-"
    lines = [f"{key}: {format_value(inner)}" for key, inner in value.items()]
    block = f"{dash} " + ("\n" + " " * (len(dash) + 1)).join(lines)
    return _insert_line(text, part.end, block)


def insert_lines(text: str, after: int, lines: Sequence[str]) -> str:
    """Returns the text with further lines below the one in which the character ``after`` is."""
    return _insert_line(text, after, "\n".join(lines))


def remove_value(text: str, keys: Keys) -> str:
    """Returns the text without a key or an item; what it leaves empty goes too.

    A comment right above an item goes with it if the item is alone under it; above several
    items it stays.

    Raises:
        ProfileError: there is no such place.
    """
    root = _read(text)
    entry = find_entry(root, keys)
    parent = find_part(root, keys[:-1])
    if len(parent.entries) == 1 and len(keys) > 1:
        return remove_value(text, keys[:-1])
    if parent.style == "flow":
        return _remove_from_flow(text, parent, entry)
    begin, end = _find_line_begin(text, entry.begin), _find_line_end(text, entry.part.end)
    if parent.is_list:
        begin = _find_dash(text, entry.begin, parent.column)
        return text[: _find_comment(text, begin, end)] + text[end:]
    if text[begin : entry.begin].strip():  # the first key of an item, beside its dash
        following = parent.entries[1]
        return text[: entry.begin] + text[following.begin :]
    return text[:begin] + text[end:]


def _read(text: str) -> Part:
    return read_layout(text, "the text")[0]


def _insert_in_flow(text: str, part: Part, item: str) -> str:
    if not part.entries:
        return text[: part.begin + 1] + item + text[part.end - 1 :]
    end = part.entries[-1].part.end
    return f"{text[:end]}, {item}{text[end:]}"


def _remove_from_flow(text: str, parent: Part, entry: Entry) -> str:
    i = parent.entries.index(entry)
    if i > 0:
        return text[: parent.entries[i - 1].part.end] + text[entry.part.end :]
    if len(parent.entries) > 1:
        return text[: entry.begin] + text[parent.entries[1].begin :]
    return text[: entry.begin] + text[entry.part.end :]


def _insert_line(text: str, after: int, line: str) -> str:
    """Returns the text with a line below that of ``after``, with the same line ending."""
    end = _find_line_end(text, after)
    newline = "\r\n" if "\r\n" in text else "\n"
    line = line.replace("\n", newline)
    if not text[:end].endswith("\n"):
        return text[:end] + newline + line + newline
    return text[:end] + line + newline + text[end:]


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
    """Returns where the comment begins that goes with the lines from ``begin`` to ``end``."""
    below = text[end : _find_line_end(text, end)].strip() if end < len(text) else ""
    if below.startswith("-"):
        return begin
    while begin > 0:
        above = _find_line_begin(text, begin - 1)
        if not text[above:begin].lstrip().startswith("#"):
            break
        begin = above
    return begin
