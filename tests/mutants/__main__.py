"""Changes the safety-critical modules one spot at a time: does a test fail?

``python -m tests.mutants [MODULE ...] --count N --seed S``. Survivors that `survivors.md` does not
explain end it with 1. No file is changed. With ``--results FILE`` each mutant is a line of the
file as soon as it has been tried, and those that the file calls killed are not tried again.
"""

import argparse
import hashlib
import json
import random
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

from tests.mutants.operators import Mutant, find_mutants
from tests.mutants.trial import try_mutants

HERE = Path(__file__).parent
MODULES: dict[str, list[str]] = tomllib.loads((HERE / "modules.toml").read_text())


def main() -> int:
    """Runs the chosen mutants, one after the other."""
    options = _parse()
    explained = (HERE / "survivors.md").read_text().splitlines()
    results = _Results(options.results)
    chosen = _choose(options.modules or list(MODULES), options.count, options.seed)
    total, left, unknown = 0, 0, 0
    for path, mutants in chosen.items():
        survivors = _try_module(path, mutants, results)
        total, left = total + len(mutants), left + len(survivors)
        source = Path(path).read_bytes()
        for mutant in survivors:
            is_known = _is_explained(mutant, source, explained)
            unknown += not is_known
            print(f"  {'explained' if is_known else 'NEW':<9} {_show(mutant, source)}", flush=True)
    print(f"seed {options.seed}: {total} mutants, {left} survive, {unknown} of them unexplained")
    return min(unknown, 1)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("modules", nargs="*", metavar="MODULE", help="a path of modules.toml")
    parser.add_argument("--count", type=int, default=300, help="of all modules together")
    parser.add_argument("--seed", default="1", help="what the mutants are drawn with")
    parser.add_argument("--results", type=Path, help="a file that is read first, then added to")
    options = parser.parse_args()
    unknown = [path for path in options.modules if path not in MODULES]
    if unknown:
        parser.error(f"modules.toml has no '{unknown[0]}'")
    return options


class _Results:
    """What killed each mutant, in memory and in a file of lines."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        lines = path.read_text().splitlines() if path is not None and path.exists() else []
        self._records = {record["key"]: record for record in map(json.loads, lines)}

    def is_killed(self, mutant: Mutant, source: bytes) -> bool:
        """Whether the file says so of this change of this source."""
        return bool(self._records.get(_make_key(mutant, source), {}).get("by"))

    def add(self, mutant: Mutant, source: bytes, record: dict[str, Any]) -> None:
        """Appends a line."""
        if self._path is not None:
            whole = {"key": _make_key(mutant, source), "what": _show(mutant, source), **record}
            with self._path.open("a") as file:
                print(json.dumps(whole), file=file)


def _make_key(mutant: Mutant, source: bytes) -> str:
    changed = mutant.apply(source)
    return f"{mutant.path} {hashlib.sha256(changed).hexdigest()[:16]}"


def _try_module(path: str, mutants: list[Mutant], results: _Results) -> list[Mutant]:
    """Returns the mutants with which every test passes."""
    begin_s, source = time.monotonic(), Path(path).read_bytes()
    open_ones = [mutant for mutant in mutants if not results.is_killed(mutant, source)]
    known = len(mutants) - len(open_ones)
    if not open_ones:
        print(f"{path}: {known} mutants, all killed before", flush=True)
        return []
    tries = try_mutants(open_ones, MODULES[path])
    tests = next(tries)
    survivors = []
    tried_s = time.monotonic()
    for mutant, record in zip(open_ones, tries, strict=True):
        before_s, tried_s = tried_s, time.monotonic()
        results.add(mutant, source, {**record, "seconds": round(tried_s - before_s, 1)})
        if not record["by"]:
            survivors.append(mutant)
    print(
        f"{path}: {len(mutants)} mutants, {known} killed before, {len(survivors)} survive "
        f"{tests['tests']} tests, {time.monotonic() - begin_s:.0f} s"
    )
    for test in tests["left_out"]:
        print(f"  left out: {test}")
    return survivors


def _choose(paths: list[str], count: int, seed: str) -> dict[str, list[Mutant]]:
    """Draws as many mutants of each module; where a module has fewer, the next ones have more."""
    found = {path: find_mutants(path, Path(path).read_bytes()) for path in paths}
    chosen = {}
    for n, path in enumerate(sorted(paths, key=lambda path: len(found[path]))):
        share = min(len(found[path]), count // (len(paths) - n))
        count -= share
        drawn = list(range(len(found[path])))
        random.Random(f"{seed} {path}").shuffle(drawn)  # fewer are the first of more
        chosen[path] = [found[path][k] for k in sorted(drawn[:share])]
    return chosen


def _is_explained(mutant: Mutant, source: bytes, explained: list[str]) -> bool:
    """Whether a row names the module and both lines, wherever they are in the file now."""
    lines = _show_lines(mutant, source)
    return any(f"| {mutant.path}:" in row and lines in row for row in explained)


def _show_lines(mutant: Mutant, source: bytes) -> str:
    old, new = (text.replace("|", "\\|") for text in mutant.diff(source))
    return f"| `{old}` | `{new}` |"


def _show(mutant: Mutant, source: bytes) -> str:
    return f"| {mutant.path}:{mutant.line} | {mutant.operator} {_show_lines(mutant, source)}"


if __name__ == "__main__":
    sys.exit(main())
