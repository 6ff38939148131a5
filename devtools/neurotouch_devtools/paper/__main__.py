"""Makes tables and figures of the documents again, from seeds, and says what differs.

Returns 1 if a figure differs from the committed one by more than its tolerance. Ctrl-C stops it;
the same command continues.
"""

import argparse
import os
import shutil
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

import neurotouch_hid
from neurotouch_devtools.dataset import (
    Part,
    compare_checksums,
    list_parts,
    make_parts,
    read_checksums,
    write_edition,
)
from neurotouch_devtools.dataset.__main__ import OF_EDITION
from neurotouch_devtools.paper.comparison import compare_pictures, compare_results
from neurotouch_devtools.paper.results import Result, format_results, list_results, read_results
from neurotouch_hid.driver import REFERENCE
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.evaluation.accuracy import Evaluation, evaluate_files
from neurotouch_hid.evaluation.accuracy.report.pictures import draw_pictures
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.process.interrupts import handle_interrupts

RESULTS: Final = "results.csv"
METHODS: Final = ("paper", "neurotouch")
HARD: Final = (
    Part("hard/half-space", "hard people, gel of closed forms", 77, users=5),
    Part("hard/solid", "the same, gel of finite elements", 77, users=5, elasticity="solid"),
)
"""The simulated columns of the documents."""
LIMIT_S: Final = 30 * 60.0


