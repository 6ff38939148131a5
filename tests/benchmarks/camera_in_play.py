"""Camera's driver and pipeline together: their share of a core, and a dot's event to the pad.

    python -m tests.benchmarks.camera_in_play [SECONDS] [rest]

The simulator's tour, 150,000 events/s and 25 frames/s, becomes the bytes of the emulated camera.
With ``rest`` nobody touches the gel, and the camera sends what it sends then. The driver reads the
bytes through the stand-in for libusb of ``camera.py``, as ``run`` does, and writes a pad in memory.
The stand-in's processor time is told apart. The real libusb and Linux's part of USB are not in the
figures; how many transfers they would handle is. The first second does not count.
"""

import gc
import json
import os
import sys
import tempfile
import time
from array import array
from collections.abc import Iterator
from dataclasses import replace

from neurotouch_hid.driver import REFERENCE, Driver
from neurotouch_hid.evaluation.speed.pace import WARM_S, find_dot_events, summarise_waits
from neurotouch_hid.evaluation.speed.workload import DenseSource, load_scene
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.source.davis import DavisSource
from neurotouch_hid.source.opening import LIVE_US
from neurotouch_hid.source.slice_pacer import MOVING_US
from tests.benchmarks.camera import PLAY, REST, Bench, Pace, build_standin, record

LOOK_STEPS = 16
LEFT_S = 0.2  # the end of the stream does not fill a transfer


def see(scene: str, seconds: float, pace: Pace) -> Iterator[EventPacket]:
    """Yields what the camera sees, with as many frames as it then sends."""
    due_us = 0
    for packet in DenseSource(load_scene(scene, LIVE_US), seconds):
        if packet.frames and packet.t_end_us < due_us:
            yield replace(packet, frames=())
            continue
        if packet.frames:
            due_us = packet.t_end_us + pace.frame_us - LIVE_US
        yield packet


class Meter:
    """A tap that notes the end of each slice, how late it was, and what was used so far.

    Attributes:
        ends_us: end of each slice.
        late_ns: time from it to the write.
        begun, now: sensor time in s, processor time of the user and of the kernel in s, the number
            of steps, the stand-in's processor time in ns, and the number of transfers; at the first
            slice, and at the last that was looked at.
    """

    def __init__(self, bench: Bench) -> None:
        self.ends_us, self.late_ns = array("q"), array("q")
        self.begun = self.now = (0.0, 0.0, 0.0, 0, 0, 0)
        self._bench = bench

    def __call__(self, step: Step) -> None:
        end_us = step.packet.t_end_us
        if end_us < 1e6 * WARM_S:
            return
        self.late_ns.append(time.monotonic_ns() - self._bench.begun_ns - 1_000 * end_us)
        self.ends_us.append(end_us)
        n_steps = len(self.ends_us)
        if n_steps % LOOK_STEPS == 1:  # each look is a few calls of the system
            standin, used = self._bench.standin, os.times()
            counts = standin.standin_used(), standin.standin_transfers()
            self.now = 1e-6 * end_us, used.user, used.system, n_steps, *counts
            if n_steps == 1:
                self.begun = self.now


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    scene, pace = ("rest", REST) if "rest" in sys.argv[2:] else ("tour", PLAY)
    stream = record(see(scene, seconds, pace), seconds, pace)
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench("libusb1", build_standin(folder), stream)
        gc.collect()
        gc.freeze()  # as ``run`` does it
        time.sleep(1.0)  # or Linux makes a real-time thread that has just computed stand still
        meter = Meter(bench)
        with Driver(
            replace(REFERENCE, speed="recorded"),
            make_source=lambda: DavisSource(cameras=bench, slice_us=LIVE_US, part_us=MOVING_US),
        ) as driver:
            driver.run([meter], seconds=seconds - LEFT_S)
    pairs = zip(meter.begun, meter.now, strict=True)
    lasted_s, user_s, system_s, n_steps, standin_ns, n_transfers = (
        after - before for before, after in pairs
    )
    told = {
        "core_percent": round(100 * (user_s + system_s - 1e-9 * standin_ns) / lasted_s, 1),
        "kernel_percent": round(100 * system_s / lasted_s, 1),
        "standin_percent": round(1e-7 * standin_ns / lasted_s, 1),
        "steps_per_s": round(n_steps / lasted_s),
        "transfers_per_s": round(n_transfers / lasted_s),
        "lost_bytes": int(bench.standin.standin_lost()),
    }
    if scene == "tour":
        waits_ms = summarise_waits(find_dot_events(scene, seconds), meter.ends_us, meter.late_ns)
        told["event_ms"] = {name: round(ms, 2) for name, ms in waits_ms.items()}
    print(json.dumps(told))


if __name__ == "__main__":
    main()
