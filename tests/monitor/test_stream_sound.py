"""What is heard of a driver's states, beside what the driver would play itself."""

import pytest

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.monitor.cue import Cue, CueKind
from neurotouch_hid.monitor.encoder import StateEncoder
from neurotouch_hid.monitor.sound import SoundMonitor
from neurotouch_hid.monitor.stream_sound import StreamSound
from neurotouch_hid.profile import UserSettings, rehearse
from neurotouch_hid.runtime import Pipeline, PipelineControl
from tests.monitor.stage import BUTTONS, FLICK, parse, turn

SCRIPT = f"{FLICK}; push right 8mm 100ms hold 1500ms; rest 1s; zoom 8mm 100ms hold 1500ms; rest 1s"


class Recorder:
    """A speaker that writes down what it is given."""

    def __init__(self, _announce) -> None:
        self.played = []

    def play(self, cue, mode, volume) -> None:
        self.played.append((cue, mode, volume))

    def close(self) -> None:
        pass


@pytest.fixture
def stage(monkeypatch):
    for name in ("sound", "stream_sound"):
        monkeypatch.setattr(f"neurotouch_hid.monitor.{name}.Speaker", Recorder)
    return Stage()


class Stage:
    """A driver that plays its sounds itself, and one that leaves it to another program."""

    def __init__(self, timing: str = "slow") -> None:
        user = {"filter": "none", "timing": timing, "feedback": {"sound": "tones"}}
        self.user = UserSettings.model_validate(user)
        pipeline = Pipeline.build(parse(BUTTONS), GestureConfig(), user=self.user)
        self.mapping = pipeline.mapping
        self.control = PipelineControl(pipeline, self.user)
        self.plays_sound = False
        self.encoder = StateEncoder(self.control, lambda: {"plays_sound": self.plays_sound})
        self.near = SoundMonitor(self.control, str)
        self.far = StreamSound(str)
        self.far.feedback = self.user.feedback

    def play(self, script: str, every: int = 1) -> None:
        for n, gesture in enumerate(rehearse(script)):
            step = turn(self.mapping, gesture)
            self.near(step)
            if n % every == 0:
                self.heard = self.far.hear(self.encoder.encode(self.encoder.take(step)))


@pytest.mark.parametrize("timing", ["slow", "game"])
def test_states_make_the_same_sounds_as_the_driver(stage, timing):
    stage = Stage(timing)
    stage.play(SCRIPT)
    assert stage.heard
    assert stage.far._speaker.played == stage.near._speaker.played
    kinds = {cue.kind for cue, _, _ in stage.far._speaker.played}
    wanted = {CueKind.PRESS, CueKind.LAYER}
    assert kinds >= wanted | ({CueKind.ACCEPT, CueKind.REJECT} if timing == "slow" else set())


def test_what_acted_between_two_states_is_heard_and_the_short_press_is_not(stage):
    stage = Stage("game")
    stage.far.feedback = stage.user.feedback.model_copy(
        update={"volume": stage.user.feedback.volume.model_copy(update={"accept": 50})}
    )
    stage.play(f"{FLICK}; rest 500ms", every=60)
    assert stage.far._speaker.played == [(Cue(CueKind.ACCEPT, "button a"), "tones", 50)]


def test_a_driver_that_plays_its_sounds_itself_is_not_heard_twice(stage):
    stage.plays_sound = True
    stage.play(SCRIPT)
    assert not stage.heard
    assert stage.near._speaker.played
    assert not stage.far._speaker.played


def test_after_a_gap_what_was_missed_is_not_told(stage):
    stage.play("rest 200ms")
    stage.mapping.pause()
    stage.far.forget()
    stage.play("rest 200ms")
    assert not stage.far._speaker.played
