"""The simulated tour of all gestures, recorded once and played again and again.

A driver that simulates it while it plays takes four times as much of the processor, and many tests
only need a hand that plays. It reaches the driver as the source of another package does.
"""

import fcntl
import os
from collections.abc import Iterator
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

from neurotouch_hid.events import shift_packet
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source import open_source

ROOT = Path(__file__).parents[1]
CACHE = ROOT / ".cache/tour"
MADE_BY = ("source/simulator", "recording")
"""Folders of the package that decide what is in the recording."""


def offer_repeated(folder: Path) -> dict[str, str]:
    """Makes the source look installed, in a folder; returns what the environment needs.

    ``repeated:RECORDING`` is its name.
    """
    info = folder / "repeated-1.0.dist-info"
    info.mkdir(parents=True, exist_ok=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: repeated\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[neurotouch.sources]\nrepeated = tests.repeated:Repeated\n"
    )
    return {"PYTHONPATH": f"{ROOT}{os.pathsep}{folder}"}


def find_tour() -> Path:
    """Returns the recording; the first process that asks makes it."""
    CACHE.mkdir(parents=True, exist_ok=True)
    with (CACHE / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        path = CACHE / f"{_find_state()}.aedat4"
        if not path.exists():
            for old in CACHE.glob("*.aedat4"):
                old.unlink()
            from neurotouch_hid.recording import RecordingWriter
            from neurotouch_hid.source.simulator import Simulator, find_scene

            part = path.with_suffix(".part")
            script = replace(find_scene("tour"), endless=False)
            with Simulator(script) as packets, RecordingWriter(part) as writer:
                for packet in packets:
                    writer.write(packet)
            part.rename(path)
        return path


def _find_state() -> str:
    digest = sha256()
    for folder in MADE_BY:
        for path in sorted((ROOT / "neurotouch_hid" / folder).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


class Repeated:
    """A recording that begins again at its end."""

    def __init__(self, rest: str, *, slice_us: int, seed: int) -> None:
        self._source = open_source(f"file:{rest}", slice_us=slice_us, speed="max")
        self.name, self.rig = "repeated:tour", self._source.rig
        self.is_live, self.is_simulated = False, True

    def __iter__(self) -> Iterator[EventPacket]:
        """Yields packets for ever."""
        later_us = 0
        while True:
            for packet in self._source:
                yield shift_packet(packet, later_us)
            later_us += packet.t_end_us

    def close(self) -> None:
        """Closes the recording."""
        self._source.close()