def main() -> int:
    """Makes, compares and says; returns 1 if something differs."""
    handle_interrupts()
    options = _parse()
    begun = time.monotonic()
    try:
        differences = _make(options)
    except NeuroTouchError as error:
        print(f"Error: {error}" + (f"\nFix: {error.hint}" if error.hint else ""), file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("Stopped. The same command continues.", file=sys.stderr)
        return 130
    took_s = time.monotonic() - begun
    print(f"It took {took_s:.0f} s; on two cores it should take {LIMIT_S:.0f} s at most.")
    if not differences and not options.keep:
        print("Nothing differs by more than its tolerance.")
    return 1 if differences else 0


def _make(options: argparse.Namespace) -> list[str]:
    """Returns what differs, after it has been printed; with ``--keep`` nothing is compared.

    Raises:
        NeuroTouchError: there is nothing to compare with, which is said before the long work.
    """
    if not options.keep and not (options.committed / RESULTS).is_file():
        raise NeuroTouchError(
            f"There is no file '{options.committed / RESULTS}'.",
            hint="Type 'make paper' in the folder of the source code.",
        )
    work = options.work / _digest()
    _remove_others(options.work, work)
    parts = [part for split in ("open", "judge") for part in list_parts(split)]
    _say("Making the hard set (SIMULATED) ...")
    make_parts(work, HARD, "make paper", jobs=options.jobs, progress=_say)
    _say("Making the public data set (SIMULATED) ...")
    checksums = write_edition(work / "edition", parts, jobs=options.jobs, progress=_say)
    _say_bytes(checksums)
    folders = {part.folder: work / part.folder for part in HARD}
    folders |= {part.folder: work / "edition" / part.folder for part in list_parts("judge")}
    evaluations = {method: _evaluate(folders, method, options.jobs) for method in METHODS}
    results = list(_list_all(evaluations))
    pictures = _draw({method: of["hard"] for method, of in evaluations.items()})
    _write(work / "made", results, pictures)
    if options.keep:
        _write(options.committed, results, pictures)
        print(f"{len(results)} figures and {len(pictures)} pictures are in {options.committed}.")
        return []
    differences = find_differences(options.committed, results, pictures)
    print(f"{len(results)} figures and {len(pictures)} pictures were compared.")
    for line in differences:
        print(line)
    if differences:
        print(f"{len(differences)} differ. What was made is in {work / 'made'}.")
    return differences


def find_differences(
    committed: Path, results: Sequence[Result], pictures: Mapping[str, str]
) -> list[str]:
    """Returns a sentence for each figure and each picture that differs from a committed one.

    Args:
        committed: folder of the committed table and pictures.
        results: the figures that have just been made.
        pictures: their SVG, by name.
    """
    before = read_results((committed / RESULTS).read_text("utf-8"))
    drawn = {path.stem: path.read_text("utf-8") for path in committed.glob("*.svg")}
    return compare_results(before, results) + compare_pictures(drawn, pictures)


def _evaluate(folders: Mapping[str, Path], method: str, jobs: int) -> dict[str, Evaluation]:
    """Returns the results by set: ``hard``, ``judge``, and each part of the latter."""
    of_part = {
        part: sorted([*folder.glob("*.aedat4"), *folder.glob("*.mkv")])
        for part, folder in folders.items()
    }
    paths = [path for listed in of_part.values() for path in listed]
    done = 0

    def tell(_: Path) -> None:
        nonlocal done
        done += 1
        if done % 20 == 0 or done == len(paths):
            _say(f"{method}: {done} of {len(paths)} recordings played")

    _say(f"Playing with method {method} ...")
    played = evaluate_files(paths, replace(REFERENCE, method=method), jobs=jobs, progress=tell)
    by_path = dict(zip(paths, played.files.values(), strict=True))
    sets: dict[str, Evaluation] = {}
    for part, listed in of_part.items():
        split = part.partition("/")[0]
        names = [split, part] if split == "judge" else [split]
        for name in names:
            files = sets.setdefault(name, Evaluation({})).files
            files |= {f"{part}/{path.stem}": by_path[path] for path in listed}
    return sets


def _list_all(evaluations: Mapping[str, Mapping[str, Evaluation]]) -> Iterator[Result]:
    for method, sets in evaluations.items():
        for data, evaluation in sets.items():
            whole = data in ("hard", "judge")
            yield from list_results(data, method, evaluation.report(), whole=whole)


def _draw(evaluations: Mapping[str, Evaluation]) -> dict[str, str]:
    """Returns the SVG of each figure of a report, without the worst moments."""
    reports: dict[str, dict[str, Any]] = {m: each.report() for m, each in evaluations.items()}
    pictures = {}
    for picture in draw_pictures(evaluations, reports, _say):
        if picture.name.startswith("failures"):
            break
        pictures[picture.name] = picture.svg
    return pictures


def _write(folder: Path, results: Sequence[Result], pictures: Mapping[str, str]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / RESULTS, format_results(results).encode())
    for name, svg in pictures.items():
        write_whole(folder / f"{name}.svg", svg.encode())


def _say_bytes(checksums: Mapping[str, str]) -> None:
    """Says whether the data set has the bytes of its edition; other processors may differ."""
    expected = {
        name: digest
        for name, digest in read_checksums(OF_EDITION.read_text("utf-8")).items()
        if "/" in name
    }
    data = {name: digest for name, digest in checksums.items() if "/" in name}
    n = len(compare_checksums(expected, data))
    same = "All files of the data set have the bytes of the edition."
    print(f"{n} of {len(expected)} files of the data set have other bytes." if n else same)


def _digest() -> str:
    """Returns which state of the program this is: other programs make other data."""
    total = sha256()
    for package in (Path(neurotouch_hid.__file__).parent, Path(__file__).parents[1] / "dataset"):
        for path in sorted(package.rglob("*.py")):
            total.update(path.read_bytes())
    return total.hexdigest()[:12]


def _remove_others(folder: Path, present: Path) -> None:
    """Removes what older programs made: a gigabyte each."""
    for path in folder.glob("[0-9a-f]" * 12):
        if path != present:
            shutil.rmtree(path)


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m neurotouch_devtools.paper", description=__doc__
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--work", type=Path, default=Path(".cache/paper"), help="for recordings")
    parser.add_argument(
        "--committed", type=Path, default=Path("docs/research/figures"), help="to compare with"
    )
    parser.add_argument(
        "--keep", action="store_true", help="replace the committed ones, compare nothing"
    )
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
