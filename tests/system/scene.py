"""Writes what the emulated camera sees: ``python -m tests.system.scene RECORDING``.

Again and again a push to the right. The camera shows it in slow motion, so that there is time to
pull the cable.
"""

import sys

from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.source.simulator import Simulator, StrokeTiming, push, sequence

QUICK = StrokeTiming(attack_us=150_000, hold_us=500_000, release_us=150_000)


def main() -> None:
    script = sequence("a push", push(0.0, 10.0, timing=QUICK), rest_us=250_000, gap_us=0)
    with Simulator(script) as packets, RecordingWriter(sys.argv[1]) as writer:
        for packet in packets:
            writer.write(packet)


main()
