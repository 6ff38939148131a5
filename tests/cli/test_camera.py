"""``devices``, ``doctor``, ``record`` and ``neurotouch`` alone, with an emulated camera plugged in.

umockdev stands between the programs and the system: they see a camera's sysfs and usbfs.
"""

import json
import os
import signal
import subprocess

import pytest
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera, Fault, Identity

from tests.cli.test_record import LIMIT_S, wait_for_size
from tests.emulator.stage import SCENE, finish, plug_in, run, start
from tests.recording.test_writer import count, count_with_the_maker
from tests.waiting import wait_until

pytestmark = pytest.mark.filterwarnings("ignore:DynamicImporter:ImportWarning")  # gi's own


@pytest.fixture
def plug(tmp_path):
    cables = []

    def plug(*faults, **identity):
        config = CameraConfig(identity=Identity(**identity), unpaced=True, await_reset=True)
        faults = [Fault.parse(fault) for fault in faults]
        cables.append(plug_in(EmulatedCamera(SCENE, config, faults)))
        return cables[-1]

    yield plug
    for cable in cables:
        cable.close()


def test_devices(plug):
    said = json.loads(run(plug(serial="00000216"), "-m", "neurotouch_hid", "devices", "--json"))
    (camera,) = said["cameras"]
    assert camera["serial"] == "00000216"
    assert camera["speed_mbit_s"] == 5000
    assert camera["reason"] is None
    assert camera["versions"]["firmware"] == 6
    assert camera["versions"]["logic"] == 18
    plain = run(plug(serial="00000216"), "-m", "neurotouch_hid", "devices")
    assert plain.startswith("OK camera 00000216: ")
    assert "  speed: 5000 Mbit/s (USB 3)\n" in plain
    assert "  use it: --source davis:00000216\n" in plain


def test_alone_it_is_ready(plug, monkeypatch, tmp_path):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    said = run(plug(), "-m", "neurotouch_hid")
    if not os.access("/dev/uinput", os.R_OK | os.W_OK):
        assert said.startswith("Camera found, but no gamepad can be made. Fix: neurotouch setup\n")
        return
    assert said.startswith("Ready. Next: neurotouch calibrate (about 3 minutes, no time limit)\n")
    (tmp_path / "neurotouch").mkdir()
    (tmp_path / "neurotouch/user.yaml").write_text("version: 1\nrange: {zoom: {full: 3}}\n")
    assert run(plug(), "-m", "neurotouch_hid").startswith("Ready. Next: neurotouch run\n")


def test_record(plug, monkeypatch, tmp_path):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    path = tmp_path / "a.aedat4"
    arguments = ("record", str(path), "--source", "davis:216", "--json")
    process = start(plug(serial="00000216"), "-m", "neurotouch_hid", *arguments)
    events = sum(len(packet.events) for packet in SCENE)
    frames = sum(len(packet.frames) for packet in SCENE)
    wait_for_size(path, 89_960 * frames, process)
    wait_for_count(path, (events, frames))
    process.send_signal(signal.SIGINT)
    said = json.loads(finish(process))
    assert said["source"] == "davis:00000216"
    assert (said["events"], said["frames"]) == (events, frames)
    assert said["lost_before"] == said["lost_here"] == 0
    assert count(path) == count_with_the_maker(path) == (events, frames)


def test_a_recording_of_a_stream_out_of_step_is_not_ok(plug, monkeypatch, tmp_path):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    path = tmp_path / "a.aedat4"
    arguments = ("record", str(path), "--source", "davis:", "--seconds", "4", "--json")
    process = start(plug("missing+9"), "-m", "neurotouch_hid", *arguments)
    said, errors = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, errors
    assert errors.count("the camera is started again") == 1
    said = json.loads(said)
    assert said["status"] == "WARNING"
    assert said["lost_before"] >= 1
    assert 4.0 <= said["seconds"] < 10.0  # of the true clock


def wait_for_count(path, expected):
    wait_until(lambda: count(path) == expected)  # readable at every moment


def test_a_recording_outlives_its_camera(plug, monkeypatch, tmp_path):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    path = tmp_path / "a.aedat4"
    cable = plug()
    process = start(cable, "-m", "neurotouch_hid", "record", str(path), "--source", "davis:")
    wait_for_size(path, 100_000, process)
    cable.unplug()
    with pytest.raises(subprocess.TimeoutExpired):  # it waits for the camera to come back
        process.wait(1.5)
    process.send_signal(signal.SIGTERM)
    said, errors = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, errors
    assert "Traceback" not in errors
    events, frames = count(path)
    assert count_with_the_maker(path) == (events, frames)
    assert f"{events:,} events, {frames} frames" in said


def test_a_recording_goes_on_when_its_camera_is_back(plug, monkeypatch, tmp_path):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    path = tmp_path / "a.aedat4"
    cable = plug()
    process = start(
        cable, "-m", "neurotouch_hid", "record", str(path), "--source", "davis:", "--json"
    )
    events = sum(len(packet.events) for packet in SCENE)
    frames = sum(len(packet.frames) for packet in SCENE)
    wait_for_size(path, 89_960 * frames, process)
    wait_for_count(path, (events, frames))
    cable.unplug()
    cable.plug(EmulatedCamera(SCENE, cable.camera.config))
    wait_for_count(path, (2 * events, 2 * frames))
    process.send_signal(signal.SIGINT)
    said = json.loads(finish(process))
    assert said["status"] == "WARNING"
    assert said["lost_before"] >= 1  # what nobody saw meanwhile
    assert count(path) == count_with_the_maker(path) == (2 * events, 2 * frames)


def test_doctor(plug, monkeypatch, tmp_path):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    process = start(
        plug(serial="00000216", super_speed=False), "-m", "neurotouch_hid", "doctor", "--json"
    )
    said, errors = process.communicate(timeout=LIMIT_S)
    assert "Traceback" not in errors
    rows = {row["check"]: row for row in json.loads(said)}
    assert rows["camera"]["status"] == "OK"
    assert "00000216" in rows["camera"]["sentence"]
    assert rows["right to the camera"]["status"] == "OK"
    assert "firmware 6, logic 18" in rows["right to the camera"]["sentence"]
    assert rows["USB"]["status"] == "WARNING"
    assert "480 Mbit/s instead of 5000" in rows["USB"]["sentence"]
    assert rows["events and frames"]["sentence"].startswith("davis:00000216: ")
    assert rows["markers"]["status"] == "FAILED"  # it shows noise
    assert rows["markers"]["sentence"].startswith("No gel can be found, ")
