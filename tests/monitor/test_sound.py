"""Sound through the programs of the desktop: here programs that write down what they are given."""

import stat
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.monitor import SoundMonitor
from neurotouch_hid.monitor.cue import Cue, CueKind
from neurotouch_hid.monitor.sound_programs import play_cue
from neurotouch_hid.monitor.tone import make_wave
from neurotouch_hid.profile import Mapping, UserSettings, rehearse
from neurotouch_hid.runtime import Pipeline, PipelineControl
from tests.monitor.stage import BUTTONS, FLICK, parse, turn
from tests.waiting import wait_until

LIMIT_S = 60.0
PAUSE = Cue(CueKind.PAUSE, "paused")


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], None]:
    """Puts shell scripts on an otherwise empty PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))
    patience_s = dict.fromkeys(("tones", "speech"), LIMIT_S)
    monkeypatch.setattr("neurotouch_hid.monitor.sound_programs.PATIENCE_S", patience_s)

    def put(name: str, script: str) -> None:
        file = folder / name
        file.write_text(f"#!/bin/sh\nPATH=/usr/bin:/bin\n{script}\n")
        file.chmod(file.stat().st_mode | stat.S_IXUSR)

    return put


class Stage:
    """A line that is turned by hand, and somebody who listens."""

    def __init__(self, user: UserSettings) -> None:
        profile = parse(BUTTONS)
        self.pipeline = Pipeline.build(profile, GestureConfig(), user=user)
        self.said: list[str] = []
        self.control = PipelineControl(self.pipeline, user)
        self.sound = SoundMonitor(self.control, self.said.append)

    @property
    def mapping(self) -> Mapping:
        return self.pipeline.mapping

    def turn(self) -> None:
        self.sound(turn(self.mapping, next(rehearse("rest 50ms"))))


def feedback(sound: str, **volume: int) -> UserSettings:
    return UserSettings.model_validate({"feedback": {"sound": sound, "volume": volume}})


def test_the_player_is_given_the_tone_as_a_file(programs, tmp_path: Path) -> None:
    programs("paplay", f'cat "$1" > {tmp_path}/heard; echo "$@" > {tmp_path}/asked')
    outcome = play_cue(PAUSE, "tones", 70)
    assert outcome.played
    assert outcome.sentence == "tones through paplay"
    assert (tmp_path / "heard").read_bytes() == make_wave(CueKind.PAUSE, 70)
    assert (tmp_path / "asked").read_text() == "/dev/stdin --latency-msec=50\n"


def test_the_next_player_is_asked_where_one_fails(programs, tmp_path: Path) -> None:
    programs("pw-play", "exit 3")
    programs("aplay", f'cat "$2" > {tmp_path}/heard')
    assert play_cue(PAUSE, "tones", 70).sentence == "tones through aplay"
    assert (tmp_path / "heard").read_bytes() == make_wave(CueKind.PAUSE, 70)


def test_what_fails_is_a_sentence(programs, tmp_path: Path) -> None:
    assert play_cue(PAUSE, "tones", 70).sentence.endswith("paplay and aplay is installed")
    programs("paplay", "exit 1")
    programs("aplay", "")
    (tmp_path / "bin" / "aplay").write_text("#!/nowhere")
    assert play_cue(PAUSE, "tones", 70).sentence.endswith(
        "aplay cannot be started (No such file or directory)"
    )
    (tmp_path / "bin" / "aplay").unlink()
    assert play_cue(PAUSE, "tones", 70).sentence == "no tones: paplay ended with code 1"
    assert "speech-dispatcher" in play_cue(PAUSE, "speech", 70).sentence


def test_speech_is_given_the_words_and_the_volume(programs, tmp_path: Path) -> None:
    programs("spd-say", f"printf '%s\\n' \"$@\" > {tmp_path}/asked")
    assert play_cue(Cue(CueKind.LAYER, "-w two words"), "speech", 80).played
    assert (tmp_path / "asked").read_text().splitlines()[-3:] == [
        "--volume=60",
        "--",
        "-w two words",
    ]


@pytest.fixture
def impatient(programs, monkeypatch: pytest.MonkeyPatch) -> None:
    """Programs that do not end are ended; longer than a machine stands still for a moment."""
    monkeypatch.setattr("neurotouch_hid.monitor.sound_programs.PATIENCE_S", {"tones": 5.0})


@pytest.mark.usefixtures("impatient")
def test_a_player_that_hangs_is_ended_with_its_children(programs, tmp_path: Path) -> None:
    programs("paplay", f"sleep 300 & echo $! > {tmp_path}/child; wait")
    assert play_cue(PAUSE, "tones", 70).sentence == "no tones: paplay does not end"
    child = Path("/proc") / (tmp_path / "child").read_text().strip() / "stat"
    wait_until(lambda: not child.exists() or child.read_text().rsplit(")", 1)[1].split()[0] == "Z")


def test_pause_and_resume_are_played_and_silence_is_kept(programs, tmp_path: Path) -> None:
    programs("aplay", f"wc -c >> {tmp_path}/heard; cat $2 > /dev/null")
    stage = Stage(feedback("tones", pause=50))
    heard = tmp_path / "heard"
    for n, order in enumerate((stage.mapping.pause, stage.mapping.resume), start=1):
        order()
        stage.turn()
        stage.turn()
        wait_until(lambda n=n: heard.exists() and len(heard.read_text().splitlines()) == n)
    wait_until(lambda: stage.sound.describe() == "tones through aplay")
    stage.sound.close()
    sizes = [int(line) for line in heard.read_text().split()]
    assert sizes == [len(make_wave(kind, 50)) for kind in (CueKind.PAUSE, CueKind.RESUME)]
    assert stage.said == []


@pytest.mark.parametrize("user", [UserSettings(), feedback("tones", pause=0)])
def test_nothing_is_started_where_nothing_is_wanted(programs, tmp_path: Path, user) -> None:
    programs("aplay", f"touch {tmp_path}/heard")
    stage = Stage(user)
    stage.mapping.pause()
    stage.turn()
    stage.sound.close()
    assert stage.sound.describe() == user.feedback.sound
    assert not (tmp_path / "heard").exists()


def test_other_values_of_the_person_hold_at_once(programs, tmp_path: Path) -> None:
    programs("aplay", f"touch {tmp_path}/heard")
    stage = Stage(UserSettings())
    stage.control.switch(parse(BUTTONS), feedback("tones"))
    stage.control.apply_commands()
    stage.mapping.panic()
    stage.turn()
    wait_until((tmp_path / "heard").exists)
    stage.sound.close()


def test_a_silent_class_hides_no_other(programs, tmp_path: Path) -> None:
    programs("aplay", f"wc -c >> {tmp_path}/heard")
    stage = Stage(feedback("tones"))  # the timing is game: what acts at once is not heard
    for gesture in rehearse(FLICK):
        stage.sound(turn(stage.mapping, gesture))
    heard = tmp_path / "heard"
    wait_until(lambda: heard.exists() and heard.read_text().endswith("\n"))
    stage.sound.close()
    assert heard.read_text().split() == [str(len(make_wave(CueKind.PRESS, 30)))]


def test_a_missing_player_is_said_once(programs) -> None:
    stage = Stage(feedback("speech"))
    for _ in range(3):
        for order in (stage.mapping.pause, stage.mapping.resume):
            order()
            stage.turn()
            time.sleep(0.05)
    wait_until(lambda: bool(stage.said))
    stage.sound.close()
    (sentence,) = stage.said
    assert sentence == f"Warning: {stage.sound.describe()}."
    assert "spd-say is not installed" in sentence


@pytest.mark.usefixtures("impatient")
def test_a_player_that_hangs_holds_up_nobody_and_the_newest_cue_follows(
    programs, tmp_path: Path
) -> None:
    go_on = tmp_path / "go on"
    programs(
        "aplay",
        f"[ -e '{go_on}' ]; hang=$?; wc -c >> {tmp_path}/heard; [ $hang = 0 ] || exec sleep 300",
    )
    stage = Stage(feedback("tones"))
    heard = tmp_path / "heard"
    stage.mapping.pause()
    stage.turn()
    wait_until(heard.exists)
    go_on.touch()
    done = threading.Event()

    def play() -> None:
        for _ in range(100):
            for order in (stage.mapping.resume, stage.mapping.pause):
                order()
                stage.turn()
        stage.mapping.panic()
        stage.turn()
        done.set()

    threading.Thread(target=play, daemon=True).start()
    assert done.wait(LIMIT_S)
    wait_until(lambda: heard.read_text().split()[-1:] == [str(len(make_wave(CueKind.PANIC, 80)))])
    stage.sound.close()
    assert stage.said == ["Warning: no tones: aplay does not end."]
    assert len(heard.read_text().split()) < 20, "of 201 cues"
    assert np.all([thread.name != "sound" for thread in threading.enumerate()])
