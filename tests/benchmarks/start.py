"""Starts the driver of two states of this repository in turn, until the gamepad is ready.

    python -m tests.benchmarks.start OTHER_FOLDER [PAIRS]

The other folder is a checkout of the other state. Both are started once beforehand, which compiles
their kernels. Shown are medians, and of the processor time also the median of the differences.
"""

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parents[2]
RUN = "run --source sim:rest --speed max --device memory --show nothing"
COLUMNS = ("s", "s of processor time", "MB at most", "MB of its own")


def start(folder):
    """Returns one value for each of ``COLUMNS``."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    begun = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-m", "neurotouch_hid", *RUN.split()],
        env=environment | {"PYTHONPATH": str(folder)},
        cwd="/",  # nothing is imported from the current folder
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert any(line.startswith("Gamepad ready") for line in process.stderr), "it did not start"
    took_s = time.perf_counter() - begun
    proc = Path("/proc", str(process.pid))
    ticks = (proc / "stat").read_text().rpartition(")")[2].split()[11:13]
    kb = dict(line.split(":") for line in (proc / "status").read_text().splitlines())
    own = dict(line.split(":", 1) for line in (proc / "smaps_rollup").read_text().splitlines()[1:])
    process.terminate()
    process.communicate()
    cpu_s = sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
    return took_s, cpu_s, read_mb(kb["VmHWM"]), read_mb(own["Private_Dirty"])


def read_mb(text):
    return int(text.split()[0]) / 1024


def main(other, pairs="8"):
    folders = [Path(other).resolve(), HERE]
    for folder in folders:
        start(folder)
    values = {folder: [] for folder in folders}
    for k in range(int(pairs)):
        for folder in folders[:: 1 - 2 * (k % 2)]:
            values[folder].append(start(folder))
    for folder, each in values.items():
        medians = [statistics.median(column) for column in zip(*each, strict=True)]
        words = (f"{m:.2f} {unit}" for m, unit in zip(medians, COLUMNS, strict=True))
        print(f"{folder}: {', '.join(words)}")
    before, after = values.values()
    less = [a[1] - b[1] for a, b in zip(before, after, strict=True)]
    print(f"{statistics.median(less):.2f} s of processor time less, in {sum(d > 0 for d in less)}")


if __name__ == "__main__":
    main(*sys.argv[1:])
