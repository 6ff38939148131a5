"""Writes parts on several cores, and around those of an edition what a stranger needs."""

import os
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import as_completed
from pathlib import Path
from typing import Final

from neurotouch_devtools.dataset.checksums import CHECKSUMS, format_checksums, list_checksums
from neurotouch_devtools.dataset.edition import EDITION, Part
from neurotouch_hid.driver.gel_file import choose_gel
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.process.own_pool import open_pool
from neurotouch_hid.source.simulator.dataset import Progress, write_dataset

GELS: Final = Path(__file__).parent / "gels"
STEP: Final = 0.25  # of a part, between two lines of progress
LEAST_S: Final = 1.0  # what is only found finished has none

_LICENCE: Final = """\
This data set is licensed under the Creative Commons Attribution 4.0 International licence,
CC BY 4.0: https://creativecommons.org/licenses/by/4.0/

Name it as: neurotouch_hid, simulated gestures on a soft gel, edition {edition}.
SPDX-License-Identifier: CC-BY-4.0
"""
_README: Final = """\
# Simulated gestures on a soft gel, edition {edition}

All of it is SIMULATED. No camera, no gel and no person was recorded. A result on these data says
how a method does on this simulator, not how it does on hands.

- `open/` may be looked at, trained on and tuned on. `judge/` is for one final score only.
- `NAME.aedat4` has events and frames, `NAME.mkv` pictures; `NAME.labels.csv` has the truth.
- `NAME.gel.yaml` says where the dots are; without it they are those of the paper.
- `dataset.json` in each folder has the recipe of each recording: seed, person, gesture, nuisances.
- `sha256sum --check SHA256SUMS` tells whether all files are whole.

Data card, rules, formats and the program that made it: docs/research of neurotouch_hid.
Licence: CC BY 4.0, see LICENSE.txt.

| folder | what | seed | recordings |
| --- | --- | --- | --- |
"""


def make_parts(
    folder: Path,
    parts: Sequence[Part],
    command: str,
    *,
    jobs: int = 1,
    progress: Callable[[str], None] = lambda _: None,
) -> list[Path]:
    """Makes all parts, several at once; what is finished is kept.

    Args:
        folder: where the parts' folders will be.
        parts: what to make.
        command: the command line that the recordings name.
        jobs: number of processes.
        progress: called with a line of text at each finished part.

    Returns:
        The recordings, part by part.

    Raises:
        RecordingError: a folder or a file cannot be written, or it has other recordings.
    """
    # The sums of BLAS depend on the number of its threads, and many threads are slower here. Numpy
    # reads the number when it is loaded: so even one job gets a process of its own.
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    made = {}
    with open_pool(jobs) as pool:
        futures = {pool.submit(_make_part, folder, command, part): part for part in parts}
        for n, done in enumerate(as_completed(futures), 1):
            part = futures[done]
            made[part.folder] = done.result()
            progress(f"{n} of {len(parts)} parts: {part.folder}")
    return [path for part in parts for path in made[part.folder]]


def write_edition(
    folder: Path,
    parts: Sequence[Part],
    *,
    jobs: int = 1,
    progress: Callable[[str], None] = lambda _: None,
) -> dict[str, str]:
    """Makes the parts of an edition with licence, description and checksums.

    Args:
        folder: made if missing.
        parts: of one split or of both.
        jobs: number of processes.
        progress: called with a line of text at each finished part.

    Returns:
        The SHA-256 of each file, by its path.

    Raises:
        RecordingError: a folder or a file cannot be written, or it has other recordings.
    """
    make_parts(
        folder, parts, f"neurotouch data set, edition {EDITION}", jobs=jobs, progress=progress
    )
    rows = (f"| `{p.folder}` | {p.what} | {p.seed} | {5 * p.users} |\n" for p in parts)
    readme = _README.format(edition=EDITION) + "".join(rows)
    write_whole(folder / "README.md", readme.encode())
    write_whole(folder / "LICENSE.txt", _LICENCE.format(edition=EDITION).encode())
    checksums = list_checksums(folder)
    write_whole(folder / CHECKSUMS, format_checksums(checksums).encode())
    return checksums


def _make_part(folder: Path, command: str, part: Part) -> list[Path]:
    """Makes one part; its progress goes to the standard error of this process."""
    chosen = choose_gel(str(GELS / f"{part.gel}.gel.yaml") if part.gel else None, "sim:")
    begun_s, told = time.process_time(), 0.0

    def tell(now: Progress) -> None:
        nonlocal told
        share = (now.n_done + now.share) / now.n_files
        spent_s = time.process_time() - begun_s
        if share >= told + STEP and share < 1.0 and spent_s >= LEAST_S:
            told = share
            print(f"  {part.folder}: {share:.0%}, {spent_s:.0f} s", file=sys.stderr, flush=True)

    return write_dataset(
        folder / part.folder,
        part.users,
        part.minutes,
        part.seed,
        tell,
        [part.elasticity],
        nuisances=part.nuisances,
        command=command,
        gel=chosen.gel,
        gel_file=chosen.file,
    )
