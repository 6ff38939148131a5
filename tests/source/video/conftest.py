"""Clips that several tests play."""

import os
from pathlib import Path

import pytest

from tests.source.video.simulated_clip import Lens, make_clip

LENS = Lens((640, 480), 1.7, -0.15)


@pytest.fixture(scope="session")
def pushed(tmp_path_factory):
    """Three seconds of ``sim:push`` as 640 x 480 pixels with a barrel lens, 125 fps."""
    return make_clip(tmp_path_factory.mktemp("clips") / "push.mkv", "push", LENS, seconds=3)


@pytest.fixture
def real_gel():
    """A real marker gel under real fingers, which is no part of the project."""
    folder = Path(os.environ.get("NEUROTOUCH_SHARED_DATA", "../shared/data"))
    path = folder / "gelsight-mini.avi"
    if not path.exists():
        pytest.skip(f"the real gel's clip {path} is not here (folder: NEUROTOUCH_SHARED_DATA)")
    return path
