"""How long a game waits when it shakes the pad: ``python -m tests.benchmarks.rumble [SECONDS]``.

Another process asks as the kernel does; a pipe stands in the kernel's place, so this needs no
right. Meanwhile the process that answers plays the line at 250 slices and a million events a
second, loads profiles, or does what is worst: computes in Python nearly without end. ``chrt -f 1``
in front leaves other programs out of it.
"""

import ctypes
import os
import random
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable

import numpy as np

from neurotouch_hid.device import open_device
from neurotouch_hid.device.outputs import rumble as served
from neurotouch_hid.evaluation.speed.workload import DenseSource, load_scene
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.process.realtime import SWITCH_S
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline, warm_up
from neurotouch_hid.source.pacing import PacedSource

EVENT = struct.Struct("@llHHi")
EV_UINPUT, UI_FF_UPLOAD = 0x0101, 1
END_UPLOAD = 201
"""The number of the last ioctl of an answer, which lets the game go on."""


class Pipe:
    """The kernel's part: hands requests over and notes when each is answered."""

    def __init__(self) -> None:
        self.waited_ms: list[float] = []
        self._asked_ns: dict[int, int] = {}

    def read(self, descriptor: int, data: ctypes.Array, size: int) -> int:
        """The requests; the moment of each stands where the kernel's own stands."""
        n = served.LIBC.read(descriptor, data, size)
        for seconds, nanos, _, _, request in EVENT.iter_unpack(bytes(data)[: max(n, 0)]):
            self._asked_ns[request] = seconds * 1_000_000_000 + nanos
        return n

    def ioctl(self, _descriptor: int, number: int, argument: ctypes.Structure) -> int:
        """An effect of nothing but zeros, and the end of the game's wait."""
        if number & 0xFF == END_UPLOAD:
            asked_ns = self._asked_ns.pop(argument._obj.request_id)
            self.waited_ms.append((time.monotonic_ns() - asked_ns) / 1e6)
        return 0


def ask(descriptor: int, seconds: float) -> None:
    """The game: asks at moments that nobody foresees."""
    rng = random.Random(0)
    end, request = time.monotonic() + seconds, 0
    while time.monotonic() < end:
        time.sleep(rng.uniform(0.004, 0.03))
        request += 1
        moment = divmod(time.monotonic_ns(), 1_000_000_000)
        os.write(descriptor, EVENT.pack(*moment, EV_UINPUT, UI_FF_UPLOAD, request))


def measure(seconds: float, *loads: Callable[[threading.Event], object]) -> list[float]:
    """How long each request waited, in ms, while the loads run."""
    reading, writing = os.pipe()
    os.set_inheritable(writing, True)
    pipe, stop = Pipe(), threading.Event()
    server = served.RumbleServer(reading, lambda _: None, pipe)
    threads = [threading.Thread(target=load, args=(stop,)) for load in loads]
    for thread in threads:
        thread.start()
    time.sleep(1.0)
    command = [sys.executable, "-m", "tests.benchmarks.rumble", str(seconds), str(writing)]
    subprocess.run(command, check=True, close_fds=False)
    stop.set()
    for thread in threads:
        thread.join()
    server.close()
    os.close(reading)
    os.close(writing)
    return pipe.waited_ms


def main(seconds: float) -> None:
    """Measures each load and prints a line for it."""
    profile = load_profile("default")
    scene = load_scene("tour", 4_000)
    sys.setswitchinterval(SWITCH_S)
    warm_up(Pipeline.build(profile, GestureConfig()))

    def play(stop: threading.Event) -> None:
        source = PacedSource(DenseSource(scene, 2 * seconds + 10, 1e6))
        line = Pipeline.build(profile, GestureConfig(), frame_thread=True)
        with open_device("memory") as device:
            run_pipeline(source, line, device, stop=stop)

    def load(stop: threading.Event) -> None:
        while not stop.wait(0.1):
            load_profile("default")

    def compute(stop: threading.Event) -> None:
        while not stop.wait(0.01):  # or Linux makes everybody wait, see sched(7) on chrt
            end = time.monotonic() + 0.1
            while time.monotonic() < end:
                sum(range(1000))

    measure(2.0, play)  # what is loaded late is loaded now
    cases = {"alone": (), "line": (play,), "line and profiles": (play, load), "Python": (compute,)}
    for name, loads in cases.items():
        waited = measure(seconds, *loads)
        p50, p99 = np.percentile(waited, [50, 99])
        print(f"{name:18} {len(waited)} median {p50:.2f} p99 {p99:.2f} worst {max(waited):.2f} ms")


if __name__ == "__main__":
    if len(sys.argv) > 2:
        ask(int(sys.argv[2]), float(sys.argv[1]))
    else:
        main(float(sys.argv[1]) if len(sys.argv) > 1 else 10.0)
