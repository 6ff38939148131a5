"""What listeners cost the driver: ``python -m tests.benchmarks.stream [PAIRS] [SECONDS]``.

One driver plays in real time. Periods without a listener and with three take turns: ``neurotouch
stream`` by OSC, by WebSocket with a reader, and one that is stopped and reads nothing any more.
Prints the time from the last event of a slice to the write to the pad, without and with them, and
the difference in each pair of periods, for the machine is never quiet for long.
"""

import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace

import numpy as np

from neurotouch_hid.driver import REFERENCE, Driver
from neurotouch_hid.evaluation.speed.pace import Probe, choose_device
from neurotouch_hid.evaluation.speed.workload import DenseSource, load_scene
from neurotouch_hid.source.pacing import PacedSource

SLICE_US = 4_000
EVENTS_PER_S = 1e6
SETTLE_S = 1.0
LIMIT_S = 120.0
READER = """
import sys
from websockets.sync.client import connect
with connect(sys.argv[1]) as line:
    for state in line:
        print("heard", flush=True) if not sys.stdout.closed else None
        break
    for state in line:
        pass
"""


def main() -> None:
    pairs = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 10.0
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_RUNTIME_DIR"] = folder
        # Long enough; the last period ends it.
        source = DenseSource(load_scene("tour", SLICE_US), 86_400.0, EVENTS_PER_S)
        paced = PacedSource(source)
        probe = Probe(paced)
        kind = choose_device()
        options = replace(REFERENCE, device=kind, speed="recorded", listens=True)
        with Driver(options, make_source=lambda: paced) as driver:
            periods: list[tuple[bool, int, int]] = []

            def listen() -> None:
                try:
                    periods.extend(_take_turns(pairs, seconds, probe))
                finally:
                    os.kill(os.getpid(), signal.SIGINT)

            thread = threading.Thread(target=listen)
            thread.start()
            with suppress(KeyboardInterrupt):
                driver.run([probe])
            thread.join()
    _print(kind, periods, np.array(probe.waited_ns) / 1e6)


def _take_turns(pairs: int, seconds: float, probe: Probe) -> Iterator[tuple[bool, int, int]]:
    """Yields whether there were listeners in a period, and its first and last slice."""
    while not len(probe.due_ns):  # it compiles, and warms up
        time.sleep(0.1)
    for pair in range(pairs):
        # The order changes, so a machine that grows busier favours neither.
        for listens in (False, True) if pair % 2 == 0 else (True, False):
            with _listeners() if listens else ExitStack():
                time.sleep(SETTLE_S)
                first = len(probe.due_ns)
                time.sleep(seconds)
                yield listens, first, len(probe.due_ns)


@contextmanager
def _listeners() -> Iterator[None]:
    with ExitStack() as stack, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.bind(("127.0.0.1", 0))
        ear.settimeout(LIMIT_S)
        osc = f"osc://127.0.0.1:{ear.getsockname()[1]}"
        _start(stack, "stream", osc)
        ear.recv(65536)
        web = _start(stack, "stream", "websocket")
        address = None
        while address is None:
            address = re.search(r"ws://\S+", web.stdout.readline())
        reader = _launch(stack, [sys.executable, "-c", READER, address[0].rstrip(".")])
        assert reader.stdout.readline(), "the WebSocket gives nothing"
        stopped = _start(stack, "stream", osc)
        while "driver plays" not in stopped.stdout.readline():
            pass
        stopped.send_signal(signal.SIGSTOP)
        yield


def _start(stack: ExitStack, *words: str) -> subprocess.Popen:
    return _launch(stack, [sys.executable, "-m", "neurotouch_hid", *words])


def _launch(stack: ExitStack, command: list[str]) -> subprocess.Popen:
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    stack.callback(process.stdout.close)
    stack.callback(process.wait)
    stack.callback(process.kill)
    return process


def _print(kind: str, periods: list[tuple[bool, int, int]], waited_ms: np.ndarray) -> None:
    print(f"Last event of a slice to the write to the pad ({kind}), 250 Hz, 1 million events/s:")
    parts = {listens: [] for listens in (False, True)}
    for listens, first, last in periods:
        parts[listens].append(waited_ms[first:last])
    for listens, name in ((False, "nobody listens"), (True, "three listeners")):
        p50, p99 = np.percentile(np.concatenate(parts[listens]), [50, 99])
        print(f"  {name:<16} p50 {p50:.3f} ms, p99 {p99:.3f} ms, {len(parts[listens])} periods")
    for rank in (50, 99):
        alone, heard = (
            np.array([np.percentile(part, rank) for part in parts[listens]])
            for listens in (False, True)
        )
        extra = heard - alone
        print(
            f"  p{rank} in pairs: median {np.median(extra):+.3f} ms, ratio "
            f"{np.median(heard / alone):.3f}; "
            f"from {extra.min():+.3f} to {extra.max():+.3f} ms; "
            f"of two periods alone: {np.median(np.abs(np.diff(alone))):.3f} ms"
        )


main()
