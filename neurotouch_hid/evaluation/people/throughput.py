"""Measures pointing by ISO 9241-411: throughput, errors and movement time."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, stdev
from typing import Any, Final, TypedDict

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text

Point = tuple[float, float]

WIDTH_FACTOR: Final = 4.133
"""Between these many standard deviations lie 96 % of the selections [ISO 9241-411, Annex B]."""

LEAST_TRIALS: Final = 3
"""With fewer trials the spread is unknown."""

LEAST_WIDTH_PX: Final = 1.0
"""The pointer's own resolution; a smaller spread is not believed."""

COMPARED: Final = (
    ("throughput_bit_s", "throughput", "bit/s", "higher"),
    ("movement_s", "movement time", "s", "lower"),
    ("error_rate", "missed targets", "", "lower"),
)


@dataclass(frozen=True, slots=True)
class Trial:
    """One movement to one target.

    Attributes:
        width_px: the diameter of the target.
        start_px: place of the pointer at the start, (x, y).
        target_px: the middle of the target, (x, y).
        selected_px: place of the pointer at the selection, (x, y).
        movement_s: from the first motion to the selection, without the time of a dwell.
    """

    width_px: float
    start_px: Point
    target_px: Point
    selected_px: Point
    movement_s: float

    @property
    def distance_px(self) -> float:
        """The distance from the start to the middle of the target."""
        return math.dist(self.start_px, self.target_px)

    @property
    def overshoot_px(self) -> float:
        """The distance of the selection beyond the middle, in the direction of the movement."""
        (x0, y0), (x1, y1), (x, y) = self.start_px, self.target_px, self.selected_px
        return ((x - x1) * (x1 - x0) + (y - y1) * (y1 - y0)) / self.distance_px

    @property
    def is_hit(self) -> bool:
        """True if it was selected inside the target."""
        return math.dist(self.selected_px, self.target_px) <= 0.5 * self.width_px


@dataclass(frozen=True, slots=True)
class Block:
    """All trials with targets of one width.

    Attributes:
        width_px: that width.
        trials: number of trials.
        effective_width_px: We = 4.133 SDx.
        effective_distance_px: Ae, the mean distance moved in the direction of the target.
        movement_s: MT, the mean movement time.
        error_rate: share of the selections outside the target.
        throughput_bit_s: TP = log2(Ae / We + 1) / MT.
    """

    width_px: float
    trials: int
    effective_width_px: float
    effective_distance_px: float
    movement_s: float
    error_rate: float
    throughput_bit_s: float


class BlockFigures(TypedDict):
    """A ``Block``, ready for JSON."""

    width_px: float
    trials: int
    effective_width_px: float
    effective_distance_px: float
    movement_s: float
    error_rate: float
    throughput_bit_s: float


class Figures(TypedDict):
    """The figures of a test, ready for JSON: means over its blocks.

    Attributes:
        throughput_bit_s: throughput.
        movement_s: movement time.
        error_rate: share of the selections outside the target.
        trials: how many there were, also in blocks that are too small.
        blocks: the figures of each width.
    """

    throughput_bit_s: float
    movement_s: float
    error_rate: float
    trials: int
    blocks: list[BlockFigures]


def measure_block(trials: Sequence[Trial]) -> Block:
    """Returns the figures of the trials with one width; at least three of them."""
    overshoots = [trial.overshoot_px for trial in trials]
    width_px = max(WIDTH_FACTOR * stdev(overshoots), LEAST_WIDTH_PX)
    distance_px = fmean(trial.distance_px + trial.overshoot_px for trial in trials)
    movement_s = fmean(trial.movement_s for trial in trials)
    return Block(
        trials[0].width_px,
        len(trials),
        width_px,
        distance_px,
        movement_s,
        fmean(not trial.is_hit for trial in trials),
        math.log2(max(distance_px, 0.0) / width_px + 1.0) / movement_s,
    )


def measure_pointing(trials: Sequence[Trial]) -> Figures:
    """Returns the figures of a test, ready for JSON: the means over its blocks, and the blocks.

    Raises:
        NeuroTouchError: no width has three trials.
    """
    by_width: dict[float, list[Trial]] = {}
    for trial in trials:
        by_width.setdefault(trial.width_px, []).append(trial)
    blocks = [measure_block(each) for each in by_width.values() if len(each) >= LEAST_TRIALS]
    if not blocks:
        raise NeuroTouchError(
            f"There were {len(trials)} selections, too few to measure anything.",
            hint=f"At least {LEAST_TRIALS} targets of one width must be selected.",
        )
    return {
        "throughput_bit_s": fmean(block.throughput_bit_s for block in blocks),
        "movement_s": fmean(block.movement_s for block in blocks),
        "error_rate": fmean(block.error_rate for block in blocks),
        "trials": len(trials),
        "blocks": [_describe(block) for block in blocks],
    }


def _describe(block: Block) -> BlockFigures:
    return {
        "width_px": block.width_px,
        "trials": block.trials,
        "effective_width_px": block.effective_width_px,
        "effective_distance_px": block.effective_distance_px,
        "movement_s": block.movement_s,
        "error_rate": block.error_rate,
        "throughput_bit_s": block.throughput_bit_s,
    }


def read_result(path: Path) -> dict[str, Any]:
    """Returns a result that was saved.

    Raises:
        NeuroTouchError: the file is missing or is no result.
    """
    hint = "Save one with: neurotouch bench pointing --json FILE"
    try:
        result = json.loads(read_text(path, MAX_SETTINGS_BYTES))
    except OSError as error:
        raise NeuroTouchError(f"'{path}' cannot be read: {error.strerror}.", hint=hint) from error
    except (ValueError, RecursionError) as error:
        raise NeuroTouchError(f"'{path}' is not valid JSON.", hint=hint) from error
    keys = [key for key, *_ in COMPARED]
    if not isinstance(result, dict) or not all(
        isinstance(result.get(key), int | float) for key in keys
    ):
        raise NeuroTouchError(f"'{path}' is not a result of a pointing test.", hint=hint)
    return result


def compare_results(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """Returns one line for each figure: the old one, the new one, and whether it is better."""
    lines = []
    for key, name, unit, better in COMPARED:
        was, now = float(before[key]), float(after[key])
        rises = now > was
        word = "better" if rises == (better == "higher") else "worse"
        if math.isclose(now, was, rel_tol=1e-3, abs_tol=1e-6):
            word = "the same"
        change = f", {100.0 * (now / was - 1.0):+.0f} %" if was else ""
        gap = f" {unit}" if unit else ""
        lines.append(f"{name}: before {was:.2f}{gap}, now {now:.2f}{gap}{change}, {word}")
    return lines
