"""What the kernel, udev, SDL and plain readers say of the keyboard and the mouse beside the pad."""

import itertools

import pytest

from neurotouch_hid.device.outputs import keyboard, mouse

SYN = [0, 0, 0]
PAD, KEYBOARD, MOUSE = "neurotouch/pad0", "neurotouch/keyboard0", "neurotouch/mouse0"
CTRL, X, ALT, H, LEFT = 29, 45, 56, 35, 0x110
REL_X, REL_Y, REL_WHEEL, REL_WHEEL_HI_RES = 0, 1, 8, 11


@pytest.fixture(scope="module")
def seen(guest):
    return guest("extra_devices")


def classes(udev: dict[str, str]) -> set[str]:
    return {key for key in udev if key.startswith("ID_INPUT_")}


def test_nothing_is_made_that_the_profile_does_not_use(guest):
    assert guest("claims_uinput")["nodes"] == [PAD]
    assert guest("tour")["nodes"] == [PAD]  # neurotouch run --profile spacecraft


def test_they_come_and_go_with_the_pad(seen):
    assert seen["nodes_before"] == []
    assert seen["nodes"] == [KEYBOARD, MOUSE, PAD]
    assert seen["nodes_after"] == []


def test_the_kernel_lists_the_keyboard(seen):
    proc = seen["keyboard"]["proc"]
    assert "I: Bus=0006 Vendor=0000 Product=0001 Version=0001" in proc
    assert 'N: Name="NeuroTouch Keyboard"' in proc
    assert "P: Phys=neurotouch/keyboard0" in proc
    assert "B: PROP=0" in proc
    assert "B: EV=3" in proc  # SYN, KEY; no repeat of its own, no lights
    assert seen["keyboard"]["ids"] == [0x06, 0, 1, 1]
    assert seen["keyboard"]["keys"] == sorted(control.code for control in keyboard.KEYS.values())
    assert seen["keyboard"]["pressed"] == []


def test_the_kernel_lists_the_mouse(seen):
    proc = seen["mouse"]["proc"]
    assert "I: Bus=0006 Vendor=0000 Product=0002 Version=0001" in proc
    assert 'N: Name="NeuroTouch Mouse"' in proc
    assert "P: Phys=neurotouch/mouse0" in proc
    assert "B: PROP=0" in proc
    assert "B: EV=7" in proc  # SYN, KEY, REL
    assert seen["mouse"]["ids"] == [0x06, 0, 2, 1]
    assert seen["mouse"]["keys"] == [0x110, 0x111, 0x112, 0x113, 0x114]
    assert seen["mouse"]["motions"] == sorted(mouse.MOTIONS)
    assert seen["mouse"]["pressed"] == []


@pytest.mark.parametrize("name", ["keyboard", "mouse"])
def test_nobody_takes_them_for_a_joystick(seen, name):
    handlers = next(line for line in seen[name]["proc"] if line.startswith("H:"))
    assert "event" in handlers
    assert "js" not in handlers
    assert "ID_INPUT_JOYSTICK" not in seen[name]["udev"]


def test_udev_knows_a_keyboard_and_a_mouse(seen):
    assert classes(seen["keyboard"]["udev"]) == {"ID_INPUT_KEY", "ID_INPUT_KEYBOARD"}
    assert classes(seen["mouse"]["udev"]) == {"ID_INPUT_MOUSE"}


@pytest.mark.parametrize("library", ["sdl2", "sdl3"])
def test_sdl_still_sees_one_gamepad_and_nothing_else(seen, library):
    assert seen[library] == {"n_joysticks": 1, "n_gamepads": 1}


@pytest.mark.parametrize("key", keyboard.KEYS)
def test_a_key_moves_exactly_itself(seen, key):
    code = keyboard.KEYS[key].code
    assert seen["keys"][key] == [[1, code, 1], SYN, [1, code, 0], SYN]


def test_a_chord_begins_and_ends_with_its_modifier(seen):
    down, up = [[1, CTRL, 1], [1, X, 1], SYN], [[1, X, 0], [1, CTRL, 0], SYN]
    assert seen["chord"] == {"keyboard": down + up, "mouse": []}


def test_the_magic_keys_of_the_kernel_stay_out_of_reach(seen):
    pressed = [[1, ALT, 1], SYN, [1, H, 1], SYN]
    assert seen["magic"]["keyboard"] == [*pressed, [1, H, 0], [1, ALT, 0], SYN]


def test_each_mouse_button_in_turn(seen):
    codes = [control.code for control in mouse.BUTTONS.values()]
    changes = [[[1, old, 0], [1, new, 1], SYN] for old, new in itertools.pairwise(codes)]
    frames = [[[1, codes[0], 1], SYN], *changes, [[1, codes[-1], 0], SYN]]
    assert seen["buttons"] == {"keyboard": [], "mouse": list(itertools.chain(*frames))}


def test_the_pointer_goes_the_way_that_the_speed_asks_for(seen):
    events = seen["motion"]["mouse"]
    assert seen["motion"]["keyboard"] == []
    assert sum(value for type_, code, value in events if (type_, code) == (2, REL_X)) == 33
    assert sum(value for type_, code, value in events if (type_, code) == (2, REL_Y)) == -5
    assert events.count(SYN) == 10  # a frame per slice
    assert {tuple(event[:2]) for event in events} == {(0, 0), (2, REL_X), (2, REL_Y)}


def test_the_wheel_turns_finely_and_clicks_for_those_who_do_not_know_that(seen):
    events = seen["wheel"]["mouse"]
    fine = [value for type_, code, value in events if (type_, code) == (2, REL_WHEEL_HI_RES)]
    clicks = [value for type_, code, value in events if (type_, code) == (2, REL_WHEEL)]
    assert sum(fine) == -144
    assert len(fine) == 10
    assert clicks == [-1]
    assert seen["wheel"]["keyboard"] == []


def releases(report: dict) -> list[list[int]]:
    """The key events after the last press."""
    keys = [event for event in report["events"] if event[0] == 1]
    last = max(index for index, event in enumerate(keys) if event[2])
    return sorted(keys[last + 1 :])


@pytest.mark.parametrize("chapter", ["companions_killed", "driver_killed"])
def test_kill_9_leaves_nothing_pressed(guest, chapter):
    """``driver_killed`` is ``neurotouch run`` with a profile that names a chord and a button."""
    seen = guest(chapter)
    assert releases(seen["keyboard"]) == [[1, CTRL, 0], [1, X, 0]]
    assert releases(seen["mouse"]) == [[1, LEFT, 0]]
    for name in ("keyboard", "mouse"):
        assert seen[name]["ended"] == "No such device"
        assert not seen[name]["node_left"]
