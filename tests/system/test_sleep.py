"""The machine sleeps in the middle of gestures, with the camera plugged in.

The camera is outside of the machine, at a USB controller of its own, which is reset when it wakes.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera, Identity
from neurotouch_devtools.emulator.usbredir import UsbRedir

from neurotouch_hid.source.replay import Replay
from tests.system import machine
from tests.system.conftest import CHOSEN, IN_CONTAINER, LACKS, SLEEP, TIME_LIMIT_S, compile_service
from tests.system.guest.camera import SERIAL, repeat
from tests.system.guest.sleeping import ASLEEP_S, SAW
from tests.system.image import ROOT, make_image

PACE = 0.1
"""A slice of 4 ms takes 40 ms, half of the silence at which the pad goes neutral; the guest, whose
clock is slower while it works, sees it faster."""


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> dict:
    if os.environ.get("NEUROTOUCH_SYSTEM_TEST") != "1":
        pytest.skip("boots a whole Debian, which takes minutes: make system-test")
    if IN_CONTAINER:
        pytest.skip(LACKS)
    if CHOSEN and SLEEP not in CHOSEN:
        pytest.skip(f"the chapter {SLEEP!r} was not chosen")
    results = tmp_path_factory.mktemp("slept")
    package = max((ROOT / "dist").glob("*.deb"), key=lambda path: path.stat().st_mtime)
    shutil.copy(package, results)
    image = make_image()
    compile_service(package, results / "compiled-service")
    port = results / "port"
    with Outside(results, make_camera(results), port) as outside:
        machine.boot(
            image,
            results,
            time_limit_s=TIME_LIMIT_S,
            program="tests.system.guest.sleeping",
            port=port,
            is_over=outside.is_over,
        )
    assert outside.answer, (results / "console.txt").read_text(errors="replace")[-3000:]
    answer = json.loads(outside.answer)
    assert "failed" not in answer, answer["failed"]
    return dict(answer["saw"])


def make_camera(results: Path) -> EmulatedCamera:
    """A camera that sees the scene over and over, in slow motion."""
    recording = results / "scene.aedat4"
    command = [sys.executable, "-m", "tests.system.scene", str(recording)]
    subprocess.run(command, cwd=ROOT, check=True)
    with Replay(recording) as source:
        packets = repeat(list(source))
    return EmulatedCamera(packets, CameraConfig(identity=Identity(serial=SERIAL), pace=PACE))


class Outside(ExitStack):
    """What happens outside of the machine: the camera is plugged in once the package is there.

    Args:
        results: the folder of the machine.
        camera: the camera.
        port: the machine's USB port.

    Attributes:
        answer: what the guest has told at its console; empty before.
    """

    def __init__(self, results: Path, camera: EmulatedCamera, port: Path) -> None:
        super().__init__()
        self.answer = ""
        self._results, self._camera, self._port = results, camera, port
        self._is_plugged = False

    def is_over(self) -> bool:
        """Looks at the machine; whether it has told what it saw."""
        if not self._is_plugged:
            if (self._results / "installed.json").exists():
                self.enter_context(UsbRedir(self._camera, self._port))
                self._is_plugged = True
            return False
        console = (self._results / "console.txt").read_text(errors="replace")
        found = re.search(rf"(?m)^{SAW}(.*)\r?\n", console)
        self.answer = found[1] if found else ""
        return bool(found)


def test_it_slept_with_the_camera_in(seen):
    assert len(seen["nights"]) == 3
    assert all(night["slept_s"] >= ASLEEP_S - 1.5 for night in seen["nights"])


def test_the_pad_is_neutral_when_it_wakes(seen):
    assert all(night["neutral_after_s"] < 0.1 for night in seen["nights"])


def test_it_plays_again_by_itself_in_the_same_process(seen):
    assert seen["same"]
    assert seen["status"]["errors"] == []
