"""Makes click's help texts fit the page of commands: examples become code, marks are escaped."""

import re
from collections.abc import Iterator

from sphinx.application import Sphinx


def show_examples(_app: Sphinx, _context: object, lines: list[str]) -> None:
    """Changes the lines of an epilog in place, as Sphinx has it for its hooks.

    Args:
        lines: what click would print below the options, each with a bar before it.
    """
    lines[:] = list(_as_blocks(line.removeprefix("| ").rstrip() for line in lines))


def escape_marks(_app: Sphinx, _context: object, lines: list[str]) -> None:
    """Escapes, in place, what click prints as it is and reStructuredText would read as a mark."""
    lines[:] = [line if line.lstrip().startswith("..") else _escape(line) for line in lines]


def _escape(line: str) -> str:
    """Escapes emphasis, links such as ``file:NAME`` and the dashes of options."""
    return re.sub(r"\*|(?<=file):|-(?=-)|(?<=-)-", r"\\\g<0>", line)


def _as_blocks(lines: Iterator[str]) -> Iterator[str]:
    inside = False
    for line in lines:
        if line.startswith(" ") and not inside:
            yield from ("", ".. code-block:: text", "")
        elif inside and line and not line.startswith(" "):
            yield ""
        inside = line.startswith(" ") or (inside and not line)
        yield f"   {line.strip()}" if inside else line


def setup(app: Sphinx) -> dict[str, bool]:
    """Listens to sphinx-click, which has one event for each part of a help text."""
    app.setup_extension("sphinx_click")
    app.connect("sphinx-click-process-epilog", show_examples)
    for part in ("description", "options", "arguments"):
        app.connect(f"sphinx-click-process-{part}", escape_marks)
    return {"parallel_read_safe": True}
