"""Feeds damaged input to the program: ``python -m tests.fuzz [AREA ...] --minutes N --seed S``.

Every fault is kept as a file. The same seed gives the same cases; without one it is drawn and said.
"""

import argparse
import json
import random
import shlex
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.fuzz.area import FAST_FOLDER, Report, format_report, run_area
from tests.fuzz.areas import AREAS, AT_RANDOM


def main() -> int:
    """Runs the areas one after the other, each for its share of the time."""
    options = _parse()
    seed = options.seed or f"{random.SystemRandom().randrange(10**6):06d}"
    options.folder.mkdir(parents=True, exist_ok=True)
    faults = 0
    for name in options.areas or AREAS:
        share = 60 * options.minutes / len(options.areas or AREAS)
        if options.guided and name not in AT_RANDOM:
            report = _run_guided(name, seed, share, options.folder)
        else:
            report = run_area(
                AREAS[name], f"{name}-{seed}", options.folder, cases=options.cases, seconds=share
            )
        print(format_report(name, seed, report), flush=True)
        faults += len(report.faults)
    return min(faults, 1)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("areas", nargs="*", metavar="AREA", help=f"of {', '.join(AREAS)}")
    parser.add_argument(
        "--minutes", type=float, default=1.0, help="of processor time, of all areas together"
    )
    parser.add_argument("--guided", action="store_true", help="follow the coverage, by libFuzzer")
    parser.add_argument("--cases", type=int, help="of each area, instead of minutes")
    parser.add_argument("--seed", help="what the cases are drawn from")
    parser.add_argument("--folder", type=Path, default=Path(".cache/fuzz"), help="for the faults")
    options = parser.parse_args()
    unknown = [name for name in options.areas if name not in AREAS]
    if unknown:
        parser.error(f"there is no area '{unknown[0]}'; known are {', '.join(AREAS)}")
    return options


def _run_guided(name: str, seed: str, seconds: float, folder: Path) -> Report:
    """Runs an area by coverage, in as many processes as its memory needs."""
    report, n = Report(), 0
    with TemporaryDirectory(dir=FAST_FOLDER) as place:
        corpus = Path(place) / "corpus"
        corpus.mkdir()
        while report.seconds < seconds:
            left = str(seconds - report.seconds)
            words = [name, f"{seed}-{n}", left, str(folder), str(corpus)]
            command = [sys.executable, "-m", "tests.fuzz.guided", *words]
            done = subprocess.run(
                command, check=False, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
            )
            if done.returncode:
                again = f"python {shlex.join(command[1:-1])} $(mktemp -d)"
                report.faults.append(f"ended early, with code {done.returncode}. See why: {again}")
                break
            report.add(Report(**json.loads(done.stdout)))
            n += 1
    return report


sys.exit(main())
