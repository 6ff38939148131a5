"""Grey pictures of each format; a damaged JPEG is no picture."""

import cv2
import numpy as np
import pytest

from neurotouch_hid.source.video.capture import PictureFormat
from neurotouch_hid.source.video.formats import KNOWN, GreyReader

WIDTH, HEIGHT = 320, 240
GREY = np.add.outer(np.arange(HEIGHT), np.arange(WIDTH)).astype(np.uint8)
SMOOTH = cv2.GaussianBlur(
    np.random.default_rng(1).integers(0, 256, (HEIGHT, WIDTH)).astype(np.uint8), None, 4
)
PADDING = 32


def pack(fourcc, padding=0):
    """The bytes of GREY, with some bytes after each row."""
    if fourcc in ("YUYV", "UYVY"):
        planes = [GREY, np.full_like(GREY, 77)]
        rows = np.stack(planes if fourcc == "YUYV" else planes[::-1], axis=-1).reshape(HEIGHT, -1)
    else:
        rows = GREY
    rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=99)
    colours = b"" if fourcc == "GREY" else bytes([128]) * (rows.size // 2)
    return np.frombuffer(rows.tobytes() + colours, np.uint8), rows.shape[1]


@pytest.mark.parametrize("padding", [0, PADDING])
@pytest.mark.parametrize("fourcc", [code for code in KNOWN if code not in ("MJPG", "JPEG")])
def test_uncompressed_pictures_are_read_exactly(fourcc, padding):
    data, stride = pack(fourcc, padding)
    reader = GreyReader(PictureFormat(fourcc, WIDTH, HEIGHT, stride))
    grey = reader.read(data)
    assert (grey == GREY).all()
    assert reader.read(data) is grey  # no memory is taken for another picture
    assert reader.read(data[: stride * (HEIGHT - 1)]) is None


def test_a_stride_of_zero_means_rows_without_padding():
    data, _ = pack("GREY")
    assert (GreyReader(PictureFormat("GREY", WIDTH, HEIGHT, 0)).read(data) == GREY).all()


def read_jpeg(data):
    reader = GreyReader(PictureFormat("MJPG", WIDTH, HEIGHT, 0))
    return reader.read(np.frombuffer(data, np.uint8))


def encode(picture, *options):
    return cv2.imencode(".jpg", picture, list(options))[1].tobytes()


def test_compressed_pictures_are_read_with_colours_padding_and_progressive_ones():
    whole = encode(SMOOTH)
    for data in (
        whole,
        whole + bytes(40),
        encode(cv2.cvtColor(SMOOTH, cv2.COLOR_GRAY2BGR)),
        encode(SMOOTH, cv2.IMWRITE_JPEG_PROGRESSIVE, 1),
    ):
        assert np.abs(read_jpeg(data).astype(int) - SMOOTH).mean() < 2


def test_a_damaged_jpeg_is_no_picture():
    whole = encode(SMOOTH)
    huge = bytearray(whole)
    at = huge.index(b"\xff\xc0")
    huge[at + 5 : at + 9] = b"\xff\xff\xff\xff"
    for data in (
        b"",
        b"\xff\xd8",
        whole[: len(whole) // 2],
        whole[2:],
        b"\xff\xd8" + bytes(1000) + b"\xff\xd9",
        b"\xff\xd8\xff\xe0\x00\x00" + bytes(1000) + b"\xff\xd9",
        bytes(huge),
        encode(SMOOTH[:100]),
        b"BM" + whole,
    ):
        assert read_jpeg(data) is None
