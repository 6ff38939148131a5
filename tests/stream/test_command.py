"""``neurotouch stream`` as a process, beside a driver that starts, ends and is killed."""

import os
import signal
import socket
import time

import pytest
from pythonosc.osc_packet import OscPacket

from tests.processes import LIMIT_S, run_neurotouch, start_neurotouch


@pytest.fixture
def ear():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
        made.bind(("127.0.0.1", 0))
        made.settimeout(LIMIT_S)
        yield made


@pytest.fixture
def start(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    made = []

    def start(*words):
        made.append(start_neurotouch(*words, stderr=None))
        return made[-1]

    yield start
    for each in made:
        each.kill()
        each.wait()
        each.stdout.close()


def hear_until(ear, address, wanted):
    deadline = time.monotonic() + LIMIT_S
    while time.monotonic() < deadline:
        for each in OscPacket(ear.recv(65536)).messages:
            if each.message.address == address and wanted(each.message.params[0]):
                return
    pytest.fail(f"nothing of the kind at {address}")


def test_a_stream_outlives_drivers_and_ends_at_rest(ear, start):
    driver = ("run", "--source", "sim:push", "--device", "memory", "--show", "nothing")
    stream = start("stream", f"osc://127.0.0.1:{ear.getsockname()[1]}")
    hear_until(ear, "/neurotouch/state", "ended".__eq__)
    for end in (signal.SIGKILL, signal.SIGTERM):  # once without a goodbye
        playing = start(*driver)
        hear_until(ear, "/neurotouch/gesture", "push".__eq__)
        playing.send_signal(end)
        hear_until(ear, "/neurotouch/state", "ended".__eq__)
    start(*driver)
    hear_until(ear, "/neurotouch/gesture", "push".__eq__)
    stream.send_signal(signal.SIGINT)
    hear_until(ear, "/neurotouch/state", "ended".__eq__)
    assert stream.wait(LIMIT_S) == 130
    said = stream.stdout.read().splitlines()
    assert said[0].startswith("Streaming to osc://127.0.0.1:")
    assert said[1:] == 2 * ["Waiting for a driver.", "A driver plays."] + [
        "Waiting for a driver.",
        "A driver plays.",
    ]


def test_an_end_by_time_is_no_failure(ear, start):
    port = ear.getsockname()[1]
    assert start("stream", f"osc://127.0.0.1:{port}", "--seconds", "0.5").wait(LIMIT_S) == 0


@pytest.mark.parametrize(
    ("words", "why", "code"),
    [
        (
            ["midi"],
            "'midi' is no address to stream to. Use osc://HOST:PORT",
            2,
        ),
        (["ros2"], "There is no ROS 2 here", 1),
        (["ros2", "--seconds", "5"], "The ROS 2 node has no --rate and no --seconds.", 2),
        (["osc", "--rate", "61"], "61", 2),
    ],
)
def test_a_wrong_word_is_explained(words, why, code):
    run = run_neurotouch("stream", *words, code=code)
    assert why in run.stderr


def test_ros2_is_run_and_its_exit_code_is_ours(tmp_path):
    program = tmp_path / "ros2"
    program.write_text('#!/bin/sh\necho "$@"\nexit 3\n')
    program.chmod(0o755)
    run = run_neurotouch(
        "stream",
        "ros2",
        "--markers",
        code=None,
        env={**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"},
    )
    assert run.stdout == "run neurotouch_ros publish --ros-args -p markers:=true\n"
    assert run.returncode == 3
