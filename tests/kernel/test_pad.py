"""What the kernel, udev, joydev, evdev, SDL 2 and SDL 3 say of the pad, control by control."""

import pytest

from neurotouch_hid.device.gamepad import AXES, BUTTONS
from neurotouch_hid.messages import Axis, Button

GUID = "030081b85e0400008e02000010010000"
MAPPING = (
    "a:b0,b:b1,x:b2,y:b3,back:b6,guide:b8,start:b7,leftstick:b9,rightstick:b10,leftshoulder:b4,"
    "rightshoulder:b5,dpup:h0.1,dpdown:h0.4,dpleft:h0.8,dpright:h0.2,leftx:a0,lefty:a1,rightx:a3,"
    "righty:a4,lefttrigger:a2,righttrigger:a5"
)
SDL_NAMES = {
    Button.A: "a",
    Button.B: "b",
    Button.X: "x",
    Button.Y: "y",
    Button.LB: "leftshoulder",
    Button.RB: "rightshoulder",
    Button.BACK: "back",
    Button.START: "start",
    Button.GUIDE: "guide",
    Button.LS: "leftstick",
    Button.RS: "rightstick",
}
SYN = [0, 0, 0]


@pytest.fixture(scope="module")
def claims(guest):
    return guest("claims")


@pytest.fixture(scope="module")
def moves(guest):
    return {move["move"]: move for move in guest("controls")}


def test_the_kernel_lists_it(claims):
    proc = [line.strip() for line in claims["proc"]]
    assert "I: Bus=0003 Vendor=045e Product=028e Version=0110" in proc
    assert 'N: Name="Microsoft X-Box 360 pad"' in proc
    assert "P: Phys=neurotouch/pad0" in proc
    assert "B: PROP=0" in proc
    assert "B: EV=b" in proc  # SYN, KEY, ABS; no FF
    assert "B: KEY=7cdb000000000000 0 0 0 0" in proc
    assert "B: ABS=3003f" in proc
    handlers = next(line for line in proc if line.startswith("H:"))
    assert "event" in handlers
    assert "js" in handlers


def test_evdev_reads_the_identity(claims):
    assert claims["name"] == "Microsoft X-Box 360 pad"
    assert claims["phys"] == "neurotouch/pad0"
    assert claims["ids"] == [0x0003, 0x045E, 0x028E, 0x0110]
    assert claims["types"] == [0, 1, 3]


def test_eleven_keys_none_pressed(claims):
    assert claims["keys"] == sorted(control.code for control in BUTTONS.values())
    assert len(claims["keys"]) == 11
    assert claims["pressed"] == []


def test_eight_axes_at_rest_without_fuzz_and_flat(claims):
    assert claims["axes"] == {
        # value, minimum, maximum, fuzz, flat, resolution
        str(control.code): [0, control.minimum, control.maximum, 0, 0, 0]
        for control in AXES.values()
    }
    assert len(claims["axes"]) == 8


def test_udev_takes_it_for_a_joystick_and_nothing_else(claims):
    udev = claims["udev"]
    kinds = {key for key in udev if key.startswith("ID_INPUT_")}
    assert kinds == {"ID_INPUT_JOYSTICK"}
    assert udev["ID_INPUT_JOYSTICK"] == "1"
    assert "uaccess" in udev["TAGS"].split(":")


def test_the_old_joystick_interface_counts_the_same(claims):
    assert claims["joydev"] == [8, 11]


@pytest.mark.parametrize("library", ["sdl2", "sdl3"])
def test_sdl_sees_one_standard_gamepad(claims, library):
    sdl = claims[library]
    assert sdl["n_joysticks"] == sdl["n_gamepads"] == 1
    assert sdl["guid"] == GUID
    assert sdl["axes_buttons_hats"] == [6, 11, 1]
    guid, _, *mapping = sdl["mapping"].rstrip(",").split(",")
    assert guid == GUID
    assert set(mapping) == {*MAPPING.split(","), "platform:Linux"}


def test_sdl_knows_it_as_an_xbox_360_pad(claims):
    assert claims["sdl2"]["name"] == "X360 Controller"
    assert claims["sdl3"]["name"] == "Xbox 360 Controller"
    assert claims["sdl3"]["kind"] == "xbox360"


@pytest.mark.parametrize("library", ["sdl2", "sdl3"])
def test_a_game_that_wants_rumble_does_not_hang(claims, library):
    assert claims[library]["rumbles"] is False
    assert claims[library]["rumble_s"] < 1.0  # with force feedback that nobody serves: 62


@pytest.mark.parametrize("button", Button)
def test_a_button_moves_exactly_itself(moves, button):
    move = moves[button.value]
    code = BUTTONS[button].code
    name = SDL_NAMES[button]
    assert move["out"] == {"evdev": [[1, code, 1], SYN], "sdl2": {name: 1}, "sdl3": {name: 1}}
    assert move["back"] == {"evdev": [[1, code, 0], SYN], "sdl2": {}, "sdl3": {}}


@pytest.mark.parametrize(
    ("move", "axis", "value", "sdl"),
    [
        ("left_x 1", Axis.LEFT_X, 32767, {"leftx": 32767}),
        ("left_x -1", Axis.LEFT_X, -32767, {"leftx": -32767}),
        ("left_x 0.5", Axis.LEFT_X, 16384, {"leftx": 16384}),
        ("left_y 1", Axis.LEFT_Y, 32767, {"lefty": 32767}),
        ("left_y -1", Axis.LEFT_Y, -32767, {"lefty": -32767}),
        ("right_x 1", Axis.RIGHT_X, 32767, {"rightx": 32767}),
        ("right_x -1", Axis.RIGHT_X, -32767, {"rightx": -32767}),
        ("right_y 1", Axis.RIGHT_Y, 32767, {"righty": 32767}),
        ("right_y -1", Axis.RIGHT_Y, -32767, {"righty": -32767}),
        ("left_trigger 1", Axis.LEFT_TRIGGER, 255, {"lefttrigger": 32767}),
        ("left_trigger 0.5", Axis.LEFT_TRIGGER, 128, {"lefttrigger": 16447}),
        ("right_trigger 1", Axis.RIGHT_TRIGGER, 255, {"righttrigger": 32767}),
        ("dpad_x 1", Axis.DPAD_X, 1, {"dpright": 1}),
        ("dpad_x -1", Axis.DPAD_X, -1, {"dpleft": 1}),
        ("dpad_y 1", Axis.DPAD_Y, 1, {"dpdown": 1}),
        ("dpad_y -1", Axis.DPAD_Y, -1, {"dpup": 1}),
    ],
)
def test_an_axis_moves_exactly_itself(moves, move, axis, value, sdl):
    code = AXES[axis].code
    assert moves[move]["out"] == {"evdev": [[3, code, value], SYN], "sdl2": sdl, "sdl3": sdl}
    assert moves[move]["back"] == {"evdev": [[3, code, 0], SYN], "sdl2": {}, "sdl3": {}}
