"""A gesture that nearly did something is told, and nothing else."""

import pytest

from neurotouch_hid.profile import Mapping, perform, rehearse
from neurotouch_hid.profile.reading.load import parse_profile

PROFILE = b"""\
version: 1
name: mine
filter: none
bindings:
  - {when: {gesture: pinch, on_mm: 7.0}, do: {button: a}}
  - {when: {gesture: zoom, level: soft}, do: {button: x}}
  - {when: {gesture: zoom, level: hard}, do: {button: y}}
  - {when: {gesture: push, on_mm: 7.0, direction: up}, do: {button: b}}
  - {when: twist_cw, do: {axis: right_x, sign: "+"}}
  - {when: {gesture: twist_cw, on_mm: 10.0}, do: {button: rb}}
  - {when: {gesture: push, direction: left}, do: {axis: left_x, sign: "-"}}
  - {when: {gesture: push, direction: right, on_mm: 4.0}, do: {trigger: right}}
"""


@pytest.mark.parametrize(
    ("script", "told"),
    [
        ("pinch 5.7mm 200ms hold 300ms", ["pinch from 7 mm -> button a: peak 5.7 mm < 7 mm"]),
        ("pinch 7.5mm 200ms hold 300ms", []),  # it acts
        (
            "pinch 6.98mm 200ms hold 300ms",
            ["pinch from 7 mm -> button a: peak 6.980 mm < 7 mm"],
        ),
        ("pinch 3mm 200ms hold 300ms", []),  # not meant for it
        ("zoom 5mm 200ms hold 300ms", []),  # the soft level acts
        ("zoom 2mm 200ms hold 300ms", ["zoom soft -> button x: peak 2.0 mm < 2.5 mm"]),
        ("push up 6mm 200ms hold 300ms", ["push up from 7 mm -> button b: peak 6.0 mm < 7 mm"]),
        ("push left 6mm 200ms hold 300ms", []),  # an axis has no threshold
        (
            "push right 3mm 200ms hold 300ms",
            ["push right from 4 mm -> trigger right: peak 3.0 mm < 4 mm"],
        ),
        ("push right 5mm 200ms hold 300ms", []),  # it acts
        ("twist_cw 5mm 200ms hold 300ms", []),  # meant for the axis beside the button
        (
            "twist_cw 9mm 200ms hold 300ms",
            ["twist cw from 10 mm -> button rb: peak 9.0 mm < 10 mm"],
        ),
        (
            "pinch 6mm 200ms; rest 500ms; pinch 6.5mm 200ms",
            [
                "pinch from 7 mm -> button a: peak 6.0 mm < 7 mm",
                "pinch from 7 mm -> button a: peak 6.5 mm < 7 mm",
            ],
        ),
    ],
)
def test_a_missed_threshold_is_told_once_when_the_gesture_ends(script, told):
    mapping = Mapping(parse_profile(PROFILE, "mine.yaml"))
    for gesture in rehearse(script + "; rest 500ms"):
        mapping.update(gesture)
    missed = [each for each in mapping.decisions() if each.verdict == "missed"]
    assert [f"{each.what}: {each.why}" for each in missed] == told


def test_a_rehearsal_shows_it():
    mapping = Mapping(parse_profile(PROFILE, "mine.yaml"))
    changes = [
        text
        for moment in perform(mapping, rehearse("pinch 5.7mm 200ms hold 300ms"))
        for text in moment.changes
    ]
    assert changes == ["missed: pinch from 7 mm -> button a, because peak 5.7 mm < 7 mm"]


def test_of_bindings_with_one_threshold_the_first_is_told():
    buttons = ("y", "rb", "a", "start", "x", "lb", "b", "back")
    lines = [f"  - {{when: {{gesture: pinch, on_mm: 7.0}}, do: {{button: {b}}}}}" for b in buttons]
    profile = "\n".join(["version: 1", "name: mine", "bindings:", *lines]).encode()
    mapping = Mapping(parse_profile(profile, "mine.yaml"))
    changes = [
        text
        for moment in perform(mapping, rehearse("pinch 6mm 300ms hold 1s"))
        for text in moment.changes
    ]
    assert changes == ["missed: pinch from 7 mm -> button y, because peak 6.0 mm < 7 mm"]
