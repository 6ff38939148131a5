"""Matroska's elements: their names, as RFC 9559 has them, and how one is written."""

from enum import IntEnum
from typing import Final

UNKNOWN_SIZE: Final = b"\x01" + 7 * b"\xff"
"""Size of an element that is not complete yet."""


class Name(IntEnum):
    """Names of the elements that we read or write."""

    EBML = 0x1A45DFA3
    EBML_VERSION = 0x4286
    EBML_READ_VERSION = 0x42F7
    EBML_MAX_ID_LENGTH = 0x42F2
    EBML_MAX_SIZE_LENGTH = 0x42F3
    DOC_TYPE = 0x4282
    DOC_TYPE_VERSION = 0x4287
    DOC_TYPE_READ_VERSION = 0x4285
    VOID = 0xEC
    SEGMENT = 0x18538067
    SEEK_HEAD = 0x114D9B74
    SEEK = 0x4DBB
    SEEK_ID = 0x53AB
    SEEK_POSITION = 0x53AC
    INFO = 0x1549A966
    TIMESTAMP_SCALE = 0x2AD7B1
    DURATION = 0x4489
    MUXING_APP = 0x4D80
    WRITING_APP = 0x5741
    TRACKS = 0x1654AE6B
    TRACK_ENTRY = 0xAE
    TRACK_NUMBER = 0xD7
    TRACK_UID = 0x73C5
    TRACK_TYPE = 0x83
    FLAG_LACING = 0x9C
    CODEC_ID = 0x86
    CODEC_PRIVATE = 0x63A2
    VIDEO = 0xE0
    PIXEL_WIDTH = 0xB0
    PIXEL_HEIGHT = 0xBA
    COLOUR_SPACE = 0x2EB524
    CONTENT_ENCODINGS = 0x6D80
    CONTENT_ENCODING = 0x6240
    CONTENT_COMPRESSION = 0x5034
    CONTENT_COMPRESSION_ALGORITHM = 0x4254
    CONTENT_COMPRESSION_SETTINGS = 0x4255
    TAGS = 0x1254C367
    TAG = 0x7373
    TARGETS = 0x63C0
    SIMPLE_TAG = 0x67C8
    TAG_NAME = 0x45A3
    TAG_STRING = 0x4487
    CLUSTER = 0x1F43B675
    TIMESTAMP = 0xE7
    SIMPLE_BLOCK = 0xA3
    BLOCK_GROUP = 0xA0
    BLOCK = 0xA1


def pack(name: Name, *content: bytes) -> bytes:
    """Returns an element: its name, the size of its content, the content."""
    data = b"".join(content)
    size = (len(data) | 1 << 56).to_bytes(8, "big")
    return pack_name(name) + size + data


def pack_number(name: Name, value: int) -> bytes:
    """Returns an element with a number of 0 or more."""
    return pack(name, value.to_bytes(max((value.bit_length() + 7) // 8, 1), "big"))


def pack_name(name: Name) -> bytes:
    """Returns the bytes of a name."""
    return name.to_bytes((name.bit_length() + 7) // 8, "big")
