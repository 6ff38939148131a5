"""Lets a driver play for hours among disturbances: ``python -m tests.soak --hours 24 --seed 1``.

Each two minutes of sensor time have faults, people who do something, a plug, and all gestures
undisturbed. It ends with 1 if Steps differ from those of an undisturbed pipeline, if descriptors,
threads or files are not as many as after the first two minutes, or if the memory grows.
"""

import argparse
import os
import signal
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from neurotouch_hid.evaluation.speed.workload import TOUR_US
from tests.soak.soak import run_soak


def main() -> int:
    """Runs it and prints the figures."""
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description=__doc__)
    parser.add_argument("--hours", type=float, default=24.0, help="of sensor time")
    parser.add_argument("--seed", type=int, default=1, help="of all random choices")
    options = parser.parse_args()
    for ending in (signal.SIGINT, signal.SIGTERM):  # also where it was started in the background
        signal.signal(ending, signal.default_int_handler)
    with TemporaryDirectory(prefix="nt-soak-") as folder:
        for name in ("HOME", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME"):
            home = Path(folder) / name.lower()
            home.mkdir(mode=0o700)
            os.environ[name] = str(home)
        result = run_soak(
            options.hours, options.seed, Path(folder), TOUR_US, lambda line: print(line, flush=True)
        )
    if not result.weights:
        print("Ended before the first two minutes were over.")
        return 1
    first, last = result.weights[0], result.weights[-1]
    print(f"{result.hours:.1f} h in {result.host_s / 60:.0f} min, seed {options.seed}")
    print(f"after the first cycle: {first}\nat the end:            {last}")
    print(f"memory: {result.kb_per_hour:+.0f} kB an hour")
    print(f"stretches equal to the undisturbed run: {result.n_equal} of {len(result.weights)}")
    print("disturbances: " + ", ".join(f"{n} {name}" for name, n in sorted(result.done.items())))
    for fault, n in Counter(result.faults).most_common(50):
        print(f"{n} times: {fault}")
    print(f"{len(result.faults)} faults")
    return min(len(result.faults), 1)


if __name__ == "__main__":
    sys.exit(main())
