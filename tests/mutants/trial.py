"""Runs tests against mutants: a process that has collected and run them is forked for each.

The mutant's code takes the place of the function's, so no file is changed, and nothing is loaded
twice. Programs that a test starts run unchanged.
"""

import gc
import json
import os
import select
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FunctionType
from typing import IO, Any

import pytest
from _pytest.runner import runtestprotocol
from numba.core.caching import NullCache
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaError

from tests.mutants.operators import Mutant

SLOW_S = 1.0  # of processor time; slower tests are left out
LONG_S = 20.0  # the same of time: such tests wait for other programs, which run unchanged
LEAST_S, PATIENCE = 20.0, 20.0
"""A test may take this long, and this many times what it took without a mutant."""


def try_mutants(mutants: list[Mutant], tests: list[str]) -> Iterator[dict[str, Any]]:
    """Tries the mutants one after the other.

    Yields:
        First the number of `tests`, and which are `left_out`: slow, or failing without a mutant.
        Then one record for each mutant: `by` names the test that kills it; it is empty if every
        test passes.
    """
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.close(reader)
        os.environ["NUMBA_OPT"] = "0"  # a changed kernel is compiled faster
        os.dup2(os.open(os.devnull, os.O_RDWR), 1)
        with os.fdopen(writer, "w", buffering=1) as answers:
            options = ["-q", "-p", "no:cacheprovider", "-n", "0", "-s"]
            pytest.main([*options, *tests], [_Trial(mutants, answers)])
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as answers:
        n_left = 1 + len(mutants)
        for line in answers:
            n_left -= 1
            yield json.loads(line)
    os.waitpid(pid, 0)
    if n_left:
        raise SystemExit(f"The tests were ended from outside: {' '.join(tests)}")


@dataclass(frozen=True)
class _Outcome:
    """How a run of tests ended: which test failed, and why if it did not fail by itself."""

    item: pytest.Item | None = None
    reason: str = ""


class _Trial:
    """Takes the place of pytest's loop over the tests."""

    def __init__(self, mutants: list[Mutant], answers: IO[str]) -> None:
        self._mutants, self._answers = mutants, answers
        self._has_failed = False
        self._neighbours: dict[pytest.Item, pytest.Item | None] = {}
        self._wall_s: dict[pytest.Item, float] = {}
        self._kills: Counter[pytest.Item] = Counter()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Notes a failure of the test, its setup or its teardown."""
        self._has_failed |= report.failed

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Runs the tests without a change, then the quick ones with each mutant."""
        self._neighbours = _find_neighbours(session.items)
        quick, left_out = self._choose(session.items)
        self._answer({"tests": len(quick), "left_out": left_out})
        for mutant in self._mutants:
            quick.sort(key=lambda item: (-self._kills[item], self._wall_s[item]))
            self._answer({"by": self._find_killer(mutant, quick)})
        return True

    def _answer(self, record: dict[str, Any]) -> None:
        print(json.dumps(record), file=self._answers)

    def _choose(self, items: list[pytest.Item]) -> tuple[list[pytest.Item], list[str]]:
        """Returns the tests that pass quickly, also in a forked process, and the others' names."""
        quick, left_out = [], []
        for item in items:
            used_s = float("inf")
            begin_s, before_s = time.monotonic(), time.process_time()
            fails = self._fails(item)  # here kernels are loaded and compiled
            waited_s = time.monotonic() - begin_s - (time.process_time() - before_s)
            if not fails and waited_s < LONG_S:
                begin_s, used_s = time.monotonic(), time.process_time()
                self._fails(item)
                self._wall_s[item] = time.monotonic() - begin_s
                used_s = time.process_time() - used_s
            if used_s < SLOW_S:
                quick.append(item)
            else:
                left_out.append(item.nodeid)
        unchanged = _make_unchanged(self._mutants)
        while (fails := self._run(unchanged, quick).item) is not None:
            quick.remove(fails)
            left_out.append(fails.nodeid)
        return quick, left_out

    def _fails(self, item: pytest.Item) -> bool:
        self._has_failed = False
        item.session._setupstate.teardown_exact(item)  # of a test in another file
        runtestprotocol(item, log=True, nextitem=self._neighbours[item])
        return self._has_failed

    def _find_killer(self, mutant: Mutant, items: list[pytest.Item]) -> str:
        """Returns the name of a test that fails twice; a busy machine can fail one once."""
        rest = list(items)
        while (first := self._run(mutant, rest)).item is not None:
            if (again := self._run(mutant, [first.item])).item is not None:
                self._kills[first.item] += 1
                return f"{first.item.nodeid} {again.reason}".strip()
            rest = rest[rest.index(first.item) + 1 :]
        return first.reason

    def _run(self, mutant: Mutant, items: list[pytest.Item]) -> _Outcome:
        """Runs tests with a mutant in a forked process, up to the first that fails."""
        reader, writer = os.pipe()
        pid = os.fork()
        if pid == 0:
            os.setsid()
            os.dup2(1, 2)
            self._play(mutant, items, writer)
        os.close(writer)
        with os.fdopen(reader, "rb", buffering=0) as progress:
            outcome = self._follow(items, progress)
        with suppress(ProcessLookupError):
            os.killpg(pid, signal.SIGKILL)  # a mutant without end, and what its tests have started
        os.waitpid(pid, 0)
        return outcome

    def _play(self, mutant: Mutant, items: list[pytest.Item], writer: int) -> None:
        """Writes a dot when each test begins, and at last the word how it ended."""
        try:
            word = _swap(mutant) or "passed"
            for item in items if word == "passed" else ():
                os.write(writer, b".")
                if self._fails(item):
                    word = "failed"
                    break
        except BaseException as error:
            word = f"lost: {error!r}"
        os.write(writer, word.encode())
        os._exit(0)

    def _follow(self, items: list[pytest.Item], progress: IO[bytes]) -> _Outcome:
        """Waits for the end of a forked process, or for a test that takes too long."""
        n, word = -1, ""
        while True:
            begun = items[n] if n >= 0 else None
            limit_s = LEAST_S + PATIENCE * (self._wall_s[begun] if begun else LEAST_S)
            if not select.select([progress], [], [], limit_s)[0]:
                return _Outcome(begun, f"does not end in {limit_s:.0f} s")
            text = progress.read(1000).decode()
            dots = len(text) - len(text.lstrip("."))
            n, word = n + dots, word + text[dots:]
            if word == "passed":
                return _Outcome()
            if word == "failed" or (not text and begun):  # the process died in a test
                return _Outcome(items[n])
            if word.startswith("compile"):
                return _Outcome(None, word)
            if not text:
                raise SystemExit(f"A mutant could not be tried: {word or 'its process died'}")


