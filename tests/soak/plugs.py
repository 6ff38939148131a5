"""Pulls and plugs a camera under a whole driver: ``python -m tests.soak.plugs 1000``.

Each pull comes in the middle of a gesture. The emulated camera is at the end of a cable without a
kernel; the real kernel is in ``tests/kernel`` and ``tests/system``.
"""

import gc
import random
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.driver import Driver, DriverOptions
from neurotouch_hid.messages import EventPacket, GamepadState
from neurotouch_hid.source.davis import DavisSource
from neurotouch_hid.source.simulator import Simulator, StrokeTiming, push, sequence
from tests.source.davis.cable import Cable, emulate
from tests.system.guest.camera import repeat

PATIENCE_S = 60.0
SETTLING_S = 0.5
STROKE = StrokeTiming(attack_us=100_000, hold_us=1_000_000, release_us=100_000)


@dataclass(slots=True)
class Result:
    """What was seen.

    Attributes:
        neutral_s: of each pull, the time until nothing was pressed, to stay.
        play_s: of each plug, the time until the pad moved.
        weights: descriptors, threads and resident kB, after the first plugs and later.
        n_connects: times that the source opened a camera.
    """

    neutral_s: list[float] = field(default_factory=list)
    play_s: list[float] = field(default_factory=list)
    weights: list[tuple[int, int, int]] = field(default_factory=list)
    n_connects: int = 0


class TimedDevice(MemoryDevice):
    """A pad in memory that also records when it was last pushed, and when it was released."""

    def __init__(self, *others: Any) -> None:
        super().__init__(*others)
        self.is_pushed = threading.Event()
        self.released_s = 0.0

    def _show(self, state: GamepadState, *, moved: bool) -> None:
        super()._show(state, moved=moved)
        if not self.states:
            return
        if self.states[-1].is_neutral:
            if self.is_pushed.is_set():
                self.released_s = time.monotonic()
            self.is_pushed.clear()
        else:
            self.is_pushed.set()


def pull_and_plug(n_plugs: int, seed: int = 1, told: Callable[[str], object] = str) -> Result:
    """Plays; plugs a camera in and pulls it in the middle of a gesture, again and again.

    Args:
        n_plugs: how often.
        seed: of the moments.
        told: is told how it goes.
    """
    with Simulator(sequence("a push", push(0.0, 10.0, timing=STROKE), rest_us=200_000)) as source:
        scene = list(source)
    chance, cable, result = random.Random(seed), Cable(), Result()
    pad = TimedDevice()
    options = DriverOptions(profile="spacecraft", device="memory", wait=True, listens=False)
    source = DavisSource(cameras=cable, wait=True)
    with Driver(options, make_source=lambda: source, make_device=lambda *_, **__: pad) as driver:
        playing = threading.Thread(target=driver.run)
        playing.start()
        try:
            for k in range(n_plugs):
                _play_once(scene, cable, pad, chance, result)
                if k % 50 == 2 or k == n_plugs - 1:
                    result.weights.append(_weigh())
                    worst_ms = 1e3 * max(result.neutral_s)
                    told(f"plug {k + 1}: {result.weights[-1]}, neutral after {worst_ms:.0f} ms")
        finally:
            driver.stop()
            playing.join()
        result.n_connects = source.stats().n_connects
    return result


def _play_once(
    scene: list[EventPacket],
    cable: Cable,
    pad: TimedDevice,
    chance: random.Random,
    result: Result,
) -> None:
    plugged_s = time.monotonic()
    cable.plug(emulate(repeat(scene)))
    wait_for(pad.is_pushed.is_set)
    result.play_s.append(time.monotonic() - plugged_s)
    time.sleep(chance.uniform(0.0, 0.3))
    wait_for(pad.is_pushed.is_set)
    pulled_s = time.monotonic()
    cable.unplug()
    time.sleep(SETTLING_S)  # what waits in the queue may still act
    if pad.is_pushed.is_set():
        raise ValueError("something is pressed without a camera")
    result.neutral_s.append(pad.released_s - pulled_s)


def wait_for(condition: Callable[[], bool]) -> None:
    """Waits until the condition is true.

    Raises:
        TimeoutError: it did not become true.
    """
    due_s = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > due_s:
            raise TimeoutError
        time.sleep(0.001)


def _weigh() -> tuple[int, int, int]:
    gc.collect()
    status = Path("/proc/self/status").read_text()
    resident = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    return (
        sum(1 for _ in Path("/proc/self/fd").iterdir()),
        threading.active_count(),
        int(resident.split()[1]),
    )


def main() -> None:
    """Prints the figures."""
    result = pull_and_plug(int(sys.argv[1]), told=lambda line: print(line, flush=True))
    late = sorted(result.neutral_s)
    print(f"{len(late)} plugs, {result.n_connects} times opened")
    print(
        f"neutral after a pull: median {1e3 * median(late):.1f} ms, worst {1e3 * late[-1]:.1f} ms, "
        f"{sum(each > 0.1 for each in late)} above 100 ms"
    )
    slowest = sorted(result.play_s)
    print(f"plays after a plug: median {median(slowest):.2f} s, worst {slowest[-1]:.2f} s")
    shown = result.weights[:: max(1, len(result.weights) // 10)]
    print("descriptors, threads, resident kB:", *shown, result.weights[-1], sep="\n")


if __name__ == "__main__":
    main()
