"""What the kernel, udev, joydev, evdev, hidapi, SDL 2 and SDL 3 say of each pad.

One class of tests for every way to make a pad and every identity; what differs stands in the
classes below it.
"""

from dataclasses import dataclass, field

import pytest

from neurotouch_hid.device.outputs.descriptor import ReportFormat
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.messages import Axis, Button

SDL_BUTTONS = {
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
STICK_MOVES = [
    (Axis.LEFT_X, 1.0, "leftx"),
    (Axis.LEFT_X, -1.0, "leftx"),
    (Axis.LEFT_X, 0.5, "leftx"),
    (Axis.LEFT_Y, 1.0, "lefty"),
    (Axis.LEFT_Y, -1.0, "lefty"),
    (Axis.RIGHT_X, 1.0, "rightx"),
    (Axis.RIGHT_X, -1.0, "rightx"),
    (Axis.RIGHT_Y, 1.0, "righty"),
    (Axis.RIGHT_Y, -1.0, "righty"),
]
TRIGGER_MOVES = [
    (Axis.LEFT_TRIGGER, 1.0, 255, {"lefttrigger": 32767}),
    (Axis.LEFT_TRIGGER, 0.5, 128, {"lefttrigger": 16447}),
    (Axis.RIGHT_TRIGGER, 1.0, 255, {"righttrigger": 32767}),
]
DPAD_MOVES = [
    (Axis.DPAD_X, 1.0, {"dpright": 1}),
    (Axis.DPAD_X, -1.0, {"dpleft": 1}),
    (Axis.DPAD_Y, 1.0, {"dpdown": 1}),
    (Axis.DPAD_Y, -1.0, {"dpup": 1}),
]
XBOX_MAPPING = (
    "a:b0,b:b1,x:b2,y:b3,back:b6,guide:b8,start:b7,leftstick:b9,rightstick:b10,leftshoulder:b4,"
    "rightshoulder:b5,dpup:h0.1,dpdown:h0.4,dpleft:h0.8,dpright:h0.2,leftx:a0,lefty:a1,rightx:a3,"
    "righty:a4,lefttrigger:a2,righttrigger:a5"
)
# The HID report, written down by hand a second time: place and bytes of each move.
HID_AXES = {
    "left_x": 0,
    "left_y": 2,
    "right_x": 4,
    "right_y": 6,
    "left_trigger": 8,
    "right_trigger": 9,
}
HID_HATS = {"dpad_y -1": 1, "dpad_x 1": 3, "dpad_y 1": 5, "dpad_x -1": 7}
HID_BUTTONS = ("a", "b", "x", "y", "lb", "rb", "back", "start", "guide", "ls", "rs")
SYN = [0, 0, 0]


@dataclass(frozen=True)
class Expected:
    """What one pad is expected to be."""

    pad: str  # as the guest calls it
    identity: str
    proc: tuple[str, ...]  # lines of /proc/bus/input/devices beside those of every pad
    types: list[int]
    guid: str
    sdl_names: dict[str, str]
    sdl3_kind: str
    mapping: str = XBOX_MAPPING
    n_buttons: int = 11
    sdl_rest: dict[str, int] = field(default_factory=dict)  # what SDL shows when nothing is touched
    stick_values: dict[float, tuple[int, int]] = field(
        # of a value: what evdev says, what SDL says
        default_factory=lambda: {1.0: (32767, 32767), -1.0: (-32767, -32767), 0.5: (16384, 16384)}
    )


class PadTests:
    """What holds for every pad."""

    EXPECTED: Expected

    @property
    def layout(self):
        return load_identities()[self.EXPECTED.identity].layout

    @pytest.fixture
    def claims(self, guest):
        return guest(f"claims_{self.EXPECTED.pad}")

    @pytest.fixture
    def moves(self, guest):
        return {move["move"]: move for move in guest(f"controls_{self.EXPECTED.pad}")}

    def hid_reports(self, move: str) -> list[bytes]:
        """What hidapi reads of a move; nothing where there is no hidraw node."""
        return []

    def check(self, moves, move: str, out: list, back: list, sdl: dict[str, int]) -> None:
        rest = self.EXPECTED.sdl_rest
        assert moves[move]["out"]["evdev"] == [*out, SYN]
        assert moves[move]["back"]["evdev"] == [*back, SYN]
        for library in ("sdl2", "sdl3"):
            assert moves[move]["out"][library] == {**rest, **sdl}
            assert moves[move]["back"][library] == rest
        assert moves[move]["out"]["hidapi"] == [report.hex() for report in self.hid_reports(move)]
        assert moves[move]["back"]["hidapi"] == [
            bytes(len(report)).hex() for report in self.hid_reports(move)
        ]

    def test_the_kernel_lists_it(self, claims):
        proc = [line.strip() for line in claims["proc"]]
        for line in (*self.EXPECTED.proc, "P: Phys=neurotouch/pad0", "B: PROP=0", "B: ABS=3003f"):
            assert line in proc
        handlers = next(line for line in proc if line.startswith("H:"))
        assert "event" in handlers
        assert "js" in handlers

    def test_evdev_reads_the_identity(self, claims):
        identity = load_identities()[self.EXPECTED.identity]
        assert claims["name"] == identity.name
        assert claims["phys"] == "neurotouch/pad0"
        assert claims["ids"] == [3, identity.vendor, identity.product, identity.version]
        assert claims["types"] == self.EXPECTED.types  # no 21, EV_FF

    def test_exactly_the_keys_of_the_layout_none_pressed(self, claims):
        keys = (*self.layout.buttons.values(), *self.layout.trigger_buttons.values())
        assert claims["keys"] == sorted(control.code for control in keys)
        assert claims["pressed"] == []

    def test_eight_axes_at_rest_without_fuzz_and_flat(self, claims):
        assert claims["axes"] == {
            # value, minimum, maximum, fuzz, flat, resolution
            str(axis.code): [axis.rest, axis.minimum, axis.maximum, 0, 0, 0]
            for axis in self.layout.axes.values()
        }
        assert len(claims["axes"]) == 8

    def test_udev_takes_it_for_a_joystick_and_nothing_else(self, claims):
        udev = claims["udev"]
        kinds = {key for key in udev if key.startswith("ID_INPUT_")}
        assert kinds == {"ID_INPUT_JOYSTICK"}
        assert udev["ID_INPUT_JOYSTICK"] == "1"
        assert "uaccess" in udev["TAGS"].split(":")

    def test_the_old_joystick_interface_counts_the_same(self, claims):
        assert claims["joydev"] == [8, self.EXPECTED.n_buttons]

    def test_no_other_node_is_made(self, claims):
        assert claims["nodes"] == ["neurotouch/pad0"]

    @pytest.mark.parametrize("library", ["sdl2", "sdl3"])
    def test_sdl_sees_one_standard_gamepad(self, claims, library):
        sdl = claims[library]
        assert sdl["n_joysticks"] == sdl["n_gamepads"] == 1
        assert sdl["name"] == self.EXPECTED.sdl_names[library]
        assert sdl["guid"] == self.EXPECTED.guid
        assert sdl["axes_buttons_hats"] == [6, self.EXPECTED.n_buttons, 1]
        guid, _, *mapping = sdl["mapping"].rstrip(",").split(",")
        assert guid == self.EXPECTED.guid
        found = {entry for entry in mapping if not entry.startswith("crc:")}
        assert found == {*self.EXPECTED.mapping.split(","), "platform:Linux"}

    def test_sdl_3_knows_its_type(self, claims):
        assert claims["sdl3"]["kind"] == self.EXPECTED.sdl3_kind

    @pytest.mark.parametrize("library", ["sdl2", "sdl3"])
    def test_a_game_that_wants_rumble_does_not_hang(self, claims, library):
        assert claims[library]["rumbles"] is False
        assert claims[library]["rumble_s"] < 5.0  # with force feedback that nobody serves: 62

    @pytest.mark.parametrize("button", Button)
    def test_a_button_moves_exactly_itself(self, moves, button):
        code = self.layout.buttons[button].code
        sdl = {SDL_BUTTONS[button]: 1}
        self.check(moves, button.value, [[1, code, 1]], [[1, code, 0]], sdl)

    @pytest.mark.parametrize(("axis", "value", "sdl"), STICK_MOVES)
    def test_a_stick_moves_exactly_itself(self, moves, axis, value, sdl):
        control = self.layout.axes[axis]
        evdev, shown = self.EXPECTED.stick_values[value]
        out, back = [[3, control.code, evdev]], [[3, control.code, control.rest]]
        self.check(moves, f"{axis.value} {value:g}", out, back, {sdl: shown})

    @pytest.mark.parametrize(("axis", "value", "evdev", "sdl"), TRIGGER_MOVES)
    def test_a_trigger_moves_exactly_itself(self, moves, axis, value, evdev, sdl):
        out, back = [[3, self.layout.axes[axis].code, evdev]], [[3, self.layout.axes[axis].code, 0]]
        if axis in self.layout.trigger_buttons:
            code = self.layout.trigger_buttons[axis].code
            out, back = [[1, code, 1], *out], [*back, [1, code, 0]]
        self.check(moves, f"{axis.value} {value:g}", out, back, sdl)

    @pytest.mark.parametrize(("axis", "value", "sdl"), DPAD_MOVES)
    def test_the_dpad_moves_exactly_itself(self, moves, axis, value, sdl):
        code = self.layout.axes[axis].code
        out, back = [[3, code, int(value)]], [[3, code, 0]]
        self.check(moves, f"{axis.value} {value:g}", out, back, sdl)


class TestUinput(PadTests):
    EXPECTED = Expected(
        pad="uinput",
        identity="xbox360",
        proc=(
            "I: Bus=0003 Vendor=045e Product=028e Version=0110",
            'N: Name="Microsoft X-Box 360 pad"',
            "B: EV=b",  # SYN, KEY, ABS; no FF
            "B: KEY=7cdb000000000000 0 0 0 0",
        ),
        types=[0, 1, 3],
        guid="030081b85e0400008e02000010010000",
        sdl_names={"sdl2": "X360 Controller", "sdl3": "Xbox 360 Controller"},
        sdl3_kind="xbox360",
    )

    def test_hidapi_does_not_see_it(self, claims):
        assert claims["hidapi"] == []


class TestOwn(PadTests):
    EXPECTED = Expected(
        pad="own",
        identity="own",
        proc=(
            "I: Bus=0003 Vendor=1209 Product=4e54 Version=0100",
            'N: Name="NeuroTouch Gamepad"',
            "B: EV=b",
            "B: KEY=7cdb000000000000 0 0 0 0",
        ),
        types=[0, 1, 3],
        guid="03004d7b09120000544e000000010000",
        sdl_names={"sdl2": "NeuroTouch Gamepad", "sdl3": "NeuroTouch Gamepad"},
        sdl3_kind="standard",
    )

    def test_hidapi_does_not_see_it(self, claims):
        assert claims["hidapi"] == []


class TestPlaystation(PadTests):
    EXPECTED = Expected(
        pad="sony",
        identity="playstation",
        proc=(
            "I: Bus=0003 Vendor=054c Product=09cc Version=8111",
            'N: Name="Sony Interactive Entertainment Wireless Controller"',
            "B: EV=b",
            "B: KEY=7fdb000000000000 0 0 0 0",
        ),
        types=[0, 1, 3],
        guid="0300d0424c050000cc09000011810000",
        mapping=(
            "a:b0,b:b1,x:b3,y:b2,back:b8,guide:b10,start:b9,leftstick:b11,rightstick:b12,"
            "leftshoulder:b4,rightshoulder:b5,dpup:h0.1,dpdown:h0.4,dpleft:h0.8,dpright:h0.2,"
            "leftx:a0,lefty:a1,rightx:a3,righty:a4,lefttrigger:a2,righttrigger:a5"
        ),
        sdl_names={"sdl2": "PS4 Controller", "sdl3": "PS4 Controller"},
        sdl3_kind="ps4",
        n_buttons=13,
        # Half a step of 256, as SDL shows real ones.
        sdl_rest=dict.fromkeys(("leftx", "lefty", "rightx", "righty"), 128),
        stick_values={1.0: (255, 32767), -1.0: (1, -32511), 0.5: (192, 16576)},
    )


class TestHid(PadTests):
    EXPECTED = Expected(
        pad="hid",
        identity="own",
        proc=(
            "I: Bus=0003 Vendor=1209 Product=4e54 Version=0100",
            'N: Name="NeuroTouch Gamepad"',
            "U: Uniq=neurotouch/pad0",
            "B: EV=1b",  # SYN, KEY, ABS, MSC
            "B: MSC=10",  # scan codes, which HID always has
            "B: KEY=7cdb000000000000 0 0 0 0",
        ),
        types=[0, 1, 3, 4],
        guid="03004d7b09120000544e000000010000",
        sdl_names={"sdl2": "NeuroTouch Gamepad", "sdl3": "NeuroTouch Gamepad"},
        sdl3_kind="standard",
    )

    def hid_reports(self, move):
        report = bytearray(13)
        name, _, value = move.partition(" ")
        if name in HID_BUTTONS:
            report[11:] = (1 << HID_BUTTONS.index(name)).to_bytes(2, "little")
        elif move in HID_HATS:
            report[10] = HID_HATS[move]
        elif HID_AXES[name] >= 8:
            report[HID_AXES[name]] = {"1": 255, "0.5": 128}[value]
        else:
            level = {"1": 32767, "-1": -32767, "0.5": 16384}[value]
            report[HID_AXES[name] : HID_AXES[name] + 2] = level.to_bytes(2, "little", signed=True)
        return [bytes(report)]

    def test_hidapi_lists_one(self, claims):
        assert len(claims["hidapi"]) == 1
        found = claims["hidapi"][0]
        assert (found["vendor_id"], found["product_id"]) == (0x1209, 0x4E54)
        assert found["product_string"] == "NeuroTouch Gamepad"
        assert found["serial_number"] == "neurotouch/pad0"
        assert (found["usage_page"], found["usage"]) == (1, 8)  # see device/outputs/descriptor.py
        assert found["interface_number"] == -1

    def test_hidapi_reads_our_descriptor(self, claims):
        form = ReportFormat(self.layout.controls)
        assert claims["hidapi"][0]["descriptor"] == form.descriptor.hex()

    def test_whoever_asks_for_a_report_is_answered_at_once(self, claims):
        found = claims["hidapi"][0]
        assert found["report"] == bytes(13).hex()
        assert found["wrote"] == -1  # there is nothing to set
        assert found["answered_s"] < 5.0  # three questions; each would wait 5 s for no answer

    def test_the_rule_gives_its_hidraw_node_to_the_user_at_the_seat(self, claims):
        assert "uaccess" in claims["hidapi"][0]["tags"].split(":")
