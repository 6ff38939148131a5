"""What an area of the fuzzing is, and how cases of it are run and judged."""

import os
import random
import resource
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from neurotouch_hid.errors import NeuroTouchError

FAST_FOLDER: Final = next(filter(Path.is_dir, [Path("/dev/shm")]), None)
"""In memory, where there is such a folder: a hundred times as fast as some disks."""
MAX_SECONDS: Final = 10
"""Of processor time, which a busy machine cannot take away."""
HANGS_S: Final = 300
"""By the clock: a case that waits for so long never ends."""
MAX_GROWTH_BYTES: Final = 200 << 20
"""The driver itself takes some 200 MB, and 400 MB is what it may take with any file."""


@dataclass(frozen=True, slots=True)
class Area:
    """One kind of input from outside.

    Attributes:
        make: gives the bytes of a case; equal generators give equal cases.
        check: does with a file of them what the program would do, and raises what it raises.
        refusal: the one error that is right.
        suffix: how such a file is called.
        lines: how many lines a refusal may have.
    """

    make: Callable[[random.Random], bytes]
    check: Callable[[Path], object]
    refusal: type[NeuroTouchError]
    suffix: str
    lines: int = 1


@dataclass(slots=True)
class Report:
    """What became of the cases of an area.

    Attributes:
        cases: how many ran.
        refused: how many ended in the area's refusal.
        faults: what went wrong, a line each.
        growth_bytes: the most that a case added to the memory.
        seconds: how much processor time all took.
    """

    cases: int = 0
    refused: int = 0
    faults: list[str] = field(default_factory=list)
    growth_bytes: int = 0
    seconds: float = 0.0

    def add(self, other: "Report") -> None:
        """Counts what another process has found."""
        self.cases += other.cases
        self.refused += other.refused
        self.faults += other.faults
        self.growth_bytes = max(self.growth_bytes, other.growth_bytes)
        self.seconds += other.seconds


def run_area(
    area: Area, seed: str, folder: Path, *, cases: int | None = None, seconds: float = 0.0
) -> Report:
    """Runs cases of an area until there are enough, or the time is over.

    Args:
        area: what is run.
        seed: with the number of a case, gives its bytes.
        folder: where the cases with faults are kept.
        cases: how many; None means until the time is over.
        seconds: the processor time, which other programs cannot take away.
    """
    report, begin = Report(), used_seconds()
    with TemporaryDirectory(dir=FAST_FOLDER) as place:
        path = Path(place) / f"case{area.suffix}"
        while report.cases < cases if cases is not None else used_seconds() < begin + seconds:
            content = area.make(random.Random(f"{seed}:{report.cases}"))
            run_case(area, content, path, folder / f"{seed}-{report.cases}{area.suffix}", report)
    report.seconds = used_seconds() - begin
    return report


def used_seconds() -> float:
    """Returns the processor time that this process and those that it started have taken."""
    return sum(os.times()[:4])


def run_case(area: Area, content: bytes, path: Path, kept: Path, report: Report) -> None:
    """Runs one case and counts it.

    Args:
        area: what is run.
        content: the case.
        path: where the case is written for the program.
        kept: where it is kept if it has a fault.
        report: gets the result.
    """
    path.write_bytes(content)
    if fault := _judge(area, path, report):
        kept.write_bytes(content)
        report.faults.append(f"{kept}: {fault}")
    report.cases += 1


def format_report(name: str, seed: str, report: Report) -> str:
    """Returns the counts as a line, and a line for each fault."""
    line = (
        f"{name:<12} seed {seed}: {report.cases} cases in {report.seconds:.0f} s of processor "
        f"time, {report.refused} refused, at most {report.growth_bytes >> 20} MB more, "
        f"{len(report.faults)} faults"
    )
    return "\n  ".join([line, *report.faults])


def _judge(area: Area, path: Path, report: Report) -> str:
    """Runs one case; returns what is wrong, or nothing."""
    fault = ""
    before, begin = _reset_peak(), used_seconds()
    try:
        with _time_limit():
            area.check(path)
    except area.refusal as error:
        report.refused += 1
        said = error.message.split("\n")
        if len(said) > area.lines or not all(line.isprintable() for line in said):
            fault = f"not a printable sentence: {error.message!r}"
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        fault = f"{type(error).__name__}: {str(error)[:200]}"
    growth = _peak_bytes() - before
    report.growth_bytes = max(report.growth_bytes, growth)
    if growth > MAX_GROWTH_BYTES:
        fault = fault or f"{growth >> 20} MB"
    if used_seconds() - begin > MAX_SECONDS:
        fault = fault or f"{used_seconds() - begin:.0f} s"
    return fault


@contextmanager
def _time_limit() -> Iterator[None]:
    """Ends the work in it by an error if it hangs."""

    def end(*_: object) -> None:
        raise TimeoutError(f"more than {HANGS_S} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, HANGS_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def _peak_bytes() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10


def _reset_peak() -> int:
    """Returns the memory taken now, and lets the kernel count its peak from here on."""
    Path("/proc/self/clear_refs").write_text("5", "ascii")
    return _peak_bytes()