def _find_neighbours(items: list[pytest.Item]) -> dict[pytest.Item, pytest.Item | None]:
    """Returns a test with the same fixtures for each, so that pytest keeps them: they take long."""
    found = {}
    for n, item in enumerate(items):
        others = [*items[:n], *items[n + 1 :]]
        beside = (other for other in others if other.parent is item.parent)
        found[item] = next(beside, others[0] if others else None)
    return found


def _make_unchanged(mutants: list[Mutant]) -> Mutant:
    """Returns a mutant that changes nothing."""
    some = mutants[0]
    return Mutant(some.path, some.function, some.line, "none", some.begin, some.begin, "")


def _swap(mutant: Mutant) -> str:
    """Puts the mutant's code into the running program; returns why it cannot be compiled."""
    path = str(Path(mutant.path).resolve())
    source = Path(path).read_bytes()
    old = _find_functions(compile(source, path, "exec"), mutant.function)
    new = _find_functions(compile(mutant.apply(source), path, "exec"), mutant.function)
    pairs = {code.co_firstlineno: changed for code, changed in zip(old, new, strict=True)}
    gc.unfreeze()  # a test may have frozen it, and frozen objects are not listed
    n = 0
    for found in gc.get_objects():
        if isinstance(found, FunctionType):
            code = found.__code__
            if code.co_filename == path and code.co_qualname == mutant.function:
                found.__code__ = pairs[code.co_firstlineno]
                n += 1
    if not n:
        raise LookupError(f"no function {mutant.function} of {path} is loaded")
    kernels = [k for k in vars(_find_module(path)).values() if isinstance(k, Dispatcher)]
    for kernel in kernels:
        kernel._cache = NullCache()
    try:
        for kernel in kernels:
            kernel.recompile()
    except NumbaError:
        return "compile: the kernel does not compile"
    return ""


def _find_module(path: str) -> Any:
    return next(m for m in list(sys.modules.values()) if getattr(m, "__file__", None) == path)


def _find_functions(code: CodeType, name: str) -> list[CodeType]:
    """Returns the functions of this name in source order; a property has up to three."""
    inner = [const for const in code.co_consts if isinstance(const, CodeType)]
    return [
        found
        for const in inner
        for found in ([const] if const.co_qualname == name else _find_functions(const, name))
    ]
