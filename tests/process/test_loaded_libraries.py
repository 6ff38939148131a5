"""Libraries that other people compiled load nothing that a stranger has put somewhere."""

import ctypes
import re
import shutil
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.processes import run_command

LOADED = """
from pathlib import Path
from neurotouch_hid.gel_making import shapes
shapes.load_library().Manifold.sphere(1.0, 64).volume()
print(Path("/proc/self/maps").read_text())
"""


@pytest.fixture
def trap():
    """The folder in ``/tmp`` that the wheel of manifold3d tells the loader to look in, filled."""
    spec = find_spec("manifold3d")
    if spec is None:
        pytest.skip("manifold3d is not installed")
    assert spec.origin is not None
    content = Path(spec.origin).read_bytes()
    named = re.search(rb"(/tmp/[\w-]+)(/[\w/-]+)\0", content)
    if named is None:
        pytest.skip("this wheel names no folder in /tmp: shapes.py may load it without care")
    top, rest = (part.decode() for part in named.groups())
    folder = Path(top + rest)
    assert not Path(top).exists()
    folder.mkdir(parents=True)
    harmless = find_library("libgcc_s.so.1")
    for name in re.findall(rb"\0(lib[\w+]+\.so(?:\.\d+)?)(?=\0)", content):
        shutil.copy(find_library(name.decode()) or harmless, folder / name.decode())
    yield folder
    shutil.rmtree(top)


def find_library(name: str) -> str | None:
    """Where the system has a library."""
    try:
        ctypes.CDLL(name)
    except OSError:
        return None
    maps = Path("/proc/self/maps").read_text().split()
    return next((each for each in maps if each.endswith("/" + name)), None)


def test_nothing_of_a_folder_in_tmp_is_loaded_with_manifold3d(trap):
    assert list(trap.iterdir())
    done = run_command(sys.executable, "-c", LOADED)
    assert "manifold3d" in done.stdout
    assert str(trap) not in done.stdout
