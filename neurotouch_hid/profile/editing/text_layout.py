"""Finds the characters of every value in a text, so that an edit touches nothing else."""

from dataclasses import dataclass
from typing import Any, Final, Literal

from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode, SequenceNode

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import Keys, format_path

Style = Literal["plain", "'", '"', "flow", "block"]
_QUOTES: Final[dict[str | None, Style]] = {"'": "'", '"': '"'}


@dataclass(frozen=True, slots=True)
class Part:
    """A value in the text.

    Attributes:
        begin: its first character.
        end: the character after its last; of a block, after its last value.
        column: where its first character is in its line; of a block list, the dash.
        style: how it is written.
        is_list: true of a list.
        entries: the values in it.
    """

    begin: int
    end: int
    column: int
    style: Style
    is_list: bool = False
    entries: tuple["Entry", ...] = ()


@dataclass(frozen=True, slots=True)
class Entry:
    """A value in a mapping or a list.

    Attributes:
        key: its key or its index.
        begin: where the key begins; in a list, where the value does.
        key_end: the character after the key; in a list as ``begin``.
        part: the value.
    """

    key: str | int
    begin: int
    key_end: int
    part: Part


def read_layout(text: str) -> Part:
    """Returns the layout of a text that ``parse_document`` has accepted."""
    return _make_part(YAML(typ="safe", pure=True).compose(text), text)


def find_entry(root: Part, keys: Keys) -> Entry:
    """Returns the entry at the end of a path of keys.

    Raises:
        ProfileError: there is none.
    """
    part, entry = root, None
    for i, key in enumerate(keys):
        entry = next((entry for entry in part.entries if entry.key == key), None)
        if entry is None:
            raise ProfileError(f"There is no '{format_path(keys[: i + 1])}'.")
        part = entry.part
    if entry is None:
        raise ProfileError("The path of a value has at least one key.")
    return entry


def find_part(root: Part, keys: Keys) -> Part:
    """Returns the value at the end of the way; the whole document for an empty one.

    Raises:
        ProfileError: there is none.
    """
    return find_entry(root, keys).part if keys else root


def _make_part(node: Any, text: str) -> Part:  # at most document.MAX_DEPTH deep
    begin, end, column = node.start_mark.index, node.end_mark.index, node.start_mark.column
    is_list = isinstance(node, SequenceNode)
    entries: list[Entry] = []
    if isinstance(node, MappingNode):
        for key, value in node.value:
            part = _make_part(value, text)
            entries.append(Entry(str(key.value), key.start_mark.index, key.end_mark.index, part))
    elif is_list:
        for i, value in enumerate(node.value):
            part = _make_part(value, text)
            entries.append(Entry(i, part.begin, part.begin, part))
    else:
        end = begin + len(text[begin:end].rstrip())
        return Part(begin, end, column, _QUOTES.get(node.style, "plain"))
    if node.flow_style:
        return Part(begin, end, column, "flow", is_list, tuple(entries))
    return Part(begin, entries[-1].part.end, column, "block", is_list, tuple(entries))
