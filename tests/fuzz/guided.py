"""Fuzzes one area by coverage: cases that reach new code are kept and changed further.

``make fuzz GUIDED=1`` runs this, in several processes after each other: libFuzzer ends its process,
and code that atheris has changed loses memory, up to 40 MB a second.
"""

import argparse
import json
import os
import random
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Final

import atheris

ROOT: Final = Path(__file__).parents[2]
COMPILED: Final = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in (ROOT / "neurotouch_hid").rglob("kernels/*.py")
]
"""Numba cannot compile what atheris has changed."""

with atheris.instrument_imports(include=["neurotouch_hid"], exclude=COMPILED):
    from tests.fuzz.area import Report, run_case, used_seconds
    from tests.fuzz.areas import AREAS, AT_RANDOM

N_FIRST: Final = 200
"""Cases that the search begins with, made as those without coverage."""
MAX_BYTES: Final = 1 << 16
MAX_TAKEN_BYTES: Final = 1 << 30
"""Memory at which the process ends before its time."""
_LOOK: Final = 100
"""Cases between two looks at the memory."""


def main() -> None:
    """Runs the area until the time is over, then prints the report as JSON and ends the process."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz.guided", description=__doc__)
    parser.add_argument("area", choices=sorted(AREAS.keys() - AT_RANDOM))
    parser.add_argument("seed")
    parser.add_argument("seconds", type=float)
    parser.add_argument("folder", type=Path, help="for the faults")
    parser.add_argument("corpus", type=Path, help="an empty folder, or the one of a process before")
    options = parser.parse_args()
    area, chance = AREAS[options.area], random.Random(options.seed)
    if not any(options.corpus.iterdir()):
        for n in range(N_FIRST):
            case = area.make(random.Random(f"{options.seed}:{n}"))
            (options.corpus / str(n)).write_bytes(case)
    path = options.corpus.with_name(f"case{area.suffix}")
    report, begin = Report(), used_seconds()

    def run(content: bytes) -> None:
        kept = options.folder / f"{options.area}-{options.seed}-guided-{report.cases}"
        run_case(area, content, path, kept.with_suffix(area.suffix), report)
        report.seconds = used_seconds() - begin
        is_full = report.cases % _LOOK == 0 and _count_taken() > MAX_TAKEN_BYTES
        if report.seconds > options.seconds or is_full:
            print(json.dumps(asdict(report)), flush=True)
            os._exit(0)  # libFuzzer has no other end

    seed = chance.randrange(1, 1 << 31)
    atheris.Setup([sys.argv[0], f"-seed={seed}", f"-max_len={MAX_BYTES}", str(options.corpus)], run)
    atheris.Fuzz()


def _count_taken() -> int:
    pages = int(Path("/proc/self/statm").read_text("ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


if __name__ == "__main__":
    main()
