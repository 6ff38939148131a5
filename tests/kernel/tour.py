"""Writes one lap of the simulated tour as a recording: ``python -m tests.kernel.tour FILE``.

The guest is too slow to simulate all of it.
"""

import sys

from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.source import open_source

LAP_US = 18_000_000
"""Pushes to four sides, pinch, zoom, a twist to either side, and the rest after them."""


def main() -> None:
    source = open_source("sim:tour", speed="max")
    with source as packets, RecordingWriter(sys.argv[1]) as writer:
        for packet in packets:
            writer.write(packet)
            if packet.t_end_us >= LAP_US:
                break


main()
