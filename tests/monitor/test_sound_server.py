"""Sound through real servers: what reaches a sink is recorded and listened to.

Runs where the servers and their programs are installed (pulseaudio, pulseaudio-utils; pipewire,
pipewire-bin, wireplumber, dbus; speech-dispatcher with espeak-ng); none needs a sound card.
"""

import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from neurotouch_hid.monitor.cue import Cue, CueKind
from neurotouch_hid.monitor.sound_programs import play_cue
from neurotouch_hid.monitor.tone import PATTERNS, RATE_HZ
from tests.waiting import wait_until

LIMIT_S = 60.0
FORMAT = (f"--rate={RATE_HZ}", "--channels=1")
SINK = (
    "{factory.name=support.null-audio-sink node.name=ear media.class=Audio/Sink "
    "object.linger=true audio.position=[MONO]}"
)


def need(*programs: str) -> None:
    missing = [name for name in programs if shutil.which(name) is None]
    if missing:
        pytest.skip(f"not installed: {', '.join(missing)}")


def succeeds(*command: str) -> bool:
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def read(*command: str) -> bytes:
    return subprocess.run(command, capture_output=True, check=False).stdout


@pytest.fixture
def runtime(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty home; its path is short, for it holds sockets."""
    with tempfile.TemporaryDirectory(prefix="nt-") as name:
        for variable in ("XDG_RUNTIME_DIR", "HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME"):
            monkeypatch.setenv(variable, name)
        monkeypatch.delenv("PULSE_SERVER", raising=False)
        yield Path(name)


class Machine:
    """Starts programs, and ends them in the opposite order."""

    def __init__(self, stack: ExitStack) -> None:
        self._stack = stack

    def start(self, *command: str) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        self._stack.callback(self._end, process)
        return process

    @staticmethod
    def _end(process: subprocess.Popen[bytes]) -> None:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGTERM)
        process.wait(LIMIT_S)


@pytest.fixture
def machine() -> Iterator[Machine]:
    with ExitStack() as stack:
        yield Machine(stack)


@pytest.fixture
def pulse(runtime: Path, machine: Machine, monkeypatch: pytest.MonkeyPatch) -> Path:
    """PulseAudio with a sink that nobody hears; gives the file that is recorded from it."""
    need("pulseaudio", "pactl", "paplay", "parecord")
    socket = runtime / "native"
    machine.start(
        *("pulseaudio", "-n", "--daemonize=no", "--use-pid-file=no", "--exit-idle-time=-1"),
        *("--disable-shm=yes", "-L", f"module-native-protocol-unix socket={socket}"),
        *("-L", f"module-null-sink sink_name=ear rate={RATE_HZ} channels=1"),
    )
    monkeypatch.setenv("PULSE_SERVER", f"unix:{socket}")
    wait_until(lambda: succeeds("pactl", "info"))
    recorded = runtime / "heard.wav"
    machine.start(
        *("parecord", "--device=ear.monitor", "--format=s16le", "--latency-msec=20", *FORMAT),
        *("--file-format=wav", str(recorded)),
    )
    wait_until(lambda: recorded.exists() and recorded.stat().st_size > 10_000)
    return recorded


@pytest.fixture
def pipewire(runtime: Path, machine: Machine, monkeypatch: pytest.MonkeyPatch) -> Path:
    """PipeWire in the same way."""
    need("pipewire", "wireplumber", "pw-cli", "pw-play", "pw-record", "dbus-daemon")
    bus = f"unix:path={runtime}/bus"
    machine.start("dbus-daemon", "--session", "--nofork", f"--address={bus}")
    monkeypatch.setenv("DBUS_SESSION_BUS_ADDRESS", bus)
    wait_until((runtime / "bus").exists)
    machine.start("pipewire")
    wait_until(lambda: succeeds("pw-cli", "info", "0"))
    machine.start("wireplumber")
    wait_until(lambda: succeeds("pw-cli", "create-node", "adapter", SINK))
    wait_until(lambda: b'"ear"' in read("pw-cli", "ls", "Node"))
    recorded = runtime / "heard.wav"
    machine.start(
        *("pw-record", "--target", "ear", "-P", "{stream.capture.sink=true}", "--format=s16"),
        *(*FORMAT, str(recorded)),
    )
    wait_until(lambda: recorded.exists() and recorded.stat().st_size > 10_000)
    return recorded


def listen(recorded: Path) -> NDArray[np.float64]:
    """What has been heard so far, from the first sound to the last."""
    content = recorded.read_bytes()
    samples = np.frombuffer(content[44 : len(content) // 2 * 2], "<i2").astype(float)
    loud = np.flatnonzero(np.abs(samples) > 300)
    return samples[loud[0] : loud[-1]] if loud.size else samples[:0]


def find_pitch(samples: NDArray[np.float64]) -> float:
    spectrum = np.abs(np.fft.rfft(samples * np.hanning(len(samples)), 1 << 18))
    return float(np.fft.rfftfreq(1 << 18, 1 / RATE_HZ)[spectrum.argmax()])


@pytest.mark.parametrize("server", ["pulse", "pipewire"])
def test_a_tone_is_heard_as_it_was_made(server: str, request: pytest.FixtureRequest) -> None:
    recorded = request.getfixturevalue(server)
    kind = CueKind.PAUSE
    notes = PATTERNS[kind]
    outcome = play_cue(Cue(kind, "paused"), "tones", 80)
    assert outcome.played, outcome.sentence
    n_whole = round(sum(seconds for _, seconds in notes) * RATE_HZ)
    wait_until(lambda: len(listen(recorded)) > 0.9 * n_whole)
    samples = listen(recorded)
    first, last = (round(0.6 * seconds * RATE_HZ) for _, seconds in notes)
    assert len(samples) < 2 * n_whole  # a busy machine may leave gaps
    assert find_pitch(samples[:first]) == pytest.approx(notes[0][0], abs=15.0)
    assert find_pitch(samples[-last:]) == pytest.approx(notes[1][0], abs=15.0)


def test_words_are_spoken(pulse: Path, runtime: Path) -> None:
    need("spd-say", "speech-dispatcher", "espeak-ng")
    try:
        outcome = play_cue(Cue(CueKind.PAUSE, "paused"), "speech", 80)
        assert outcome.played, outcome.sentence
        wait_until(lambda: len(listen(pulse)) > 0.3 * RATE_HZ)
    finally:
        for file in runtime.rglob("speech-dispatcher.pid"):
            os.kill(int(file.read_text()), signal.SIGTERM)
