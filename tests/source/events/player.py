"""Plays the DAVIS of this machine as a program of its own, and writes down what came.

python -m tests.source.events.player own|theirs OUT N_EVENTS N_FRAMES
"""

import sys
import time

import numpy as np

from neurotouch_hid.source.davis import DavisSource
from neurotouch_hid.source.events.source import EventCameraSource

PATIENCE_S = 200.0
QUIET_S = 1.0
DELAY_US = 600_000_000
"""The emulated camera is in a hurry: here old slices are as good as new ones."""
SOURCES = {
    "own": lambda: DavisSource(max_delay_us=DELAY_US),
    "theirs": lambda: EventCameraSource(max_delay_us=DELAY_US),
}


def main():
    who, out, n_events, n_frames = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    packets, n, frames = [], 0, []
    changed_s = begun_s = time.monotonic()
    with SOURCES[who]() as source:
        for packet in source.poll():
            now_s = time.monotonic()
            if packet is not None and (len(packet.events) or packet.frames):
                packets.append(packet)
                n += len(packet.events)
                frames += packet.frames
                changed_s = now_s
            is_all = n >= n_events and len(frames) >= n_frames
            if (is_all and now_s > changed_s + QUIET_S) or now_s > begun_s + PATIENCE_S:
                break
        name = source.name
    np.savez(
        out,
        name=name,
        gap=sum(packet.gap for packet in packets),
        events=np.concatenate([packet.events for packet in packets]),
        times=np.array([(f.exposure_begin_us, f.exposure_end_us) for f in frames]),
        pixels=np.array([f.pixels for f in frames]),
    )


if __name__ == "__main__":
    main()
