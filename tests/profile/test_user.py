"""What belongs to the person: ranges, orientation, a hand that stays on the gel, and their file."""

from functools import partial

import numpy as np
import pytest

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.messages import Axis, Button, Gesture, GestureKind
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile import Mapping, UserSettings, check_user, load_user, rehearse
from neurotouch_hid.profile.editing import take_user
from neurotouch_hid.profile.engine.personal_range import make_conversion
from tests.profile.stage import make_profile, run

STICK = make_profile("when: push, do: {stick: left, range_mm: [1, 8], deadzone: 0}")


def settings(**values: object) -> UserSettings:
    return UserSettings.model_validate({"filter": "none", **values})


def push(mapping: Mapping, x: float, y: float) -> tuple[float, float]:
    points = np.zeros((1, 2))
    gesture = Gesture(0, GestureKind.PUSH, points, points, float(np.hypot(x, y)), (x, y))
    axes = mapping.update(gesture).axes
    return round(axes.get(Axis.LEFT_X, 0.0), 3), round(axes.get(Axis.LEFT_Y, 0.0), 3)


def test_a_small_range_reaches_the_end() -> None:
    user = settings(range={"push_left": {"rest": 0.5, "full": 3.5}})
    assert push(Mapping(STICK, user), -3.5, 0.0) == (-1.0, 0.0)
    assert push(Mapping(STICK, user), -2.0, 0.0) == (-0.5, 0.0)
    assert push(Mapping(STICK, user), -0.5, 0.0) == (0.0, 0.0)
    assert push(Mapping(STICK, user), 3.5, 0.0) == (round(2.5 / 7, 3), 0.0), "the others stay"


def test_a_diagonal_blends_the_two_ranges_beside_it() -> None:
    user = settings(
        range={"push_left": {"rest": 1.0, "full": 3.0}, "push_up": {"rest": 1.0, "full": 9.0}}
    )
    convert = make_conversion(user.range)
    assert convert is not None
    half = 0.5**0.5
    assert convert(GestureKind.PUSH, 6.0, (-half, -half)) == pytest.approx(8.0)
    assert convert(GestureKind.PUSH, 3.0, (-1.0, 0.0)) == pytest.approx(8.0)
    assert convert(GestureKind.PUSH, 9.0, (0.0, -1.0)) == pytest.approx(8.0)


def test_thresholds_count_in_millimetres_of_a_usual_hand() -> None:
    profile = make_profile("when: zoom, do: {button: a}")
    weak = settings(range={"zoom": {"rest": 0.5, "full": 2.0}})
    pressed = [state.buttons for state in run(Mapping(profile, weak), "zoom 1.6mm 100ms")]
    assert frozenset({Button.A}) in pressed
    assert not any(state.buttons for state in run(Mapping(profile, settings()), "zoom 1.6mm 100ms"))


def test_the_gel_may_lie_turned_or_mirrored() -> None:
    assert push(Mapping(STICK, settings(rotate_deg=90)), 8.0, 0.0) == (0.0, 1.0)
    assert push(Mapping(STICK, settings(rotate_deg=-90)), 8.0, 0.0) == (0.0, -1.0)
    assert push(Mapping(STICK, settings(mirror=True)), 8.0, 0.0) == (-1.0, 0.0)
    twist = make_profile("when: twist_cw, do: {button: a}", "when: twist_ccw, do: {button: b}")
    states = run(Mapping(twist, settings(mirror=True)), "twist_cw 5mm")
    assert frozenset({Button.B}) in [state.buttons for state in states]


def test_new_values_hold_from_the_next_gesture_on() -> None:
    mapping = Mapping(STICK, settings())
    moved = []
    for i, gesture in enumerate(rehearse("push right 8mm hold 500ms; push right 8mm")):
        if i == 30:
            mapping.switch(STICK, settings(mirror=True))
        moved.append(mapping.update(gesture).axes.get(Axis.LEFT_X, 0.0))
    assert moved[29] == 1.0
    assert not any(moved[30:80])
    assert min(moved[80:]) == -1.0


def test_a_folder_that_cannot_be_looked_into_is_a_fault_and_no_usual_hand(tmp_path) -> None:
    with pytest.raises(ProfileError, match="cannot be read: File name too long"):
        load_user(folder=tmp_path / ("x" * 300))
    assert load_user(folder=tmp_path / "none") == UserSettings()


def test_another_thing_in_the_place_of_the_file_is_to_be_moved_away(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    file = find_user_file()
    file.mkdir(parents=True)
    for read in (load_user, partial(take_user, str)):
        with pytest.raises(ProfileError, match="cannot be read: it is a folder") as caught:
            read()
        assert caught.value.hint.endswith(f"the defaults apply: mv {file} {file}.old")


def test_the_file_has_defaults_faults_and_a_place(tmp_path) -> None:
    assert load_user(folder=tmp_path) == UserSettings()
    (tmp_path / "user.yaml").write_text("range: {zom: {rest: 0.4, full: 25}}\nmirror: yes\n")
    with pytest.raises(ProfileError) as caught:
        load_user(folder=tmp_path)
    lines = [line for line in caught.value.message.splitlines() if "error" in line]
    assert [line.partition("user.yaml:")[2] for line in lines] == [
        "1:9: error[NT110]: range.zom: unknown key; known here: push_left, push_right, push_up, "
        "push_down, pinch, zoom, twist_cw, twist_ccw",
        "2:9: error[NT113]: mirror: needs true or false, not 'yes'",
    ]
    text = b"range:\n  zoom: {rest: 3, full: 2}\n  pinch: {full: 25}\ntiming: {preset: fast}\n"
    codes = [fault.code for fault in check_user(text, "user.yaml").faults]
    assert codes == ["NT123", "NT114", "NT112"]
