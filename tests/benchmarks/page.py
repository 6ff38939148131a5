"""What looking on costs: ``python -m tests.benchmarks.page [SECONDS]``.

Plays finished Steps into the feed at the pace of a camera, in a process that does nothing else,
and has a browser's worth of WebSocket read the page's server at 30 Hz. Prints the processor time
of both processes as a share of one core, beside that of the same without anybody looking.
"""

import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.monitor.encoder import StateEncoder
from neurotouch_hid.monitor.publisher import Publisher
from neurotouch_hid.profile import UserSettings, load_profile
from neurotouch_hid.runtime import Pipeline, PipelineControl
from neurotouch_hid.source.simulator import Simulator, find_scene

SLICE_S = 0.01
READER = """
import json, sys
from websockets.sync.client import connect
port, token, hz = sys.argv[1:]
with connect(f"ws://127.0.0.1:{port}/stream", origin=f"http://127.0.0.1:{port}") as line:
    line.send(json.dumps({"token": token, "hz": int(hz)}))
    n = 0
    try:
        while True:
            n += isinstance(line.recv(), bytes)
            print(n, flush=True)
    except Exception:
        pass
"""


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    with tempfile.TemporaryDirectory() as folder:
        os.environ["RUNTIME_DIRECTORY"] = folder
        pipeline = Pipeline.build(load_profile("default"), GestureConfig())
        control = PipelineControl(pipeline, UserSettings())
        packets = Simulator(find_scene("tour"), seed=1)
        steps = [pipeline.advance(packet) for packet, _ in zip(packets, range(600), strict=False)]
        facts = {"source": "sim:tour", "file": "", "device": "memory"}
        with Publisher(Path(folder), StateEncoder(control, lambda: facts)) as feed:
            alone = _play(feed, steps, seconds)
            print(f"the line's process, nobody looks: {alone:.2%} of a core")
            for hz in (30, 60):
                _measure(feed, steps, seconds, alone, hz)


def _measure(feed: Publisher, steps: list, seconds: float, alone: float, hz: int) -> None:
    view = subprocess.Popen(
        [sys.executable, "-m", "neurotouch_hid", "view", "--port", "0"],
        stdout=subprocess.PIPE,
        text=True,
    )
    said = view.stdout.readline() + view.stdout.readline()
    port, token = re.search(r":(\d+)/#k=(\S+)", said).groups()
    reader = subprocess.Popen(
        [sys.executable, "-c", READER, port, token, str(hz)], stdout=subprocess.PIPE, text=True
    )
    _play(feed, steps, 2.0)  # all are there
    before, begun = _spent(view.pid), time.monotonic()
    looked = _play(feed, steps, seconds)
    share = (_spent(view.pid) - before) / (time.monotonic() - begun)
    view.terminate()
    n = len(reader.communicate()[0].splitlines())
    view.wait()
    print(
        f"at {hz} Hz: the line's process {looked - alone:+.2%}, the page's {share:.2%} of a core; "
        f"{n / (seconds + 2.0):.0f} states a second read"
    )


def _play(feed: Publisher, steps: list, seconds: float) -> float:
    """Plays at a camera's pace; the processor time it took as a share of a core."""
    begun, before = time.monotonic(), _own()
    for i in range(int(seconds / SLICE_S)):
        feed(steps[i % len(steps)])
        time.sleep(max(0.0, begun + (i + 1) * SLICE_S - time.monotonic()))
    return (_own() - before) / (time.monotonic() - begun)


def _own() -> float:
    spent = resource.getrusage(resource.RUSAGE_SELF)
    return spent.ru_utime + spent.ru_stime


def _spent(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


main()
