"""Makes the public data set and compares it with the checksums of its edition.

Ctrl-C stops it; the same command continues.
"""

import argparse
import os
import sys
import time
from pathlib import Path
from typing import Final

from neurotouch_devtools.dataset.checksums import compare_checksums, read_checksums
from neurotouch_devtools.dataset.edition import EDITION, SPLITS, list_parts
from neurotouch_devtools.dataset.writing import write_edition
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.process.interrupts import handle_interrupts

OF_EDITION: Final = Path(__file__).parent / f"edition-{EDITION}.sha256"
MOST_LINES: Final = 12


def main() -> int:
    """Makes it; returns 1 if a file has other bytes than those of the edition, or on an error."""
    handle_interrupts()
    options = _parse()
    parts = [part for split in options.split for part in list_parts(split)]
    begun = time.monotonic()
    try:
        found = write_edition(
            options.out, parts, jobs=options.jobs, progress=lambda line: print(line, flush=True)
        )
    except NeuroTouchError as error:
        print(f"Error: {error}" + (f"\nFix: {error.hint}" if error.hint else ""), file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("Stopped. The same command continues.", file=sys.stderr)
        return 130
    size_mb = sum((options.out / name).stat().st_size for name in found) / 1e6
    took_s = time.monotonic() - begun
    print(
        f"{len(found)} files of SIMULATED data, {size_mb:.0f} MB, are in {options.out}. "
        f"It took {took_s:.0f} s."
    )
    if options.keep_checksums:
        write_whole(OF_EDITION, (options.out / "SHA256SUMS").read_bytes())
        return 0
    return _compare(found, options.split)


def _compare(found: dict[str, str], splits: list[str]) -> int:
    expected = {
        name: digest
        for name, digest in read_checksums(OF_EDITION.read_text(encoding="utf-8")).items()
        if name.partition("/")[0] in splits
    }
    data = {name: digest for name, digest in found.items() if "/" in name}
    differences = compare_checksums(expected, data)
    for line in differences[:MOST_LINES]:
        print(line)
    if len(differences) > MOST_LINES:
        print(f"... and {len(differences) - MOST_LINES} more.")
    if differences:
        print(
            f"{len(differences)} of {len(expected)} files differ from edition {EDITION}. Another "
            "processor or library can be the cause: see docs/research/dataset.md."
        )
        return 1
    print(f"All {len(expected)} files have the bytes of edition {EDITION}.")
    return 0


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m neurotouch_devtools.dataset", description=__doc__
    )
    parser.add_argument("out", type=Path, metavar="OUT", help="folder, made if missing")
    parser.add_argument(
        "--split",
        nargs="+",
        choices=[*SPLITS],
        default=[*SPLITS],
        help="which; both if not given",
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument(
        "--keep-checksums",
        action="store_true",
        help="make these bytes the edition, instead of comparing with it",
    )
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
