"""Runs tests against mutants: a process that has collected and run them is forked for each.

The mutant's code takes the place of the function's, so no file is changed, and nothing is loaded
twice. Programs that a test starts run unchanged.
"""

import gc
import json
import os
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

import pytest
from _pytest.runner import runtestprotocol
from numba.core.caching import NullCache
from numba.core.dispatcher import Dispatcher

from tests.mutants.operators import Mutant

SLOW_S = 1.0  # of processor time; slower tests are left out


def try_mutants(mutants: list[Mutant], tests: list[str]) -> dict[str, Any]:
    """Returns `survivors`, the indices of the mutants with which every test passes.

    And the number of `tests` of them, and which are `left_out`: slow, or failing without a mutant.
    """
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.close(reader)
        os.environ["NUMBA_OPT"] = "0"  # a changed kernel is compiled faster
        output = os.open(os.devnull, os.O_RDWR)
        os.dup2(output, 1)
        trial = _Trial(mutants)
        pytest.main(["-q", "-p", "no:cacheprovider", "-n", "0", "-s", *tests], [trial])
        os.write(writer, json.dumps(trial.answer).encode())
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as answer:
        text = answer.read()
    os.waitpid(pid, 0)
    if not text:
        raise SystemExit(f"The tests were ended from outside: {' '.join(tests)}")
    return json.loads(text)  # type: ignore[no-any-return]


class _Trial:
    """Takes the place of pytest's loop over the tests."""

    def __init__(self, mutants: list[Mutant]) -> None:
        self._mutants = mutants
        self._has_failed = False
        self.answer: dict[str, Any] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Notes a failure of the test, its setup or its teardown."""
        self._has_failed |= report.failed

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Runs the tests without a change, then the quick ones with each mutant."""
        times, left_out = {}, []
        begin_s = time.monotonic()
        for item in session.items:
            if self._fails([item]):  # here kernels are loaded and compiled
                left_out.append(item.nodeid)
                continue
            again_s = time.process_time()
            self._fails([item])
            times[item] = time.process_time() - again_s
        quick = [item for item in times if times[item] < SLOW_S]
        left_out += [item.nodeid for item in times if times[item] >= SLOW_S]
        quick.sort(key=lambda item: (str(item.path), times[item]))
        timeout_s = 30 + 5 * (time.monotonic() - begin_s)
        survivors = []
        for n, mutant in enumerate(self._mutants):
            if self._survives(mutant, quick, timeout_s):
                survivors.append(n)
        self.answer = {"survivors": survivors, "tests": len(quick), "left_out": left_out}
        return True

    def _fails(self, items: list[pytest.Item]) -> bool:
        self._has_failed = False
        for item in items:
            runtestprotocol(item, log=True, nextitem=None)
            if self._has_failed:
                return True
        return False

    def _survives(self, mutant: Mutant, quick: list[pytest.Item], timeout_s: float) -> bool:
        pid = os.fork()
        if pid == 0:
            os.setsid()
            os.dup2(1, 2)
            code = 2
            with suppress(BaseException):
                _swap(mutant)
                code = int(self._fails(quick))
            os._exit(code)
        end = time.monotonic() + timeout_s
        while (ended := os.waitpid(pid, os.WNOHANG))[0] == 0 and time.monotonic() < end:
            time.sleep(0.01)
        with suppress(ProcessLookupError):
            os.killpg(pid, signal.SIGKILL)  # a mutant without end, and what its tests have started
        if ended[0] == 0:
            os.waitpid(pid, 0)
        return ended == (pid, 0)


def _swap(mutant: Mutant) -> None:
    path = str(Path(mutant.path).resolve())
    source = Path(path).read_bytes()
    old = _find_functions(compile(source, path, "exec"), mutant.function)
    new = _find_functions(compile(mutant.apply(source), path, "exec"), mutant.function)
    pairs = {code.co_firstlineno: changed for code, changed in zip(old, new, strict=True)}
    for found in gc.get_objects():
        if isinstance(found, FunctionType):
            code = found.__code__
            if code.co_filename == path and code.co_qualname == mutant.function:
                found.__code__ = pairs[code.co_firstlineno]
    if kernels := [k for k in vars(_find_module(path)).values() if isinstance(k, Dispatcher)]:
        for kernel in kernels:
            kernel._cache = NullCache()
        for kernel in kernels:
            kernel.recompile()


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
