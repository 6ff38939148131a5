"""The process that decodes is limited by what it has open, whatever its libraries keep open."""

import subprocess
import sys

import pytest

from neurotouch_hid.recording.video.ffmpeg_process import PICTURE_HEAD
from tests.processes import run_command
from tests.recording.clips import write_clip
from tests.recording.test_clip import STAMPS_US, draw

MODULE = "neurotouch_hid.recording.video.ffmpeg_process"
KEPT_OPEN = "import os; os.open('/dev/null', os.O_RDONLY)"
"""As libffi 3.5 keeps its own file open, through which ctypes makes callbacks."""


@pytest.mark.parametrize("before", ["", KEPT_OPEN])
def test_it_decodes_whatever_its_libraries_keep_open(tmp_path, before):
    pictures = [draw(k) for k in range(len(STAMPS_US))]
    clip = write_clip(tmp_path / "a.mkv", pictures, STAMPS_US, "ffv1", "gray")
    code = f"{before}\nfrom {MODULE} import run\nraise SystemExit(run())"
    with clip.open("rb") as stream:
        done = subprocess.run(
            [sys.executable, "-c", code], stdin=stream, capture_output=True, check=False
        )
    assert done.returncode == 0, done.stderr
    assert len(done.stdout) == len(pictures) * (PICTURE_HEAD.size + 640 * 480)


def test_it_can_open_nothing_besides_them():
    code = f"""
{KEPT_OPEN}
import errno, os
from {MODULE} import _limit
_limit()
os.dup(0)
try:
    os.open("/dev/null", os.O_RDONLY)
except OSError as error:
    print(errno.errorcode[error.errno])
"""
    command = [sys.executable, "-c", code]
    done = run_command(*command)
    assert done.stdout == "EMFILE\n"
