"""Both USB libraries as they are, on an emulated camera under umockdev."""

import json
import os
import sys

import numpy as np
import pytest
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera, Fault
from neurotouch_devtools.emulator.umockdev import PRELOAD

from tests.emulator.stage import plug_in
from tests.processes import run_command
from tests.source.davis.player import fingerprint
from tests.source.davis.test_faults import make_scene

pytestmark = pytest.mark.filterwarnings("ignore:DynamicImporter:ImportWarning")  # gi's own

SCENE = make_scene(20)
EVENTS = np.concatenate([packet.events for packet in SCENE])
N_EVENTS = len(EVENTS)
N_FRAMES = sum(len(packet.frames) for packet in SCENE)


def play(library, *faults, n_events=N_EVENTS):
    """What a driver in a process of its own saw of the scene."""
    config = CameraConfig(await_reset=True, unpaced=True)
    camera = EmulatedCamera(SCENE, config, [Fault.parse(fault) for fault in faults])
    with plug_in(camera) as bed:
        done = run_command(
            sys.executable,
            "-m",
            "tests.source.davis.player",
            library,
            n_events,
            code=None,
            env=bed.environment,
        )
    assert done.returncode == 0, done.stderr
    return {**json.loads(done.stdout), "errors": done.stderr}


@pytest.mark.parametrize("library", ["libusb1", "pyusb"])
def test_all_events_and_frames_arrive(library):
    said = play(library)
    assert said["n_events"] == N_EVENTS
    assert said["fingerprint"] == fingerprint(EVENTS)
    assert said["n_frames"] >= N_FRAMES - 1  # the last one may follow the last event
    assert (said["gap"], said["n_faults"], said["n_connects"]) == (0, 0, 1)


@pytest.mark.parametrize(
    ("library", "fault"),
    [
        *(("libusb1", fault) for fault in ("stall+9", "protocol+9x150", "babble+9")),
        ("pyusb", "stall+9"),
    ],
)
def test_play_goes_on_after_a_fault_and_says_that_something_is_missing(library, fault):
    said = play(library, fault, n_events=N_EVENTS // 2)
    assert said["n_events"] >= N_EVENTS // 2
    assert said["gap"] >= 1
    assert said["n_faults"] >= 1
    assert said["n_connects"] == 1


def test_libusb_tells_at_once_that_a_camera_comes_or_goes():
    with plug_in(EmulatedCamera([])):  # or it is skipped
        pass
    done = run_command(
        sys.executable,
        "-m",
        "tests.source.davis.hotplug",
        env={**os.environ, "LD_PRELOAD": PRELOAD},
        timeout=900,
    )
    assert json.loads(done.stdout) == ["heard"] * 6


@pytest.mark.parametrize("n", [1, 2, 64, 127])
def test_transfers_that_linux_has_lost_hold_up_neither_play_nor_the_end(n):
    said = play("libusb1", f"lost+5x{n}")
    assert said["fingerprint"] == fingerprint(EVENTS)
    assert (said["gap"], said["n_faults"], said["n_connects"]) == (0, 0, 1)
    assert f"Linux does not give back {n} of the camera's transfers." in said["errors"]


@pytest.mark.parametrize("library", ["libusb1", "pyusb"])
def test_unplugging_in_mid_stream_ends_cleanly(library):
    said = play(library, "unplug+22")
    assert said["trouble"]
    assert 0 < said["n_events"] < N_EVENTS
