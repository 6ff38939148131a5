"""YAML 1.2 text as plain values, each with its place; hostile text is refused on the way.

The parser's events are walked once, with limits and without recursion, before anything is built:
an alias bomb, deep nesting or a foreign tag is refused at its first character. Values are what the
YAML 1.2 core schema says, so ``on``, ``off``, ``yes`` and ``no`` stay words.
"""

import re
from dataclasses import dataclass, field
from typing import Any, Final

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
    SequenceEndEvent,
)
from ruamel.yaml.reader import ReaderError

from neurotouch_hid.files.faults import Fault, Keys, Mark, format_path

MAX_DEPTH: Final = 16
MAX_NODES: Final = 5_000
MAX_NUMBER_CHARS: Final = 64

_SURROGATE: Final = re.compile("[\ud800-\udfff]")
_INT: Final = re.compile(r"[-+]?[0-9]+")
_FLOAT: Final = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_SPECIAL: Final[dict[str, Any]] = {
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **{f"{sign}.{word}": float(f"{sign}inf") for sign in ("", "+", "-") for word in ("inf", "Inf")},
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}
_EMPTY: Final = ("", "~", "null", "Null", "NULL")
_NO_LIST: Final = 'write "-" for a minus, or close a "[" before it'
_SYNTAX: Final = (
    ("sequence entries", "a '-' begins a list, which cannot be here", _NO_LIST),
    ("found '-'", "a '-' begins a list, which cannot be here", _NO_LIST),
    ("'\\t'", "a tab cannot indent or begin a value", "use spaces"),
    ("or ']'", "a '[' is opened and not closed before here", "write ']' after the last value"),
    ("or '}'", "a '{' is opened and not closed before here", "write '}' after the last value"),
    ("node content", "a value is missing before here", "write it, and close each '[' and '{'"),
    ("<block end>", "this line is indented otherwise than the lines above", "align them"),
    ("find expected ':'", "a key without ':' and a value", "write 'key: value'"),
    (
        "mapping values",
        "a ':' cannot be here",
        "align the line with those above, or put text that has a ':' in quotes",
    ),
    ("start any token", "a value cannot begin with this character", "put the text in quotes"),
    ("end of stream", "a quote is opened and never closed", "close it"),
    ("unknown escape", "no escape of YAML begins with this character", "double the backslash"),
)
"""Words of the parser's complaint, what it means, and what to do."""


@dataclass(slots=True)
class Node:
    """A value and its place.

    Attributes:
        value: the plain value: dict, list, str, int, float or bool.
        mark: where it is.
        keys: of a mapping: where each key is.
        children: the values in it, by key or index.
    """

    value: Any
    mark: Mark
    keys: dict[str, Mark] = field(default_factory=dict)
    children: dict[str | int, "Node"] = field(default_factory=dict)


class _RefusalError(Exception):
    """The text is refused here and now."""

    def __init__(self, mark: Mark, sentence: str) -> None:
        self.mark = mark
        self.sentence = sentence


def parse_document(text: str) -> tuple[Node | None, list[Fault]]:
    """Returns the one document in the text, and what is wrong with it as YAML.

    Returns:
        The root, or None if the text was refused, and the faults; with a root, the faults are
        repeated keys and missing values.
    """
    builder = _Builder()
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            builder.take(event)
    except _RefusalError as refusal:
        return None, [builder.blame(refusal.mark, refusal.sentence, "", "NT103")]
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = Mark(mark.line, mark.column) if mark else builder.last
        return None, [builder.blame(place, *_explain_syntax(error))]
    except ReaderError as error:
        before = text[: error.position]
        place = Mark(before.count("\n"), len(before) - before.rfind("\n") - 1)
        return None, [
            Fault(
                place,
                "",
                f"the character U+{ord(text[error.position]):04X} is not allowed in YAML",
                code="NT101",
            )
        ]
    except (OverflowError, ValueError):
        # ruamel.yaml hands a \U escape beyond Unicode to chr() unchecked.
        return None, [builder.blame(builder.last, "this escape is no character")]
    if builder.root is None and not builder.faults:
        return None, [Fault(Mark(0, 0), "", "the file is empty", code="NT101")]
    return builder.root, builder.faults


def _explain_syntax(error: MarkedYAMLError) -> tuple[str, str]:
    problem = str(error.problem or error.context or "a mistake that has no name")
    for part, sentence, fix in _SYNTAX:
        if part in problem:
            return sentence, fix
    return f"this is not YAML: {problem}", ""


