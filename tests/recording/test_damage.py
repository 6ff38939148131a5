"""Damaged files end in a RecordingError: never an abort, a hang or a word from a library."""

import subprocess
import sys
from pathlib import Path

import pytest

from neurotouch_hid.recording import RecordingWriter
from tests.recording import read_damaged
from tests.recording.streams import make_packets


def faults(original, tmp_path, n_cuts, n_flips):
    done = subprocess.run(
        [sys.executable, read_damaged.__file__, original, tmp_path / "x.aedat4"]
        + [str(n) for n in (n_cuts, n_flips)],
        capture_output=True,
        text=True,
        timeout=900,
        check=False,
        cwd=Path(__file__).parents[2],
    )
    assert done.stderr == ""
    assert done.returncode == 0
    return done.stdout.splitlines()


@pytest.mark.parametrize("n_events", [400, 4_000])
def test_damaged_copies(tmp_path, n_events):
    with RecordingWriter(tmp_path / "a.aedat4") as writer:
        for packet in make_packets(n_events)[:5]:
            writer.write(packet)
    assert faults(tmp_path / "a.aedat4", tmp_path, 200, 150) == ["done"]


def test_damaged_copies_of_a_real_file(sample, tmp_path):
    assert faults(sample, tmp_path, 100, 60) == ["done"]
