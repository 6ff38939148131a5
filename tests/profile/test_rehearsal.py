"""Scripted gestures: what the words mean, and what is said about words that mean nothing."""

import math

import numpy as np
import pytest

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile import Mapping, load_profile, perform, rehearse
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.profile.rehearsal.script import parse_script


def test_a_push_rises_holds_and_falls() -> None:
    gestures = list(rehearse("push left 5mm 300ms hold 1s"))
    assert [gesture.t_us for gesture in gestures] == [10_000 * i for i in range(190)]
    size = [gesture.intensity_mm for gesture in gestures]
    assert size[15] == pytest.approx(2.5)
    assert size[30:131] == [5.0] * 101
    assert size[145] == pytest.approx(2.5)
    assert not any(size[160:])
    assert gestures[60].kind == GestureKind.PUSH
    assert gestures[60].translation_mm == pytest.approx((-5.0, 0.0))
    assert {gesture.kind for gesture in gestures[160:]} == {GestureKind.NONE}


def test_options() -> None:
    held = list(rehearse("zoom 4 mm 0ms hold 100ms fingers 3 at -10 5.5"))[5]
    assert (held.kind, len(held.contacts_mm), held.intensity_mm) == (GestureKind.ZOOM, 3, 4.0)
    assert held.contacts_mm.mean(axis=0) == pytest.approx((-10.0, 5.5))
    assert held.scale > 1.0
    turned = list(rehearse("push 30deg 6mm 0ms hold 100ms"))[5]
    assert math.degrees(math.atan2(*turned.translation_mm[::-1])) == pytest.approx(30.0)
    trembling = list(rehearse("pinch 5mm 0ms hold 1s release 0ms tremor 5hz 1mm"))[:100]
    assert np.ptp([gesture.intensity_mm for gesture in trembling]) == pytest.approx(2.0, abs=0.01)


def test_lines_semicolons_comments_and_case() -> None:
    steps = parse_script("# nothing\nPush UP 3mm # away\n\nrest 1.5s; twist_ccw tap\n")
    assert [step.kind.label for step in steps] == ["push", "none", "twist_ccw"]
    assert steps[1].length_us == 1_500_000


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("psh left", "'psh' is no gesture"),
        ("push lft 3mm", "'lft' is not understood"),
        ("push left 3mm hold", "a number in ms or s is missing"),
        ("push left 3mm hold 3mm", "a number in ms or s is missing"),
        ("5mm push", "5mm is where a word belongs"),
        ("push left 5mm 100ms 200ms", "200ms is where a word belongs"),
        ("push left ☃", "'☃' is not understood"),
        ("rest", "a number in ms or s is missing"),
        ("rest 1000s", "at most 1000 steps and takes 10 minutes"),
        ("rest 1ms;" * 1001, "at most 1000 steps and takes 10 minutes"),
    ],
)
def test_what_means_nothing(text: str, sentence: str) -> None:
    with pytest.raises(ProfileError) as caught:
        list(rehearse(text))
    assert sentence in caught.value.message
    assert caught.value.message.isprintable()


def test_the_timeline_of_a_shipped_profile() -> None:
    mapping = Mapping(load_profile(find_shipped_folder() / "keyboard-arrows.yaml"))
    script = "push left 5mm hold 200ms; rest 100ms; pinch 5mm tap; rest 200ms; pinch 5mm hold 900ms"
    assert [str(moment) for moment in perform(mapping, rehearse(script))] == GOLDEN.splitlines()


GOLDEN = """\
   0.000 s  rest
   0.030 s  push left
   0.090 s  key left down
   0.460 s  key left up
   0.480 s  rest
   0.610 s  pinch
   0.720 s  rest; key enter down; ignored: pinch hold -> key space, because held 90 ms < 350 ms
   0.770 s  key enter up
   0.950 s  pinch
   1.360 s  key space down
   2.080 s  key space up; ignored: pinch tap -> key enter, because lasted 1070 ms > 220 ms
   2.100 s  rest"""


def test_twist_cw_is_said_in_two_words_as_everywhere() -> None:
    assert parse_script("Twist cw 5mm; twist ccw") == parse_script("twist_cw 5mm; twist_ccw")
