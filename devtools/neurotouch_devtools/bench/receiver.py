"""Reads a pad as a game does and records the times: ``python -m ... PHYS``.

It runs as a process of its own, because in ours it would wait for the pipeline. It prints
``ready``. When the pad has gone, it prints for each frame the moment of the kernel's stamp and the
moment of reading, both in ns of CLOCK_MONOTONIC.
"""

import fcntl
import os
import struct
import sys
import time
from pathlib import Path
from typing import Final

_INPUT_EVENT: Final = struct.Struct("@llHHi")  # seconds, microseconds, type, code, value
_EVIOCSCLOCKID: Final = 0x400445A0
_SYSTEM: Final = Path("/sys/class/input")
_SEARCH_S: Final = 10.0
_SYN, _SYN_REPORT, _SYN_DROPPED = 0, 0, 3


def find_node(phys: str) -> Path:
    """Returns the event node with this physical path, once it can be read.

    Raises:
        TimeoutError: it does not appear, or this user may not read it.
    """
    deadline = time.monotonic() + _SEARCH_S
    while time.monotonic() < deadline:
        for entry in _SYSTEM.glob("event*"):
            node = Path("/dev/input") / entry.name
            place = entry / "device/phys"
            if place.exists() and place.read_text().strip() == phys and os.access(node, os.R_OK):
                return node
        time.sleep(0.05)  # udev gives the rights some ms after the node
    raise TimeoutError(phys)


def receive(node: Path) -> None:
    """Prints the times of each frame until the node is removed."""
    descriptor = os.open(node, os.O_RDONLY)
    fcntl.ioctl(descriptor, _EVIOCSCLOCKID, struct.pack("@i", time.CLOCK_MONOTONIC))
    print("ready", flush=True)
    frames: list[tuple[int, int]] = []
    lost = False
    try:
        while True:
            data = os.read(descriptor, 64 * _INPUT_EVENT.size)
            at = time.monotonic_ns()
            for seconds, micros, kind, code, _ in _INPUT_EVENT.iter_unpack(data):
                if (kind, code) == (_SYN, _SYN_REPORT):
                    frames.append((seconds * 1_000_000_000 + micros * 1_000, at))
                lost |= (kind, code) == (_SYN, _SYN_DROPPED)
    except OSError:
        pass  # the pad is gone, which is the end
    for stamp, at in frames:
        print(stamp, at)
    if lost:
        sys.exit("the reader was too slow and lost input")


if __name__ == "__main__":
    try:
        receive(find_node(sys.argv[1]))
    except TimeoutError:
        sys.exit(f"no event node of {sys.argv[1]} can be read")
