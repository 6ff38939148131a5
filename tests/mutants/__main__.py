"""Changes the safety-critical modules one spot at a time: does a test fail?

``python -m tests.mutants [MODULE ...] --count N --seed S``. Survivors that `survivors.md` does not
explain end it with 1. The working tree is never changed.
"""

import argparse
import random
import sys
import time
import tomllib
from pathlib import Path

from tests.mutants.operators import Mutant, find_mutants
from tests.mutants.trial import Copy

HERE = Path(__file__).parent
MODULES: dict[str, list[str]] = tomllib.loads((HERE / "modules.toml").read_text())


def main() -> int:
    """Runs the chosen mutants, one after the other."""
    options = _parse()
    explained = (HERE / "survivors.md").read_text()
    copy = Copy(options.folder)
    chosen = _choose(options.modules or list(MODULES), options.count, options.seed)
    total, left, unknown = 0, 0, 0
    for path, mutants in chosen.items():
        begin_s, source = time.monotonic(), Path(path).read_bytes()
        quick = copy.find_quick(path, MODULES[path])
        timeout_s = 30 + 5 * (time.monotonic() - begin_s)
        print(f"{path}: {len(quick)} tests, {sum(quick.values()):.1f} s", flush=True)
        survivors = []
        for mutant in mutants:
            copy.write(path, mutant.apply(source))
            if copy.survives(quick, timeout_s):
                survivors.append(mutant)
                print(_row(mutant, source), flush=True)
        copy.write(path, source)
        total, left = total + len(mutants), left + len(survivors)
        unknown += sum(_key(mutant, source) not in explained for mutant in survivors)
        print(
            f"{path}: {len(mutants)} mutants, {len(survivors)} survive, "
            f"{time.monotonic() - begin_s:.0f} s",
            flush=True,
        )
    print(f"seed {options.seed}: {total} mutants, {left} survive, {unknown} of them unexplained")
    return min(unknown, 1)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("modules", nargs="*", metavar="MODULE", help="a path of modules.toml")
    parser.add_argument("--count", type=int, default=300, help="of all modules together")
    parser.add_argument("--seed", default="1", help="what the mutants are drawn with")
    parser.add_argument("--folder", type=Path, default=Path(".cache/mutants"), help="of the copy")
    options = parser.parse_args()
    unknown = [path for path in options.modules if path not in MODULES]
    if unknown:
        parser.error(f"modules.toml has no '{unknown[0]}'")
    return options


def _choose(paths: list[str], count: int, seed: str) -> dict[str, list[Mutant]]:
    """Draws as many mutants of each module; where a module has fewer, the next ones have more."""
    found = {path: find_mutants(path, Path(path).read_bytes()) for path in paths}
    chosen = {}
    for n, path in enumerate(sorted(paths, key=lambda path: len(found[path]))):
        share = min(len(found[path]), count // (len(paths) - n))
        count -= share
        drawn = random.Random(f"{seed} {path}").sample(range(len(found[path])), share)
        chosen[path] = [found[path][k] for k in sorted(drawn)]
    return chosen


def _key(mutant: Mutant, source: bytes) -> str:
    old, new = mutant.diff(source)
    return f"| `{old}` | `{new}` |".replace("|=", "\\|=")


def _row(mutant: Mutant, source: bytes) -> str:
    return f"| {mutant.path}:{mutant.line} | {mutant.operator} {_key(mutant, source)}"


sys.exit(main())
