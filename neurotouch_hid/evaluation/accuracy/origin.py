"""Where the figures of an evaluation come from: program, command, time, and whether simulated."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from neurotouch_hid import __version__
from neurotouch_hid.source.simulator.dataset import read_manifest


@dataclass(frozen=True, slots=True)
class Origin:
    """Where figures come from.

    Attributes:
        program: name and version.
        command: what was typed; empty where a program asked.
        date: when, in UTC, ISO 8601.
        recordings: how many were played.
        simulated: how many of them the simulator wrote, as ``dataset.json`` beside them says.
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
    """Returns where figures of these recordings come from.

    Args:
        paths: the recordings.
        command: what was typed.
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
