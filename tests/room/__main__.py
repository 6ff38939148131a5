"""Measures recognition under each nuisance of a real room: ``python -m tests.room``.

A recording that is there is not made again, and a result of the same program is not measured
again, so an interrupted run continues. Recordings fill about 1 GB.
"""

import argparse
import fnmatch
import hashlib
import json
import os
import sys
import time
from collections.abc import Sequence
from concurrent.futures import as_completed
from pathlib import Path
from typing import Any

import neurotouch_hid
from neurotouch_hid.process.interrupts import EXIT_INTERRUPTED, handle_interrupts
from neurotouch_hid.process.own_pool import open_pool
from tests.room import bound, judge, matrix
from tests.room.judge import measure
from tests.room.matrix import CONDITIONS, Condition
from tests.room.table import format_table

PACKAGE = Path(neurotouch_hid.__file__).parent
SIMULATOR = PACKAGE / "source" / "simulator"


def main() -> int:
    """Measures, then prints the table; returns 1 if a recording could not be played."""
    handle_interrupts()
    options = _parse()
    try:
        return _measure(options)
    except KeyboardInterrupt:
        print("Stopped. The same command continues.", file=sys.stderr)
        return EXIT_INTERRUPTED


def _measure(options: argparse.Namespace) -> int:
    conditions = _choose(options.only, options.count)
    made_by, judged_by = _digest(SIMULATOR), _digest(PACKAGE, judge.__file__, bound.__file__)
    work = [(condition, seed) for condition in conditions for seed in options.seeds]
    results: dict[tuple[str, int], dict[str, Any]] = {}
    begun, failed = time.monotonic(), 0
    # Two processes with a thread for each core each are many times slower than with one.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with open_pool(options.jobs) as pool:
        futures = {
            pool.submit(measure, options.folder, condition, seed, made_by, judged_by): (
                condition,
                seed,
            )
            for condition, seed in work
        }
        for n, done in enumerate(as_completed(futures), 1):
            condition, seed = futures[done]
            place = f"{n:>3} of {len(work)}, {time.monotonic() - begun:.0f} s"
            try:
                results[condition.name, seed] = done.result()
            except Exception as error:
                failed += 1
                print(f"{place}: {condition.name}, seed {seed}: {error!r}", file=sys.stderr)
                continue
            print(f"{place}: {condition.name}, seed {seed}", file=sys.stderr, flush=True)
    by_name = {
        condition.name: [
            results[condition.name, seed]
            for seed in options.seeds
            if (condition.name, seed) in results
        ]
        for condition in conditions
    }
    if options.json:
        print(json.dumps({"seeds": options.seeds, "conditions": by_name}, indent=1))
    else:
        print(format_table(conditions, by_name))
    return min(failed, 1)


def _choose(only: Sequence[str], count: int | None) -> list[Condition]:
    """Returns the rows whose name or chapter fits, all without a choice."""
    chosen = [
        condition
        for condition in CONDITIONS
        if not only
        or any(
            fnmatch.fnmatch(text, pattern)
            for text in (condition.name, condition.name.rpartition(":")[2], condition.chapter)
            for pattern in only
        )
    ]
    return chosen[:count]


def _digest(folder: Path, *others: str) -> str:
    """Returns which state of the program's files this is."""
    files = [*sorted(folder.rglob("*.py")), Path(matrix.__file__), *map(Path, others)]
    total = hashlib.sha256()
    for path in files:
        total.update(path.read_bytes())
    return total.hexdigest()[:12]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.room", description=__doc__)
    parser.add_argument("only", nargs="*", help="rows or chapters, also bump* and the like")
    parser.add_argument("--count", type=int, help="at most so many rows")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2], help="one figure for each")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--folder", type=Path, default=Path(".cache/room"), help="for recordings")
    parser.add_argument("--json", action="store_true", help="print JSON")
    options = parser.parse_args()
    if not _choose(options.only, options.count):
        names = ", ".join(condition.name for condition in CONDITIONS)
        parser.error(f"there is no row '{' '.join(options.only)}'; rows: {names}")
    return options


if __name__ == "__main__":
    sys.exit(main())
