"""How long each stage takes, measured from outside, so that the line itself stays what it is."""

import time
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, Final, TypeVar, cast

from neurotouch_hid.runtime.histogram import Histogram

Stage = TypeVar("Stage")

KEPT = 256
"""Calls of each stage that are remembered one by one: a few seconds."""
RANKS: Final = (50.0, 99.0, 99.9)
"""Percentiles that are told of each stage."""


class Stopwatch:
    """Adds up the host time spent in the stages it watches."""

    def __init__(self) -> None:
        self._spent_ns: dict[str, int] = {}
        self._recent_ns: dict[str, deque[int]] = {}
        self._all_ns: dict[str, Histogram] = {}

    @property
    def spent_ns(self) -> Mapping[str, int]:
        """All time spent in each stage since the start, in ns."""
        return self._spent_ns.copy()

    def recent_ns(self) -> dict[str, list[int]]:
        """How long each of the latest calls took, by stage, in ns; from any thread."""
        return {name: list(kept) for name, kept in self._recent_ns.copy().items()}

    def spread_ms(self) -> dict[str, tuple[float, ...]]:
        """The ``RANKS`` of all calls since the start, by stage, in ms; from any thread."""
        return {
            name: tuple(ns / 1e6 for ns in histogram.percentiles(*RANKS))
            for name, histogram in self._all_ns.copy().items()
        }

    def watch(self, name: str, stage: Stage, method: str) -> Stage:
        """The stage, with the calls of one method timed.

        Args:
            name: what the stage is called.
            stage: any object.
            method: its name.
        """
        call = getattr(stage, method)
        spent_ns = self._spent_ns
        spent_ns.setdefault(name, 0)
        recent_ns = self._recent_ns.setdefault(name, deque(maxlen=KEPT))
        all_ns = self._all_ns.setdefault(name, Histogram())

        def timed(*arguments: object) -> object:
            begun_ns = time.perf_counter_ns()
            result = call(*arguments)
            took_ns = time.perf_counter_ns() - begun_ns
            spent_ns[name] += took_ns
            recent_ns.append(took_ns)
            all_ns.add(took_ns)
            return result

        return cast(Stage, _Watched(stage, method, timed))


class _Watched:
    """Another object in every respect but one method."""

    def __init__(self, stage: object, method: str, timed: Callable[[object], object]) -> None:
        self._stage = stage
        self.__dict__[method] = timed

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stage, name)
