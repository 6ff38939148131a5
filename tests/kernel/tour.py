"""Writes a short simulated tour of all gestures: ``python -m tests.kernel.tour RECORDING``.

The slow guest only plays it. (Ending the driver is tested with the simulator in the guest.)
"""

import math
import sys

from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.source.simulator import (
    Fingertips,
    Simulator,
    StrokeTiming,
    pinch,
    push,
    sequence,
    twist,
    zoom,
)

TIMING = StrokeTiming(attack_us=200_000, hold_us=150_000, release_us=200_000)

STROKES = (
    push(0.0, 10.0, timing=TIMING),
    push(math.pi, 10.0, timing=TIMING),
    push(math.pi / 2, 10.0, timing=TIMING),
    push(-math.pi / 2, 10.0, timing=TIMING),
    pinch(7.0, timing=TIMING),
    zoom(6.0, Fingertips(spread_mm=8.0), timing=TIMING),
    twist(0.6, timing=TIMING),
    twist(-0.6, timing=TIMING),
)


def main() -> None:
    script = sequence("every gesture", *STROKES, rest_us=400_000, gap_us=0)
    with Simulator(script) as packets, RecordingWriter(sys.argv[1]) as writer:
        for packet in packets:
            writer.write(packet)


main()
