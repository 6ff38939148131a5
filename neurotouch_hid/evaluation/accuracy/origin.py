"""Origin of an evaluation's figures: program, command, time, and the share of simulations."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from neurotouch_hid import __version__
from neurotouch_hid.recording import Simulation, find_simulation


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of figures.

    Attributes:
        program: name and version.
        command: the command line; empty if a program started the evaluation.
        date: date and time in UTC, ISO 8601.
        recordings: number of recordings.
        simulated: number of those that are marked as simulated.
        seeds: the seeds of these.
        simulated_by: programs and commands that simulated them.
    """

    program: str
    command: str
    date: str
    recordings: int
    simulated: int
    seeds: tuple[int, ...]
    simulated_by: tuple[str, ...] = ()

    def as_json(self) -> dict[str, Any]:
        """Returns the same as plain values."""
        return asdict(self)

    def __str__(self) -> str:
        """Returns one sentence about the recordings."""
        if not self.simulated:
            return f"{_count(self.recordings)}, none of them marked as simulated."
        seeds = ", ".join(map(str, self.seeds)) or "unknown"
        by = f", by {'; '.join(self.simulated_by)}" if self.simulated_by else ""
        if self.simulated == self.recordings:
            return f"SIMULATED: {_count(self.recordings)} of the simulator, seed {seeds}{by}."
        share = f"{self.simulated} of {_count(self.recordings)}"
        return f"SIMULATED in part: {share}, seed {seeds}{by}."


def trace_origin(paths: Sequence[Path], command: str = "") -> Origin:
    """Returns the origin of the figures of these recordings.

    Args:
        paths: the recordings.
        command: the command line.
    """
    marks = [mark for path in paths if (mark := _find_mark(path)) is not None]
    by = {f"{mark.program}: {mark.command}" for mark in marks if mark.command}
    return Origin(
        program=f"neurotouch-hid {__version__}",
        command=command,
        date=datetime.now(UTC).isoformat(timespec="seconds"),
        recordings=len(paths),
        simulated=len(marks),
        seeds=tuple(sorted({mark.seed for mark in marks if mark.seed is not None})),
        simulated_by=tuple(sorted(by)),
    )


def _find_mark(path: Path) -> Simulation | None:
    """Returns the mark of a simulated recording: in its header, or in ``dataset.json`` beside it.

    Raises:
        RecordingError: it is no recording.
    """
    mark = find_simulation(path)
    if mark is not None:
        return mark
    # It loads the simulator, which a process that only plays does not need.
    from neurotouch_hid.source.simulator.dataset import read_manifest  # noqa: PLC0415

    recipe = read_manifest(path.parent).get(path.stem)
    if not isinstance(recipe, dict):
        return None
    seed = recipe.get("seed")
    return Simulation("", path.stem, seed=seed if isinstance(seed, int) else None)


def _count(n: int) -> str:
    return f"{n} recording{'' if n == 1 else 's'}"
