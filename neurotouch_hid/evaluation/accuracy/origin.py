"""Origin of an evaluation's figures: program, command, time, and the share of simulations."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from neurotouch_hid import __version__
from neurotouch_hid.source.simulator.dataset import read_manifest


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of figures.

    Attributes:
        program: name and version.
        command: the command line; empty if a program started the evaluation.
        date: date and time in UTC, ISO 8601.
        recordings: number of recordings.
        simulated: number of those that the simulator wrote, from ``dataset.json`` beside them.
        seeds: the seeds of these.
    """

    program: str
    command: str
    date: str
    recordings: int
    simulated: int
    seeds: tuple[int, ...]

    def as_json(self) -> dict[str, Any]:
        """Returns the same as plain values."""
        return asdict(self)

    def __str__(self) -> str:
        """Returns one sentence about the recordings."""
        if not self.simulated:
            return f"{_count(self.recordings)}, none of them marked as simulated."
        seeds = ", ".join(map(str, self.seeds))
        if self.simulated == self.recordings:
            return f"SIMULATED: {_count(self.recordings)} of the simulator, seed {seeds}."
        return f"SIMULATED in part: {self.simulated} of {_count(self.recordings)}, seed {seeds}."


def trace_origin(paths: Sequence[Path], command: str = "") -> Origin:
    """Returns the origin of the figures of these recordings.

    Args:
        paths: the recordings.
        command: the command line.
    """
    recipes = [read_manifest(path.parent).get(path.stem) for path in paths]
    known = [recipe for recipe in recipes if isinstance(recipe, dict)]
    return Origin(
        program=f"neurotouch-hid {__version__}",
        command=command,
        date=datetime.now(UTC).isoformat(timespec="seconds"),
        recordings=len(paths),
        simulated=len(known),
        seeds=tuple(sorted({int(recipe.get("seed", 0)) for recipe in known})),
    )


def _count(n: int) -> str:
    return f"{n} recording{'' if n == 1 else 's'}"
