"""Runs a driver for hours of sensor time among disturbances, and measures what it leaves."""

import os
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import groupby
from pathlib import Path
from unittest.mock import patch

import numpy as np

from neurotouch_hid.driver import REFERENCE, Driver
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.process.gc_freeze import freeze_gc
from neurotouch_hid.profile import load_profile
from neurotouch_hid.profile.reading.library import find_user_folder
from neurotouch_hid.runtime import Pipeline
from tests.soak.people import PLAYED
from tests.soak.source import SoakSource, load_tour

WARM_SHARE = 0.2
"""Share of the cycles in which caches and allocators fill up."""
MOST_KB_PER_HOUR = 100.0
"""Growth of the memory after that, of sensor time: 0.9 GB in a year."""
SETTLE_S = 5.0
"""Viewers that have left and threads that end are gone within this time."""


@dataclass(frozen=True)
class Weight:
    """What the process has and uses at the end of a cycle."""

    kb: int
    descriptors: int
    threads: int
    files: int

    @property
    def counts(self) -> tuple[int, int, int]:
        """All but the memory: these must not grow at all."""
        return self.descriptors, self.threads, self.files


@dataclass
class Result:
    """What came out; ``faults`` is empty if all is well.

    Attributes:
        hours: sensor time that has passed.
        host_s: how long it took.
        weights: at the end of each cycle.
        n_equal: stretches with the same Steps as the undisturbed run.
        done: how often each disturbance has happened.
        faults: what is wrong.
    """

    hours: float
    host_s: float = 0.0
    weights: list[Weight] = field(default_factory=list)
    n_equal: int = 0
    done: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)

    @property
    def kb_per_hour(self) -> float:
        """Growth of the memory after the start, by least squares; 0 for a short run."""
        kept = [weight.kb for weight in self.weights[int(WARM_SHARE * len(self.weights)) :]]
        if len(kept) < 10:
            return 0.0
        hours = np.linspace(0.0, self.hours * (1.0 - WARM_SHARE), len(kept))
        return float(np.polyfit(hours, kept, 1)[0])


class Twin:
    """A tap that plays the same packets through a pipeline that nobody disturbs, and compares.

    Markers and gestures are equal bit by bit at every moment, as people and viewers change nothing
    of them; so is the pad in the undisturbed stretches. Faults of the data reach both. That they
    leave nothing behind shows in the order of the gestures and presses of each stretch, which is
    the one of a new pipeline.

    Args:
        tour: the packets of a stretch.
        rest: packets without a gesture that come before.
        is_undisturbed: returns whether the Step belongs to a stretch.

    Attributes:
        n_equal: stretches with all actions in their order.
        faults: what differs.
    """

    def __init__(
        self,
        tour: Sequence[EventPacket],
        rest: Iterable[EventPacket],
        is_undisturbed: Callable[[], bool],
    ) -> None:
        self._pipeline = build_pipeline()
        self._expected = _list_actions(map(build_pipeline().advance, (*rest, *tour)))
        self._stretch: list[Step] = []
        self._is_undisturbed = is_undisturbed
        self.n_equal = 0
        self.faults: list[str] = []

    def __call__(self, step: Step) -> None:
        """Compares a Step."""
        twin = self._pipeline.advance(step.packet)
        is_undisturbed = self._is_undisturbed()
        if is_undisturbed:
            self._stretch.append(step)
        elif self._stretch:
            self._end_stretch()
        if _get_values(step) != _get_values(twin) or (is_undisturbed and step.pad != twin.pad):
            self.faults.append(f"the Step at {step.packet.t_end_us} us differs from the twin's")

    def _end_stretch(self) -> None:
        actions = _list_actions(self._stretch)
        if actions == self._expected:
            self.n_equal += 1
        else:
            self.faults.append(f"the stretch until {self._stretch[-1].packet.t_end_us}: {actions}")
        self._stretch = []


def build_pipeline() -> Pipeline:
    """Returns a pipeline as the driver has one."""
    return Pipeline.build(load_profile(PLAYED), GestureConfig())


def _get_values(step: Step) -> tuple[object, ...]:
    markers, gesture = step.markers, step.gesture
    return (
        markers.rest_px.tobytes(),
        markers.position_px.tobytes(),
        markers.valid.tobytes(),
        gesture.contacts_mm.tobytes(),
        gesture.contacts_px.tobytes(),
        (gesture.kind, gesture.intensity_mm, gesture.translation_mm, gesture.rotation_rad),
        (gesture.scale, gesture.confidence),
    )


def _list_actions(steps: Iterable[Step]) -> list[tuple[object, ...]]:
    """Returns which gestures and presses there were, in their order."""
    every = ((step.gesture.kind, step.pad.buttons, step.pad.keys) for step in steps)
    return [key for key, _ in groupby(every)]


def run_soak(
    hours: float, seed: int, folder: Path, length_us: int, say: Callable[[str], object]
) -> Result:
    """Runs a driver among disturbances, and its undisturbed twin beside it.

    Args:
        hours: sensor time.
        seed: of all random choices.
        folder: where the driver and the people have their files; counted.
        length_us: length of an undisturbed stretch.
        say: is told a line every ten cycles.
    """
    result = Result(hours)

    def weigh() -> None:
        first = result.weights[0].counts if result.weights else None
        end_s = time.monotonic() + SETTLE_S
        while (weight := _weigh(folder)).counts != first and time.monotonic() < end_s:
            time.sleep(0.05)
        result.weights.append(weight)
        if len(result.weights) % 10 == 0:
            so_far = f"{twin.n_equal} stretches equal, {len(twin.faults)} faults"
            say(f"cycle {len(result.weights)}: {weight}, {so_far}")

    find_user_folder().mkdir(parents=True, exist_ok=True)
    begin_s = time.monotonic()
    tour = load_tour(length_us)
    source = SoakSource(hours, seed, tour, weigh)
    twin = Twin(tour, source.rest, lambda: source.is_undisturbed)
    with (
        suppress(KeyboardInterrupt),
        source,
        # It is busy for an hour: it must neither slow the machine down nor be ended for it.
        patch("neurotouch_hid.driver.driver.realtime_priority", freeze_gc),
        Driver(
            replace(REFERENCE, profile=PLAYED, listens=True), make_source=lambda: source
        ) as driver,
    ):
        driver.run([twin])
    result.hours = source.hours
    result.host_s = time.monotonic() - begin_s
    result.done, result.n_equal = source.done, twin.n_equal
    result.faults = [*twin.faults, *source.failed]
    result.faults += [
        f"cycle {n}: {weight} after {result.weights[0]}"
        for n, weight in enumerate(result.weights)
        if weight.counts != result.weights[0].counts
    ]
    if result.kb_per_hour > MOST_KB_PER_HOUR:
        result.faults.append(f"the memory grows by {result.kb_per_hour:.0f} kB an hour")
    return result


def _weigh(folder: Path) -> Weight:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return Weight(
        pages * os.sysconf("SC_PAGE_SIZE") // 1024,
        sum(1 for _ in Path("/proc/self/fd").iterdir()),
        sum(1 for _ in Path("/proc/self/task").iterdir()),
        sum(1 for _ in folder.rglob("*")),
    )
