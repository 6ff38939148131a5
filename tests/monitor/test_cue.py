"""What is heard, and how it sounds."""

import io
import itertools
import wave
from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.monitor.cue import Cue, CueFinder, CueKind, choose_volume, take_facts
from neurotouch_hid.monitor.tone import PATTERNS, RATE_HZ, make_wave
from neurotouch_hid.profile import Mapping, UserSettings, rehearse
from tests.monitor.stage import BUTTONS, FLICK, parse, turn

RAW = UserSettings(filter="none")


def hear(mapping: Mapping, script: str, start_us: int = 0) -> list[Cue]:
    finder = CueFinder(take_facts(None, mapping))
    cues = []
    for gesture in rehearse(script):
        step = turn(mapping, replace(gesture, t_us=gesture.t_us + start_us))
        cues += finder.find(take_facts(step, mapping))
    return cues


def test_what_acts_is_accepted_and_named() -> None:
    cues = hear(Mapping(parse(BUTTONS), RAW), "push left 8mm 100ms hold 200ms; rest 500ms")
    assert cues[0].kind in (CueKind.PRESS, CueKind.ACCEPT)
    assert Cue(CueKind.ACCEPT, "button a") in cues
    assert len(cues) == len(set(cues)) <= 2


def test_all_that_happens_in_one_turn_is_told() -> None:
    mapping = Mapping(parse(BUTTONS), RAW)
    finder = CueFinder(take_facts(None, mapping))
    turns = [
        finder.find(take_facts(turn(mapping, gesture), mapping)) for gesture in rehearse(FLICK)
    ]
    (cues,) = filter(None, turns)
    assert cues == [Cue(CueKind.ACCEPT, "button a"), Cue(CueKind.PRESS, "push")]


def test_what_nothing_waits_for_is_a_press_only() -> None:
    cues = hear(Mapping(parse(BUTTONS), RAW), "twist_cw 8mm 100ms hold 200ms; rest 500ms")
    assert cues == [Cue(CueKind.PRESS, "twist")]


def test_slow_keys_have_the_three_sounds_of_the_desktop() -> None:
    slow = UserSettings.model_validate({"filter": "none", "timing": "slow"})
    long = hear(Mapping(parse(BUTTONS), slow), "push left 8mm 100ms hold 1500ms; rest 1s")
    assert [cue.kind for cue in long] == [CueKind.PRESS, CueKind.ACCEPT]
    short = hear(Mapping(parse(BUTTONS), slow), "push left 8mm 100ms hold 100ms; rest 1s")
    assert [cue.kind for cue in short] == [CueKind.PRESS, CueKind.REJECT]


def test_a_layer_is_heard_by_its_name() -> None:
    cues = hear(Mapping(parse(BUTTONS), RAW), "push right 8mm 100ms hold 200ms; rest 500ms")
    assert Cue(CueKind.LAYER, "layer second") in cues
    kinds = [cue.kind for cue in cues]
    assert kinds.index(CueKind.LAYER) < kinds.index(CueKind.ACCEPT), "the most important first"


def test_while_paused_no_gesture_is_heard() -> None:
    mapping = Mapping(parse(BUTTONS), RAW)
    finder = CueFinder(take_facts(None, mapping))
    gestures = rehearse("rest 100ms; push left 8mm 100ms; rest 300ms")
    mapping.pause()
    assert [
        cue.kind
        for gesture in gestures
        for cue in finder.find(take_facts(turn(mapping, gesture), mapping))
    ] == [CueKind.PAUSE]


def test_pause_panic_and_their_end_are_heard_whoever_orders_them() -> None:
    mapping = Mapping(parse(BUTTONS), RAW)
    finder = CueFinder(take_facts(None, mapping))
    rest = list(rehearse("rest 100ms"))
    heard = []
    for order in (mapping.pause, mapping.pause, mapping.panic, mapping.resume):
        order()
        heard.append(finder.find(take_facts(turn(mapping, rest[0]), mapping)))
    assert [[cue.kind for cue in cues] for cues in heard] == [["pause"], [], ["panic"], ["resume"]]
    assert CueKind.PAUSE in [
        cue.kind for cue in hear(mapping, "rest 100ms; pinch 8mm 100ms hold 200ms; rest 300ms")
    ]


