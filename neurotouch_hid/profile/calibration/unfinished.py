"""Keeps what a person has done of a calibration, until it is finished or given up."""

from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from neurotouch_hid.files.small_file import read_text
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile.schema.movements import MOVEMENTS

MAX_BYTES: Final = 1 << 20
_Millimetres = list[Annotated[float, Field(ge=0.0, le=100.0, allow_inf_nan=False)]]


class Progress(BaseModel):
    """The measurements of a calibration so far.

    Attributes:
        version: of this format.
        steps: all steps, by name.
        at: index of the present step.
        skipped: the steps that the person cannot do.
        peaks_mm: the repetitions that count, by movement.
        resting_mm: the readings at rest, 100 a second.
        hold_mm: the readings of the longest hold, 100 a second.
    """

    model_config = ConfigDict(extra="forbid", strict=True)

    version: Literal[1] = 1
    steps: list[str]
    at: int = Field(ge=0)
    skipped: list[str]
    peaks_mm: dict[str, _Millimetres]
    resting_mm: _Millimetres
    hold_mm: _Millimetres


class UnfinishedCalibration:
    """The file of an unfinished calibration, beside the person's own values.

    Each choice of movements has its own. A rehearsal with a simulated gel has another one, so it
    neither continues nor replaces what a hand has done.

    Args:
        movements: the movements to be measured.
        is_simulated: no hand is measured.

    Attributes:
        path: the file.
    """

    def __init__(self, movements: tuple[str, ...], *, is_simulated: bool) -> None:
        kind = "rehearsal" if is_simulated else "calibration"
        names = () if movements == tuple(MOVEMENTS) else movements
        self.path = find_user_file().with_name(".".join(("", "unfinished", kind, *names, "json")))

    def read(self, steps: tuple[str, ...]) -> Progress | None:
        """Returns the progress; None if there is none, or it is of other steps or damaged."""
        progress = read_progress(self.path)
        return progress if progress is not None and progress.steps == list(steps) else None

    def save(self, progress: Progress) -> None:
        """Writes the progress.

        Raises:
            OSError: it cannot be written.
        """
        self.path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(self.path, progress.model_dump_json().encode())

    def forget(self) -> None:
        """Removes it, because the calibration is over."""
        self.path.unlink(missing_ok=True)


def read_progress(path: Path) -> Progress | None:
    """Returns the progress in a file; None if there is none, or it is damaged."""
    try:
        progress = Progress.model_validate_json(read_text(path, MAX_BYTES))
    except (OSError, ValidationError):
        return None
    return progress if progress.at <= len(progress.steps) else None


def find_unfinished_file(*, is_simulated: bool) -> Path:
    """Returns the file of an unfinished calibration of all movements; it need not exist."""
    return UnfinishedCalibration(tuple(MOVEMENTS), is_simulated=is_simulated).path


def describe_unfinished(*, is_simulated: bool) -> str:
    """Returns how far that calibration is, such as ``4 of 10 steps``; empty if there is none."""
    progress = read_progress(find_unfinished_file(is_simulated=is_simulated))
    return "" if progress is None else f"{progress.at} of {len(progress.steps)} steps"
