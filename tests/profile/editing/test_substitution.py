"""What a weak movement does goes to others: checked by playing the changed profile."""

import pytest

from neurotouch_hid.profile import Mapping, UserSettings, check_content, perform, rehearse
from neurotouch_hid.profile.editing import (
    ProfileText,
    list_substitutes,
    make_when,
    read_text,
    remap,
    remap_unused,
)
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.profile.schema.movements import MOVEMENTS

SHIPPED = sorted(path.stem for path in find_shipped_folder().glob("*.yaml"))
MINE = ProfileText("""\
version: 1
name: mine
bindings:
  # opens
  - when: {gesture: zoom, on_mm: 7.0}
    do: {button: b}
  - when: zoom  # faster
    do: {trigger: right, range_mm: [1.0, 4.5]}
  - when: push
    do: {stick: left}
  - when: pinch
    do: {trigger: left}
""")


def shipped(name):
    return read_text(find_shipped_folder() / f"{name}.yaml")[0]


def play(text, script):
    """Everything that changes, in the order of its moments."""
    profile = check_content(text.encode(), "x").require()
    mapping = Mapping(profile, UserSettings(filter="none"))
    return [change for moment in perform(mapping, rehearse(script)) for change in moment.changes]


def test_what_is_pressed_gets_conditions_of_its_own():
    substitutes = [
        make_when("pinch", "long"),
        make_when("pinch", "double"),
        make_when("pinch", "tap"),
    ]
    done = remap(MINE, "zoom", substitutes)
    assert done.moved == ("pinch long -> button b", "pinch double -> toggle trigger right")
    assert not done.left
    assert "# faster" in done.text.text
    assert "# opens" in done.text.text
    assert remap(MINE, "twist_cw", substitutes).text == MINE
    few = remap(MINE, "zoom", substitutes[:1])
    assert few.left == ("zoom -> trigger right",)


def test_a_wish_that_something_answers_to_is_no_wish():
    text = MINE.append(
        ("bindings",), {"when": {"gesture": "pinch", "press": "long"}, "do": {"button": "x"}}
    )
    done = remap(text, "zoom", [make_when("pinch", "long"), make_when("pinch", "tap")])
    assert done.moved == ("pinch tap -> button b",)


def test_a_stick_is_turned_round_by_a_quick_press_and_back():
    done = remap(MINE, "push_left", list_substitutes("push_left"))
    assert done.moved == ("push right double turns round push -> stick left",)
    twice = "push right 5mm tap; rest 150ms; push right 5mm tap; rest 500ms"
    held = "push right 8mm 300ms hold 300ms; rest 500ms"
    assert "left_x +100 %" in play(done.text, held)
    turned = play(done.text, f"{twice}; {held}")
    assert "left_x -100 %" in turned
    back = play(done.text, f"{twice}; {twice}; {held}")
    assert "left_x -100 %" not in back
    assert "left_x +100 %" in back


@pytest.mark.parametrize(
    ("name", "weak", "shown"),
    [
        ("mouse", "push_up", "push down double turns round push -> mouse pointer"),
        ("mouse", "twist_cw", "twist ccw double turns round twist cw -> mouse wheel"),
        ("flight", "twist_ccw", "twist cw double turns round twist -> axis right_x +"),
    ],
)
def test_pointer_wheel_and_signed_axes_are_turned_round(name, weak, shown):
    done = remap(shipped(name), weak, list_substitutes(weak))
    assert shown in done.moved
    check_content(done.text.encode(), "x").require()


def test_the_wheel_turns_the_other_way_with_the_strong_side():
    done = remap(shipped("mouse"), "twist_cw", list_substitutes("twist_cw"))
    once = "twist_ccw 6mm 100ms hold 100ms"
    twice = f"{once}; rest 250ms; {once}; rest 900ms"
    held = "twist_ccw 8mm 300ms hold 500ms; rest 500ms"
    before, after = play(done.text, held), play(done.text, f"{twice}; {held}")
    assert any(c.startswith("wheel ") and "-" not in c for c in before), before
    assert any(c.startswith("wheel -") for c in after), after


@pytest.mark.parametrize("weak", MOVEMENTS)
@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_profile_stays_right_without_a_movement(name, weak):
    done = remap_unused(shipped(name), [weak])
    checked = check_content(done.text.encode(), "x", unused=[weak])
    profile = checked.require()
    lost = [f for f in checked.faults if f.code == "NT212" and "never acts" in f.sentence]
    turned = [what for what in done.moved if "turns round" in what]
    assert len(lost) <= len(done.left) + len(turned)  # these act in the layer that turns them
    assert len(profile.all_layers) <= 8
    assert done.text.document["name"] == shipped(name).document["name"]


def test_new_lines_end_as_the_others_do():
    done = remap(
        ProfileText(MINE.text.replace("\n", "\r\n")), "push_left", list_substitutes("push_left")
    )
    assert "\n" not in done.text.text.replace("\r\n", "")
