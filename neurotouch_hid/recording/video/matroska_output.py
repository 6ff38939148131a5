"""The bytes of a Matroska file with one track, whose stamps are in µs.

FFmpeg's own writer of this format rounds to milliseconds.
"""

import struct
from typing import Final, NamedTuple

from neurotouch_hid import __version__
from neurotouch_hid.recording.video.ebml import UNKNOWN_SIZE, Name, pack, pack_name, pack_number

_BLOCK_HEAD: Final = b"\x81" + struct.pack(">h", 0) + b"\x80"  # track 1, a key frame
_VERSIONS: Final = {
    Name.EBML_VERSION: 1,
    Name.EBML_READ_VERSION: 1,
    Name.EBML_MAX_ID_LENGTH: 4,
    Name.EBML_MAX_SIZE_LENGTH: 8,
    Name.DOC_TYPE_VERSION: 4,
    Name.DOC_TYPE_READ_VERSION: 2,
}


class MatroskaHead(NamedTuple):
    """Everything before the first picture.

    Attributes:
        data: the bytes.
        segment_at: where the size of all that follows is; it says that it is unknown.
        duration_at: where the duration is, a double in µs; 0.
    """

    data: bytes
    segment_at: int
    duration_at: int


def make_head(
    codec: bytes, width_px: int, height_px: int, private: bytes = b"", comment: str = ""
) -> MatroskaHead:
    """Returns the head of a file.

    Args:
        codec: as Matroska names it, for example ``V_MJPEG``.
        width_px: of the pictures.
        height_px: of the pictures.
        private: what the decoder must know.
        comment: the comment of the file; none if it is empty.
    """
    numbers = (pack_number(name, value) for name, value in _VERSIONS.items())
    head = pack(Name.EBML, *numbers, pack(Name.DOC_TYPE, b"matroska"))
    head += pack_name(Name.SEGMENT)
    segment_at = len(head)
    program = f"neurotouch-hid {__version__}".encode()
    head += UNKNOWN_SIZE + pack(
        Name.INFO,
        pack_number(Name.TIMESTAMP_SCALE, 1000),
        pack(Name.MUXING_APP, program),
        pack(Name.WRITING_APP, program),
        pack(Name.DURATION, struct.pack(">d", 0.0)),
    )
    duration_at = len(head) - 8
    size = pack_number(Name.PIXEL_WIDTH, width_px), pack_number(Name.PIXEL_HEIGHT, height_px)
    track = [
        pack_number(Name.TRACK_NUMBER, 1),
        pack_number(Name.TRACK_UID, 1),
        pack_number(Name.TRACK_TYPE, 1),
        pack_number(Name.FLAG_LACING, 0),
        pack(Name.CODEC_ID, codec),
        pack(Name.VIDEO, *size),
    ]
    if private:
        track.append(pack(Name.CODEC_PRIVATE, private))
    head += pack(Name.TRACKS, pack(Name.TRACK_ENTRY, *track))
    if comment:
        simple = pack(Name.TAG_NAME, b"COMMENT") + pack(Name.TAG_STRING, comment.encode())
        head += pack(Name.TAGS, pack(Name.TAG, pack(Name.TARGETS), pack(Name.SIMPLE_TAG, simple)))
    return MatroskaHead(head, segment_at, duration_at)


def make_cluster(t_us: int, content: bytes) -> bytes:
    """Returns the cluster of one picture, which can be read without any other."""
    block = pack(Name.SIMPLE_BLOCK, _BLOCK_HEAD, content)
    return pack(Name.CLUSTER, pack_number(Name.TIMESTAMP, t_us), block)
