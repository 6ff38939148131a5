r"""The header of an AEDAT4 file: how it is compressed, where its packets are, which streams it has.

A file is ``#!AER-DAT4.0\r\n``, a FlatBuffer ``IOHE`` (compression, position of the table at the end
or -1, an XML text that names the streams), then packets. No text is read that declares names of its
own (a DTD): a few bytes of those can mean gigabytes.
"""

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from xml.etree import ElementTree

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording.compression import COMPRESSIONS
from neurotouch_hid.recording.flatbuffer import FlatTable
from neurotouch_hid.recording.simulation import Simulation, read_simulation

MAGIC: Final = b"#!AER-DAT4.0\r\n"
MAX_HEADER_BYTES: Final = 1 << 18
"""Real ones have 2 to 10 kB."""

_AEDAT: Final = b"#!AER-DAT"
_COMPRESSION, _TABLE, _TEXT = 0, 1, 2


@dataclass(frozen=True, slots=True)
class Stream:
    """One stream of a recording, as the header describes it.

    Attributes:
        kind: ``EVTS``, ``FRME``, or another word of four letters.
        size: width and height in px; None where the header does not say.
    """

    kind: str
    size: tuple[int, int] | None


@dataclass(frozen=True, slots=True)
class Header:
    """The header of a file.

    Attributes:
        begin: where the first packet is.
        compression: of every packet, one of ``COMPRESSIONS``.
        table: where the table at the end is; -1 in a file that was never closed.
        streams: by number, in the order of the text.
        simulation: where simulated data come from; None if they are not marked as simulated.
    """

    begin: int
    compression: int
    table: int
    streams: dict[int, Stream]
    simulation: Simulation | None = None


def parse_header(path: Path, content: bytes) -> Header:
    """Returns the header in the first bytes of a file.

    Args:
        path: the file, for messages.
        content: its first ``MAX_HEADER_BYTES``, or all of a shorter one.

    Raises:
        RecordingError: the file is empty, of another format, or its header is damaged.
    """
    if not content:
        raise RecordingError(f"'{path}' is empty (0 bytes).", hint="Record it again.")
    if not content.startswith(MAGIC):
        raise _refuse_format(path, content[: len(MAGIC)])
    cut = RecordingError(f"'{path}' is cut off inside its header.", hint="Copy or record it again.")
    begin = len(MAGIC) + 4
    if len(content) < begin:
        raise cut
    end = begin + int(struct.unpack_from("<I", content, len(MAGIC))[0])
    if len(content) < end <= MAX_HEADER_BYTES:
        raise cut
    try:
        table = FlatTable(content[begin:end], b"IOHE")
        compression = table.number(_COMPRESSION, "<i")
        if compression not in COMPRESSIONS or end > MAX_HEADER_BYTES:
            raise ValueError("no such compression")
        first, n = table.vector(_TEXT, 1)
        first += begin
        root = _read_text(content[first : first + n].decode("utf-8"))
        position = table.number(_TABLE, "<q", -1)
        return Header(end, compression, position, _read_streams(root), read_simulation(root))
    except ValueError as error:
        raise RecordingError(
            f"'{path}' has a damaged header.", hint="Copy it again from its origin."
        ) from error


def _refuse_format(path: Path, magic: bytes) -> RecordingError:
    if MAGIC.startswith(magic):
        return RecordingError(f"'{path}' is cut off inside its header.", hint="Record it again.")
    version = magic[len(_AEDAT) :].strip()
    if magic.startswith(_AEDAT) and version.replace(b".", b"").isdigit():
        return RecordingError(
            f"'{path}' is an AEDAT {version.decode()} file, not AEDAT4.",
            hint="Convert it to AEDAT4 with the camera maker's software.",
        )
    return RecordingError(f"'{path}' is not an AEDAT4 recording.", hint="Give a file NAME.aedat4.")


def _read_text(text: str) -> ElementTree.Element:
    """Returns the root of the header's text.

    Raises:
        ValueError: it is no XML that we read.
    """
    if "<!DOCTYPE" in text:
        raise ValueError("a DTD")
    try:
        return ElementTree.fromstring(text)  # noqa: S314 - see above
    except ElementTree.ParseError as error:
        raise ValueError(str(error)) from error


def _read_streams(root: ElementTree.Element) -> dict[int, Stream]:
    """Returns what the header's text says of each stream."""
    streams = {}
    for node in root.iterfind("./node[@name='outInfo']/node"):
        size = [_read_attribute(node, f"./node[@name='info']/attr[@key='size{a}']") for a in "XY"]
        streams[int(node.get("name", ""))] = Stream(
            _read_attribute(node, "./attr[@key='typeIdentifier']"),
            (int(size[0]), int(size[1])) if all(size) else None,
        )
    return streams


def _read_attribute(node: ElementTree.Element, path: str) -> str:
    return (node.findtext(path) or "").strip()
