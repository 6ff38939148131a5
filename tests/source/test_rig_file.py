"""Rig files are read whole or refused with the place of the fault."""

import math
import os

import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.geometry import Rig
from neurotouch_hid.source.rig_file import RigFile, load_rig_file, rig_path
from neurotouch_hid.source.strobe.config import StrobeConfig


def load(tmp_path, text):
    path = rig_path(tmp_path / "a.aedat4")
    path.write_text(text)
    return load_rig_file(path)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", RigFile()),
        ("# nothing known\n", RigFile()),
        ("mirrored: true\n", RigFile(None, mirrored=True)),
        ("strobe: {hz: 25, dark_us: 1000}\n", RigFile(strobe=StrobeConfig(25.0, 1_000))),
        ("centre_px: [170, 131.5]\npx_per_mm: 2.4\n", RigFile(Rig((170.0, 131.5), 2.4))),
        (
            "centre_px: [170, 131.5]\npx_per_mm: 3\nrotation_deg: 90\nmirrored: true\n",
            RigFile(Rig((170.0, 131.5), 3.0, math.pi / 2, mirrored=True), mirrored=True),
        ),
    ],
)
def test_good_files(tmp_path, text, expected):
    assert rig_path(tmp_path / "a.aedat4").name == "a.rig.yaml"
    assert load(tmp_path, text) == expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("centre: [1, 2]\n", ":1:1: unknown key centre; did you mean 'centre_px'?"),
        ("zoom: 1\n", ":1:1: unknown key zoom; known are centre_px"),
        ("mirrored: yes please\n", ":1:11: mirrored: expected true or false"),
        ("centre_px: [1, 2]\n", ":1:1: centre_px needs px_per_mm beside it"),
        ("mirrored: true\nrotation_deg: 3\n", ":2:1: rotation_deg needs centre_px beside it"),
        ("px_per_mm: 2.5\ncentre_px: [1, 2, 3]\n", ":2:12: centre_px: expected [x, y]"),
        ("px_per_mm: 2.5\ncentre_px: [1, 260]\n", "within 346×260 pixels, found [1, 260]"),
        ("px_per_mm: .nan\n", ":1:12: px_per_mm: expected a number from 0.5 to 10, found nan"),
        ("px_per_mm: true\n", "found True"),
        ("strobe: 20\n", ":1:9: strobe: expected {hz: 20, dark_us: 1500}, or other numbers"),
        ("strobe: {hz: 60, dark_us: 1500}\n", ":1:9: strobe: expected hz from 5 to 50"),
        ("- 1\n", ":1:1: expected keys with values"),
        ("centre_px: [1, 2\n", ":2:1: "),
        ("mirrored: true\nmirrored: false\n", ":2:1: "),
    ],
)
def test_bad_files(tmp_path, text, words):
    with pytest.raises(RecordingError) as caught:
        load(tmp_path, text)
    assert words in caught.value.message
    assert "?." not in caught.value.message
    assert "\n" not in caught.value.message


def bomb():
    lines = ["a: &a [x, x, x, x, x, x, x, x, x]"]
    for one, other in zip("abcdefgh", "bcdefghi", strict=True):
        lines.append(f"{other}: &{other} [{', '.join([f'*{one}'] * 9)}]")
    return "\n".join([*lines, "centre_px: *i"])


@pytest.mark.parametrize(
    "text",
    [
        bomb(),
        "px_per_mm: 1" + "0" * 400,
        "rotation_deg: -1" + "0" * 400,
        "centre_px: [1" + "0" * 400 + ", 1]\npx_per_mm: 2",
        "centre_px: " + "[" * 900,
        "centre_px: " + "[" * 5000,
        "<<: {px_per_mm: 99}",
        "<<: {foo: 1}",
        "!!omap [a: 1]",
        "px_per_mm: -_",
        "rotation_deg: !!int",
        "rotation_deg:",
        '"\\U99999999": 1',
        "? [a, b]\n: 1",
        "#" + "x" * (20 << 20),
    ],
    ids=range(15),
)
def test_made_to_harm(tmp_path, text):
    with pytest.raises(RecordingError) as caught:
        load(tmp_path, text)
    assert len(caught.value.message) < 500


def test_what_is_no_file(tmp_path):
    path = tmp_path / "a.rig.yaml"
    os.mkfifo(path)
    with pytest.raises(RecordingError, match="it is a pipe, not a file"):
        load_rig_file(path)
    path.unlink()
    path.symlink_to("/dev/zero")
    with pytest.raises(RecordingError, match="it is a device, not a file"):
        load_rig_file(path)
    path.unlink()
    path.write_bytes(b"mirrored: \xff")
    with pytest.raises(RecordingError, match="byte 0xff in line 1 is not UTF-8 text"):
        load_rig_file(path)