class _Builder:
    """Builds nodes from events, with its own stack."""

    def __init__(self) -> None:
        self.root: Node | None = None
        self.faults: list[Fault] = []
        self.last = Mark(0, 0)
        self._stack: list[Node] = []
        self._path: list[str | int] = []
        self._key: str | None = None
        self._key_mark = self.last
        self._n_nodes = 0
        self._n_documents = 0

    def blame(self, mark: Mark, sentence: str, hint: str = "", code: str = "NT102") -> Fault:
        """Returns a fault at the place the walk has reached."""
        return Fault(mark, format_path(self._path), sentence, hint, code)

    def take(self, event: Event) -> None:
        """Processes one event.

        Raises:
            _RefusalError: the text goes beyond what a file of settings may be.
        """
        mark = self.last = _mark(event)
        if isinstance(event, DocumentStartEvent):
            self._n_documents += 1
            if self._n_documents > 1:
                raise _RefusalError(mark, "a second document begins here, and only one is allowed")
            if event.version or event.tags:
                raise _RefusalError(mark, "directives (%) are not allowed")
        elif isinstance(event, MappingEndEvent | SequenceEndEvent):
            self._close()
        elif isinstance(event, NodeEvent):
            self._check(event, mark)
            if self._expects_key():
                self._take_key(event, mark)
            else:
                self._take_value(event, mark)

    def _check(self, event: NodeEvent, mark: Mark) -> None:
        self._n_nodes += 1
        if self._n_nodes > MAX_NODES:
            raise _RefusalError(mark, f"more than {MAX_NODES} values are not allowed")
        if isinstance(event, AliasEvent) or event.anchor is not None:
            raise _RefusalError(mark, "anchors (&) and aliases (*) are not allowed")
        if getattr(event, "tag", None) is not None:
            raise _RefusalError(mark, "tags (!) are not allowed")
        if isinstance(event, ScalarEvent) and _SURROGATE.search(str(event.value)):
            raise _RefusalError(mark, "this escape is half a character")

    def _expects_key(self) -> bool:
        return bool(self._stack) and isinstance(self._stack[-1].value, dict) and self._key is None

    def _take_key(self, event: NodeEvent, mark: Mark) -> None:
        if not isinstance(event, ScalarEvent):
            raise _RefusalError(mark, "a key must be a word")
        self._key, self._key_mark = str(event.value), mark
        self._path.append(self._key)
        first = self._stack[-1].keys.setdefault(self._key, mark)
        if first is not mark:
            where = f"line {first.line + 1}, column {first.column + 1}"
            self.faults.append(self.blame(mark, f"this key is already in {where}", code="NT104"))

    def _take_value(self, event: NodeEvent, mark: Mark) -> None:
        parent = self._stack[-1] if self._stack else None
        if event.start_mark.index == event.end_mark.index and self._key is not None:
            mark = self._key_mark  # nothing is there: show the key
        if parent is not None and isinstance(parent.value, list):
            self._path.append(len(parent.value))
        node = Node(self._make_value(event, mark), mark)
        if parent is None:
            self.root = node
        elif isinstance(parent.value, list):
            parent.children[len(parent.value)] = node
            parent.value.append(node.value)
        elif self._key is not None:
            parent.children.setdefault(self._key, node)
            parent.value.setdefault(self._key, node.value)
        self._key = None
        if isinstance(event, ScalarEvent):
            self._leave()
            return
        self._stack.append(node)
        if len(self._stack) > MAX_DEPTH:
            raise _RefusalError(mark, f"more than {MAX_DEPTH} levels are not allowed")

    def _make_value(self, event: NodeEvent, mark: Mark) -> Any:
        if isinstance(event, MappingStartEvent):
            return {}
        if not isinstance(event, ScalarEvent):
            return []
        text = str(event.value)
        if not event.implicit[0]:
            return text
        if text in _EMPTY:
            self.faults.append(self.blame(mark, "a value is missing here", code="NT105"))
        return _resolve(text, mark)

    def _close(self) -> None:
        self._stack.pop()
        self._leave()

    def _leave(self) -> None:
        if self._path:
            self._path.pop()


def _mark(event: Event) -> Mark:
    start, end = event.start_mark, event.end_mark
    length = end.column - start.column if end.line == start.line else 10_000
    return Mark(start.line, start.column, max(1, length))


def _resolve(text: str, mark: Mark) -> Any:
    """Returns a plain scalar by the YAML 1.2 core schema, decimal numbers only."""
    is_int = _INT.fullmatch(text)
    if is_int or _FLOAT.fullmatch(text):
        if len(text) > MAX_NUMBER_CHARS:
            raise _RefusalError(mark, f"a number has at most {MAX_NUMBER_CHARS} characters")
        return int(text) if is_int else float(text)
    return _SPECIAL.get(text, text)


def find_node(root: Node, keys: Keys) -> tuple[Node, bool]:
    """Returns the node the keys lead to, or the last one on the way, and whether it was reached."""
    node = root
    for key in keys:
        if key not in node.children:
            return node, False
        node = node.children[key]
    return node, True


def find_mark(root: Node, keys: Keys) -> Mark:
    """Returns the value's place; of a mapping or list in block style, its key's."""
    node, found = find_node(root, keys)
    if found and not isinstance(node.value, dict | list):
        return node.mark
    return find_key_mark(root, keys)


def find_key_mark(root: Node, keys: Keys) -> Mark:
    """Returns the place of the last key, or of the last one on its path that is there."""
    while keys:
        parent, _ = find_node(root, keys[:-1])
        if isinstance(keys[-1], str) and keys[-1] in parent.keys:
            return parent.keys[keys[-1]]
        node, found = find_node(root, keys)
        if found:
            return node.mark
        keys = keys[:-1]
    return root.mark
