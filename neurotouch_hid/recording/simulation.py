"""The mark of a recording whose data are simulated, as its header keeps it."""

import json
from dataclasses import asdict, dataclass
from typing import Final
from xml.etree import ElementTree

from neurotouch_hid.printable import make_printable

NODE: Final = "simulation"
_COMMENT: Final = "SIMULATED by neurotouch: "
_LONGEST_COMMENT: Final = 16_000
_LONGEST: Final = 1000
"""Limit for one value, in characters: a command line can be long, a header cannot."""


@dataclass(frozen=True, slots=True)
class Simulation:
    """Origin of simulated data.

    Attributes:
        program: name and version of the program that simulated them.
        source: the source, for example ``sim:tour``.
        command: the command line, without folders; empty if a program called the writer.
        seed: seed of the simulator; None if it is unknown.
    """

    program: str
    source: str
    command: str = ""
    seed: int | None = None

    def __str__(self) -> str:
        """Returns the same in words."""
        seed = "an unknown seed" if self.seed is None else f"seed {self.seed}"
        command = f", {self.command}" if self.command else ""
        return f"{self.source}, {seed}, {self.program}{command}"


def format_simulation(mark: Simulation, path: str) -> str:
    """Returns the mark as a node of the header's text.

    Args:
        mark: the mark.
        path: path of the stream's node, in which it stands: the maker's reader takes no other.
    """
    node = ElementTree.Element("node", name=NODE, path=f"{path}{NODE}/")
    for key, value in asdict(mark).items():
        if value is not None:
            attribute = ElementTree.SubElement(node, "attr", key=key, type="string")
            attribute.text = make_printable(str(value)[:_LONGEST])
    return ElementTree.tostring(node, encoding="unicode")


def format_comment(mark: Simulation) -> str:
    """Returns the mark as the comment of a video clip, one line."""
    values = {key: value for key, value in asdict(mark).items() if value is not None}
    return _COMMENT + json.dumps(values)


def parse_comment(text: str) -> Simulation | None:
    """Returns the mark in the comment of a video clip; None if it is another comment."""
    if not text.startswith(_COMMENT) or len(text) > _LONGEST_COMMENT:
        return None
    try:
        values = json.loads(text.removeprefix(_COMMENT))
    except (ValueError, RecursionError):
        values = None
    if not isinstance(values, dict):
        values = {}

    def read(key: str) -> str:
        return make_printable(str(values.get(key, ""))[:_LONGEST].strip())

    seed = values.get("seed")
    is_number = isinstance(seed, int) and not isinstance(seed, bool)
    return Simulation(read("program"), read("source"), read("command"), seed if is_number else None)


def read_simulation(root: ElementTree.Element) -> Simulation | None:
    """Returns the mark in the header's text; None if the data are not marked as simulated."""
    node = root.find(f"./node[@name='outInfo']/node/node[@name='{NODE}']")
    if node is None:
        return None

    def read(key: str) -> str:
        return make_printable((node.findtext(f"./attr[@key='{key}']") or "")[:_LONGEST].strip())

    seed = read("seed")
    return Simulation(
        read("program"),
        read("source"),
        read("command"),
        int(seed) if seed.isascii() and seed.isdigit() else None,
    )
