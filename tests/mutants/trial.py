"""Runs the tests of one module in a copy of the tree, in a process of its own for each mutant.

The process is forked from one that has loaded the libraries but none of our modules.
"""

import importlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

LIBRARIES = ("numpy", "numba", "pydantic", "yaml", "click", "websockets.sync.server", "evdev")
SLOW_S = 0.7  # of processor time, for one test


class Copy:
    """A copy of the working tree, whose source may be changed.

    Args:
        folder: where the copy is made; what lies there is removed.
    """

    def __init__(self, folder: Path) -> None:
        for library in LIBRARIES:
            importlib.import_module(library)
        self._folder = folder.resolve()
        shutil.rmtree(self._folder, ignore_errors=True)
        listed = ["git", "ls-files", "-coz", "--exclude-standard"]
        for name in subprocess.check_output(listed, text=True).split("\0"):
            if Path(name).is_file():
                (self._folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(name, self._folder / name)

    def write(self, path: str, source: bytes) -> None:
        """Writes a module; compiled code of the one before is not taken for its own."""
        (self._folder / path).write_bytes(source)
        for cached in (self._folder / path).parent.glob(f"__pycache__/{Path(path).stem}.*"):
            cached.unlink()

    def find_quick(self, path: str, tests: list[str]) -> dict[str, float]:
        """Returns the tests that pass without a change and are not slow, with their times."""
        self._run(tests, _Watch(set()), 3600, [])  # compiles kernels, which is kept
        answer = self._run(tests, _Watch(set()), 3600, [])
        quick = {name: s for name, s in (answer or {}).get("times", {}).items() if s < SLOW_S}
        if not quick:
            raise SystemExit(f"{path}: no test passes quickly of {' '.join(tests)}")
        return quick

    def survives(self, quick: dict[str, float], timeout_s: float) -> bool:
        """Whether every test passes with the source as it is now."""
        files = sorted({name.split("::")[0] for name in quick})
        answer = self._run(files, _Watch(set(quick)), timeout_s, ["-x"])
        return answer is not None and answer["code"] == 0

    def _run(self, tests: list[str], plugin: Any, timeout_s: float, options: list[str]) -> Any:
        """Returns what the plugin tells and pytest's exit code; None after the time limit."""
        result = self._folder / "result.json"
        result.unlink(missing_ok=True)
        pid = os.fork()
        if pid == 0:
            os.setsid()
            self._become_the_tests(tests, plugin, options, result)
        end = time.monotonic() + timeout_s
        while os.waitpid(pid, os.WNOHANG)[0] == 0:
            if time.monotonic() > end:
                os.killpg(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
                return None
            time.sleep(0.02)
        try:
            os.killpg(pid, signal.SIGKILL)  # what the tests have left behind
        except ProcessLookupError:
            pass
        return json.loads(result.read_text()) if result.exists() else None

    def _become_the_tests(
        self, tests: list[str], plugin: Any, options: list[str], result: Path
    ) -> None:
        try:
            quiet = os.open(os.devnull, os.O_RDWR)
            for stream in (0, 1, 2):
                os.dup2(quiet, stream)
            here = str(Path.cwd())
            os.chdir(self._folder)
            sys.path[:] = [str(self._folder), *(p for p in sys.path if p not in ("", here))]
            os.environ["PYTHONPATH"] = str(self._folder)
            os.environ["NUMBA_OPT"] = "0"  # a changed kernel is compiled faster
            os.environ["NUMBA_CACHE_DIR"] = f"{self._folder}-kernels"
            for name in [n for n in sys.modules if n.split(".")[0] == "tests"]:
                del sys.modules[name]
            code = pytest.main(
                ["-q", "-p", "no:cacheprovider", "-n", "0", *options, *tests], [plugin]
            )
            result.write_text(json.dumps({"code": int(code), **plugin.tell()}))
        finally:
            os._exit(0)


class _Watch:
    """Leaves only some tests, if any are named, and notes the processor time of those that pass."""

    def __init__(self, chosen: set[str]) -> None:
        self._chosen = chosen
        self._begin_s = 0.0
        self._times: dict[str, float] = {}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        if self._chosen:
            items[:] = [item for item in items if item.nodeid in self._chosen]

    def pytest_runtest_logstart(self) -> None:
        self._begin_s = time.process_time()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self._times.pop(report.nodeid, None)
        elif report.when == "call" and report.passed:
            self._times[report.nodeid] = time.process_time() - self._begin_s

    def tell(self) -> dict[str, Any]:
        """Returns the times by test."""
        return {"times": self._times}
