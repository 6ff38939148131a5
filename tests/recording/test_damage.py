"""Damaged copies of whole files end in a RecordingError; damage inside packets is in tests/fuzz."""

import random

import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording import Recording, RecordingWriter
from tests.recording.streams import make_packets


def damage(data, n):
    """Gives copies that are cut off, then copies with one bit flipped."""
    chance = random.Random(4)
    header = data.index(b"</dv>") + 60
    cuts = {0, 1, 13, 14, 17, 18, 40, 100, header, len(data) - 1}
    for cut in sorted(cuts | {chance.randrange(len(data)) for _ in range(n)}):
        yield data[:cut]
    places = [*range(14, 100), *(chance.randrange(size) for size in (header, len(data)) * n)]
    for place in places:
        flipped = bytearray(data)
        flipped[place] ^= 1 << chance.randrange(8)
        yield bytes(flipped)


def read_all(path, contents):
    refused = 0
    for content in contents:
        path.write_bytes(content)
        try:
            list(Recording(path))
        except RecordingError:
            refused += 1
    return refused


@pytest.mark.parametrize("n_events", [400, 4_000])
def test_damaged_copies(tmp_path, n_events):
    with RecordingWriter(tmp_path / "a.aedat4") as writer:
        for packet in make_packets(n_events)[:5]:
            writer.write(packet)
    data = (tmp_path / "a.aedat4").read_bytes()
    assert read_all(tmp_path / "x.aedat4", damage(data, 150)) > 150


def test_damaged_copies_of_a_real_file(sample, tmp_path):
    assert read_all(tmp_path / "x.aedat4", damage(sample.read_bytes(), 60)) > 60
