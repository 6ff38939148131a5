"""Plays the camera of this machine as a program of its own, and prints what came as JSON.

python -m tests.source.davis.player libusb1|pyusb N_EVENTS
"""

import json
import sys
import time
import zlib

import numpy as np

from neurotouch_hid.source.davis import DavisSource
from neurotouch_hid.source.davis.pyusb import PyusbTransport
from neurotouch_hid.source.davis.usb import Usb

PATIENCE_S = 200.0


class Pyusb(Usb):
    """Cameras through the fallback."""

    def open(self, info):
        return PyusbTransport(info.bus, info.address)


def fingerprint(events):
    """The same for the same events, whatever their times."""
    return [zlib.crc32(np.ascontiguousarray(events[name]).tobytes()) for name in ("x", "y", "p")]


def main():
    library, n_events = sys.argv[1], int(sys.argv[2])
    cameras = Pyusb() if library == "pyusb" else Usb()
    packets, n, trouble = [], 0, ""
    deadline = time.monotonic() + PATIENCE_S
    with DavisSource(cameras=cameras, max_delay_us=60_000_000) as source:
        for packet in source.poll():
            if packet is not None:
                packets.append(packet)
                n += len(packet.events)
            trouble = source.stats().trouble
            over = trouble and packet is None  # all that came before has been taken
            if n >= n_events or over or time.monotonic() > deadline:
                break
        stats = source.stats()
    events = np.concatenate([packet.events for packet in packets])
    said = {
        "n_events": n,
        "fingerprint": fingerprint(events),
        "n_frames": sum(len(packet.frames) for packet in packets),
        "gap": sum(packet.gap for packet in packets),
        "n_faults": stats.n_faults,
        "n_connects": stats.n_connects,
        "trouble": trouble,
    }
    print(json.dumps(said))


if __name__ == "__main__":
    main()
