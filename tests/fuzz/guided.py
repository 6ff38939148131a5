"""Fuzzes one area by coverage: cases that reach new code are kept and changed further.

``make fuzz GUIDED=1`` runs this in a process for each area, because libFuzzer ends its process.
"""

import argparse
import os
import random
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import atheris

ROOT: Final = Path(__file__).parents[2]
COMPILED: Final = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in (ROOT / "neurotouch_hid").rglob("kernels/*.py")
]
"""Numba cannot compile what atheris has changed."""

with atheris.instrument_imports(include=["neurotouch_hid"], exclude=COMPILED):
    from tests.fuzz.area import FAST_FOLDER, Report, format_report, run_case, used_seconds
    from tests.fuzz.areas import AREAS, AT_RANDOM

N_FIRST: Final = 200
"""Cases that the search begins with, made as those without coverage."""
MAX_BYTES: Final = 1 << 16


def main() -> None:
    """Runs the area until the time is over, then ends the process: with 1 for faults."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz.guided", description=__doc__)
    parser.add_argument("area", choices=sorted(AREAS.keys() - AT_RANDOM))
    parser.add_argument("seed")
    parser.add_argument("seconds", type=float)
    parser.add_argument("folder", type=Path, help="for the faults")
    options = parser.parse_args()
    area, chance = AREAS[options.area], random.Random(options.seed)
    with TemporaryDirectory(dir=FAST_FOLDER) as place:
        first = Path(place) / "first"
        first.mkdir()
        for n in range(N_FIRST):
            (first / str(n)).write_bytes(area.make(random.Random(f"{options.seed}:{n}")))
        path, report, begin = Path(place) / f"case{area.suffix}", Report(), used_seconds()

        def run(content: bytes) -> None:
            kept = options.folder / f"{options.area}-{options.seed}-guided-{report.cases}"
            run_case(area, content, path, kept.with_suffix(area.suffix), report)
            report.seconds = used_seconds() - begin
            if report.seconds > options.seconds:
                print(format_report(options.area, f"{options.seed} guided", report), flush=True)
                for file in (*first.iterdir(), path):
                    file.unlink()
                first.rmdir()
                Path(place).rmdir()
                os._exit(min(len(report.faults), 1))  # libFuzzer has no other end

        seed = chance.randrange(1, 1 << 31)
        atheris.Setup([sys.argv[0], f"-seed={seed}", f"-max_len={MAX_BYTES}", str(first)], run)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