def test_another_mapping_of_another_profile_is_one_cue() -> None:
    mapping = Mapping(parse(BUTTONS), RAW)
    finder = CueFinder(take_facts(None, mapping))
    fresh = Mapping(parse(BUTTONS.replace("name: buttons", "name: my-own")), RAW)
    rest = list(rehearse("rest 100ms"))
    first, second = (finder.find(take_facts(turn(fresh, gesture), fresh)) for gesture in rest[:2])
    assert first == [Cue(CueKind.LAYER, "profile my own")]
    assert second == []


def test_a_lost_gel_is_heard_once_and_only_if_it_was_seen() -> None:
    mapping = Mapping(parse(BUTTONS), RAW)
    finder = CueFinder(take_facts(None, mapping))
    rest = rehearse("rest 200ms")
    seen = [0, 0, 177, 95, 89, 95, 85, 177, 60]
    heard = [
        finder.find(take_facts(turn(mapping, gesture, n), mapping))
        for gesture, n in zip(rest, seen, strict=False)
    ]
    assert [n for n, cues in enumerate(heard) if cues] == [4, 8]
    assert {cue.kind for cues in heard for cue in cues} == {CueKind.LOST}


def test_volumes_go_by_class_and_accept_is_silent_where_nothing_is_waited_for() -> None:
    volumes = UserSettings().feedback.volume
    assert choose_volume(CueKind.ACCEPT, volumes, waits=False) == 0
    assert choose_volume(CueKind.ACCEPT, volumes, waits=True) == 60
    own = UserSettings.model_validate(
        {"feedback": {"sound": "tones", "volume": {"accept": 10, "pause": 20, "press": 0}}}
    )
    wanted = {"accept": 10, "panic": 20, "pause": 20, "resume": 20, "press": 0, "lost": 80}
    chosen = own.feedback.volume
    assert {kind: choose_volume(CueKind(kind), chosen, waits=False) for kind in wanted} == wanted


def read(content: bytes) -> np.ndarray:
    with wave.open(io.BytesIO(content)) as file:
        assert (file.getnchannels(), file.getsampwidth()) == (1, 2)
        assert file.getframerate() == RATE_HZ
        return np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(float)


@pytest.mark.parametrize("kind", CueKind)
def test_each_note_has_its_pitch_and_no_click(kind: CueKind) -> None:
    samples = read(make_wave(kind, 100))
    assert 0.45 * 32767 < abs(samples).max() < 0.55 * 32767
    assert abs(np.diff(samples)).max() < 0.2 * 32767 * 0.5
    begin = 0
    for frequency_hz, duration_s in PATTERNS[kind]:
        note = samples[begin : begin + round(duration_s * RATE_HZ)]
        begin += len(note)
        spectrum = abs(np.fft.rfft(note * np.hanning(len(note)), 1 << 17))
        assert spectrum.argmax() * RATE_HZ / (1 << 17) == pytest.approx(frequency_hz, rel=0.02)
    assert begin == len(samples) <= 0.6 * RATE_HZ


def test_no_two_cues_sound_alike() -> None:
    assert set(PATTERNS) == set(CueKind)
    for one, other in itertools.combinations(PATTERNS.values(), 2):
        differ = len(one) != len(other) or any(
            max(a, b) / min(a, b) > 1.12  # two semitones
            for (a, _), (b, _) in zip(one, other, strict=True)
        )
        assert differ, (one, other)


def test_half_the_volume_is_half_the_amplitude() -> None:
    loud, soft = (abs(read(make_wave(CueKind.PAUSE, volume))).max() for volume in (100, 50))
    assert soft == pytest.approx(loud / 2, rel=0.01)
