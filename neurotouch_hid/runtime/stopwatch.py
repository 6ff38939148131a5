"""How long each stage takes, measured from outside, so that the line itself stays what it is."""

import time
from collections.abc import Callable, Mapping
from typing import Any, TypeVar, cast

Stage = TypeVar("Stage")


class Stopwatch:
    """Adds up the host time spent in the stages it watches."""

    def __init__(self) -> None:
        self._spent_ns: dict[str, int] = {}

    @property
    def spent_ns(self) -> Mapping[str, int]:
        """All time spent in each stage since the start, in ns."""
        return self._spent_ns.copy()

    def watch(self, name: str, stage: Stage, method: str) -> Stage:
        """The stage, with the calls of one method timed.

        Args:
            name: what the stage is called.
            stage: any object.
            method: a method with one argument.
        """
        call = getattr(stage, method)
        spent_ns = self._spent_ns
        spent_ns.setdefault(name, 0)

        def timed(argument: object) -> object:
            begun_ns = time.perf_counter_ns()
            result = call(argument)
            spent_ns[name] += time.perf_counter_ns() - begun_ns
            return result

        return cast(Stage, _Watched(stage, method, timed))


class _Watched:
    """Another object in every respect but one method."""

    def __init__(self, stage: object, method: str, timed: Callable[[object], object]) -> None:
        self._stage = stage
        self.__dict__[method] = timed

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stage, name)
