"""Movements a person does not make: the engine leaves them out, check says what needs them."""

import pytest

from neurotouch_hid.messages import Axis
from neurotouch_hid.profile import Mapping, UserSettings, check_content, rehearse
from neurotouch_hid.profile.calibration import CalibrationSession, write_ranges
from neurotouch_hid.profile.editing import ProfileText
from neurotouch_hid.profile.reading.load import check_user, parse_profile
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.user import MovementRange

PROFILE = """\
version: 1
name: p
timing: game
bindings:
  - when: push
    do: {stick: left}
  - when: zoom
    do: {button: b}
  - when: {gesture: push, direction: up_left}
    do: {button: x}
  - when: twist
    do: {axis: right_x}
  - when: {sequence: [zoom, pinch]}
    do: {button: y}
  - when: any
    do: {key: alt+print}
safety:
  pause: {gesture: zoom}
"""


def play(script, *unused):
    mapping = Mapping(parse_profile(PROFILE.encode(), "p"), UserSettings(unused=list(unused)))
    return [mapping.update(gesture) for gesture in rehearse(script)]


def test_a_movement_that_is_not_made_does_nothing():
    assert any("b" in pad.buttons for pad in play("zoom 6mm 300ms hold 500ms"))
    pads = play("zoom 6mm 300ms hold 500ms", "zoom")
    assert all(pad.is_neutral for pad in pads)
    assert not any(pad.commands for pad in play("zoom 6mm 300ms hold 3s", "zoom"))


def test_a_push_has_no_part_in_a_way_that_is_not_used():
    pads = play("push left 8mm 300ms hold 300ms", "push_left")
    assert all(pad.axes.get(Axis.LEFT_X, 0.0) == 0.0 for pad in pads)
    pads = play("push up_left 8mm 300ms hold 300ms", "push_left")
    held = pads[40].axes
    assert held.get(Axis.LEFT_X, 0.0) == 0.0
    whole = play("push up_left 8mm 300ms hold 300ms")[40].axes
    straight = play("push up 5.66mm 300ms hold 300ms")[40].axes  # 8 mm, their part upwards
    assert held[Axis.LEFT_Y] == pytest.approx(straight[Axis.LEFT_Y], abs=0.02)
    assert whole[Axis.LEFT_X] < -0.3
    assert not any("x" in pad.buttons for pad in pads)
    pushes = [name for name in MOVEMENTS if name.startswith("push_")]
    assert all(pad.is_neutral for pad in play("push up 8mm 300ms hold 300ms", *pushes))


def test_a_gesture_that_was_recognised_is_kept_through_one_that_is_not_used():
    script = "twist_cw 6mm 300ms hold 300ms; zoom 6mm 50ms hold 100ms; rest 100ms"
    pads = play(script, "zoom")
    assert any(pad.axes.get(Axis.RIGHT_X, 0.0) > 0.5 for pad in pads)
    assert pads[-1].is_neutral


def warn(text, *unused):
    faults = check_content(text.encode(), "p.yaml", unused=unused).faults
    return [(f.path, f.sentence) for f in faults if f.code == "NT212"]


def test_check_warns_of_what_needs_a_movement_that_is_not_used():
    assert not warn(PROFILE)
    assert warn(PROFILE, "zoom") == [
        ("bindings[1].when", "you do not use zoom: this never acts"),
        ("bindings[4].when", "you do not use zoom: this never acts"),
        ("safety.pause", "you do not use this gesture: no pause by the gel"),
    ]
    assert warn(PROFILE, "push_left") == [
        ("bindings[0].when", "you do not use push left: this never goes that way"),
        ("bindings[2].when", "you do not use push left: this never acts"),
    ]
    assert warn(PROFILE, "twist_cw") == [
        ("bindings[3].when", "you do not use twist clockwise: this never goes that way")
    ]
    built = "version: 1\nname: p\nextends: [default]\n"
    assert warn(built, "zoom") == [
        ("extends", "what it is built on needs zoom, which you do not use")
    ]
    codes = [f.code for f in check_content(PROFILE.encode(), "p.yaml").faults]
    assert "NT213" in codes


def test_calibration_says_what_is_not_used_and_measures_it_all_the_same():
    text = write_ranges(
        ProfileText("version: 1\n"),
        {"zoom": None, "pinch": MovementRange(rest=1, full=5)},
        "2026-01-01",
    )
    user = check_user(text.encode(), "user.yaml").require()
    assert user.unused == ["zoom"]
    assert user.range.pinch.full == 5
    less = write_ranges(text, {"pinch": None}, "2026-01-02").text
    assert less.count("unused: [pinch, zoom]") == 1
    session = CalibrationSession(user, guided=False)
    for gesture in rehearse("rest 1s; zoom 5mm; rest 1s; zoom 5mm; rest 1s"):
        session.take(gesture)
    assert session.ranges["zoom"] is not None
    again = write_ranges(text, session.ranges, "2026-01-03")
    assert check_user(again.encode(), "user.yaml").require().unused == []
