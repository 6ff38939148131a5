"""Cameras under umockdev, and programs that use them."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from neurotouch_devtools.emulator.umockdev import Umockdev

from neurotouch_hid.errors import SourceError
from tests.emulator.host import make_scene

ROOT = Path(__file__).parents[2]
SCENE = make_scene(seed=5, n_events=20_000, length_us=400_000, n_frames=6)


def plug_in(camera):
    """The cable of a camera; the test is skipped where umockdev is not installed."""
    try:
        return Umockdev(camera)
    except SourceError as error:
        if os.environ.get("NEUROTOUCH_REQUIRE_UMOCKDEV") == "1":
            raise
        pytest.skip(f"{error.message}: {error.hint}")


def start(cable, *arguments):
    """A Python program that sees the camera of a cable and no other."""
    return subprocess.Popen(
        [sys.executable, *arguments],
        env=cable.environment,
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def finish(process, timeout_s=600):
    """What it has printed; a failure is ours."""
    try:
        out, errors = process.communicate(timeout=timeout_s)
    finally:
        process.kill()
    assert process.returncode == 0, errors
    return out


def run(cable, *arguments):
    return finish(start(cable, *arguments))
