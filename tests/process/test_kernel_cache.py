"""A loop is compiled anew when anything that it contains has changed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import neurotouch_hid
from neurotouch_hid.process.kernel_cache import Beside, Chosen, stamp

PACKAGE = Path(neurotouch_hid.__file__).parent
OUTER = """
from numba import njit
from neurotouch_hid.inner import FACTOR, double

@njit(cache=True)
def call(x):
    return FACTOR * double(x)
"""
INNER = """
from numba import njit
from neurotouch_hid.constants import TWO

FACTOR = 1

@njit(cache=True)
def double(x):
    return TWO * x
"""
CALL = "from neurotouch_hid.outer import call; print(call(3), sum(call.stats.cache_hits.values()))"


@pytest.fixture
def copy(tmp_path):
    """A package of the same name, with a loop that calls another, which has a constant."""
    package = tmp_path / "neurotouch_hid"
    package.mkdir()
    (package / "process").mkdir()
    for name in ("__init__.py", "process/__init__.py", "process/kernel_cache.py"):
        shutil.copy(PACKAGE / name, package / name)
    for name, text in (("outer", OUTER), ("inner", INNER), ("constants", "TWO = 2\n")):
        (package / f"{name}.py").write_text(text)
    return package


def call(package, **environment):
    inherited = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA")}
    out = subprocess.run(
        [sys.executable, "-c", CALL],
        cwd=package.parent,
        env={**inherited, "PYTHONPATH": str(package.parent), **environment},
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    value, hits = out.split()
    return int(value), int(hits)


@pytest.mark.parametrize("is_chosen", [False, True])
def test_an_update_of_what_a_loop_calls_is_not_missed(copy, tmp_path, is_chosen):
    chosen = {"NUMBA_CACHE_DIR": str(tmp_path / "chosen")} if is_chosen else {}
    assert call(copy, **chosen) == (6, 0)
    assert call(copy, **chosen) == (6, 1)
    (copy / "constants.py").write_text("TWO = 20\n")
    assert call(copy, **chosen) == (60, 0)
    (copy / "inner.py").write_text(INNER.replace("FACTOR = 1", "FACTOR = 2"))
    assert call(copy, **chosen) == (120, 0)
    assert call(copy, **chosen) == (120, 1)
    assert (tmp_path / "chosen").exists() == is_chosen


def test_an_update_may_rename_a_class_that_a_loop_takes(copy):
    named = """
from typing import NamedTuple
from numba import njit

class Pair(NamedTuple):
    a: int

@njit(cache=True)
def inner(pair):
    return pair.a
"""
    outer = """
from numba import njit
from neurotouch_hid.inner import Pair, inner

@njit(cache=True)
def call(x):
    return inner(Pair(x + x))
"""
    (copy / "inner.py").write_text(named)
    (copy / "outer.py").write_text(outer)
    assert call(copy) == (6, 0)
    (copy / "inner.py").write_text(named.replace("Pair", "Couple"))
    (copy / "outer.py").write_text(outer.replace("Pair", "Couple"))
    assert call(copy) == (6, 0)
    assert call(copy) == (6, 1)
    kept = [path.name for path in copy.rglob("*.nbi")]
    assert len(kept) == len({name.split("-")[0] for name in kept}) >= 2  # the old ones are gone


def test_every_loop_of_ours_is_kept_so():
    from neurotouch_hid.gesture.elastic.kernels.follow import locate_shown
    from neurotouch_hid.tracker.kernels.filter import filter_slice

    for loop in (locate_shown, filter_slice):
        assert isinstance(loop._cache._impl.locator, Beside | Chosen)


def test_the_stamp_of_a_loop_is_that_of_all_it_imports():
    loops = list(PACKAGE.rglob("kernels/[a-z]*.py"))
    stamps = {path: stamp(path) for path in loops}
    assert len(stamps) > 15
    assert len(set(stamps.values())) == len(stamps)
