"""How signals end ``neurotouch run`` on an emulated camera, under umockdev."""

import contextlib
import signal
import subprocess
import time

import pytest
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera

from tests.emulator.stage import plug_in
from tests.processes import start_neurotouch
from tests.source.davis.test_faults import make_scene
from tests.waiting import wait_until

pytestmark = pytest.mark.filterwarnings("ignore:DynamicImporter:ImportWarning")  # gi's own

RUN = ["run", "--source", "davis:", "--device", "memory", "--show", "nothing"]


@contextlib.contextmanager
def plugged():
    """A camera that sees noise for as long as a test may take, and its cable."""
    camera = EmulatedCamera(make_scene(6_000), CameraConfig(fifo_bytes=1 << 24))
    with plug_in(camera) as cable:
        yield camera, cable


@contextlib.contextmanager
def driver(cable):
    """The driver, killed in the end if it still runs."""
    process = start_neurotouch(*RUN, env=cable.environment, stderr=subprocess.STDOUT)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def test_signals_end_it_and_switch_the_camera_off():
    with plugged() as (camera, cable), driver(cable) as process:
        wait_until(lambda: camera.streaming, 180.0)
        process.send_signal(signal.SIGHUP)  # only loads the profile anew
        time.sleep(0.5)
        assert process.poll() is None
        assert camera.streaming
        process.terminate()
        process.terminate()
        assert process.wait(180) == 0, process.stdout.read()
        assert not camera.streaming
