"""Lets somebody else's devices play along; they are made here, and taken away as if unplugged."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from evdev import AbsInfo, InputDevice, UInput, ecodes

from neurotouch_hid.device import Copilot, ExtraDevice, MergedDevice, find_copilot, open_device
from neurotouch_hid.device.inputs.rumble_player import upload_effect
from neurotouch_hid.device.outputs.gamepad import PHYS
from neurotouch_hid.device.outputs.mouse import PHYS as MOUSE_PHYS
from neurotouch_hid.driver.pad_opening import open_pad
from neurotouch_hid.driver.settings import DriverSettings
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Axis, Button, GamepadState
from tests.kernel.guest.opening import as_nobody, run
from tests.kernel.guest.reader import Reader, find_node
from tests.kernel.guest.rumble import erase_effect, make_effect, wait_for

STICK = AbsInfo(0, -32768, 32767, 0, 128, 0)
TRIGGER = AbsInfo(0, 0, 1023, 0, 0, 0)
HAT = AbsInfo(0, -1, 1, 0, 0, 0)
PAD_KEYS = [
    *(ecodes.BTN_SOUTH, ecodes.BTN_EAST, ecodes.BTN_NORTH, ecodes.BTN_WEST, ecodes.BTN_TL),
    *(ecodes.BTN_TR, ecodes.BTN_SELECT, ecodes.BTN_START, ecodes.BTN_MODE, ecodes.BTN_THUMBL),
    ecodes.BTN_THUMBR,
]
PAD_AXES = [
    *((code, STICK) for code in (ecodes.ABS_X, ecodes.ABS_Y, ecodes.ABS_RX, ecodes.ABS_RY)),
    *((code, TRIGGER) for code in (ecodes.ABS_Z, ecodes.ABS_RZ)),
    *((code, HAT) for code in (ecodes.ABS_HAT0X, ecodes.ABS_HAT0Y)),
]
NAME = "Helper pad"
PATIENCE_S = 120.0
GEL_B = GamepadState(0, frozenset({Button.B}), {Axis.LEFT_X: 0.5})


class HelperPad:
    """Somebody's pad, with a motor; whatever makes it shake is kept."""

    def __init__(self) -> None:
        effects = [ecodes.FF_RUMBLE]
        self._device = UInput(
            {ecodes.EV_KEY: PAD_KEYS, ecodes.EV_ABS: PAD_AXES, ecodes.EV_FF: effects},
            name=NAME,
            vendor=0x0F0D,
            product=0x0092,
            version=0x0110,
            bustype=ecodes.BUS_USB,
            phys="usb-0000:00:14.0-1/input0",
            max_effects=4,
        )
        self.shaken: list[tuple[int, int]] = []
        self._motors: dict[int, tuple[int, int]] = {}
        threading.Thread(target=self._serve, daemon=True).start()

    def move(self, **values: int) -> None:
        """Set keys and axes, named by the kernel's codes, in one frame."""
        for name, value in values.items():
            kind = ecodes.EV_ABS if name.startswith("ABS_") else ecodes.EV_KEY
            self._device.write(kind, ecodes.ecodes[name], value)
        self._device.syn()

    def unplug(self) -> None:
        self._device.close()

    def _serve(self) -> None:
        with suppress(OSError, ValueError):
            for event in self._device.read_loop():
                if event.type == ecodes.EV_UINPUT and event.code == ecodes.UI_FF_UPLOAD:
                    upload = self._device.begin_upload(event.value)
                    motors = upload.effect.u.ff_rumble_effect
                    number = upload.effect.id
                    self._motors[number] = (motors.strong_magnitude, motors.weak_magnitude)
                    upload.retval = 0
                    self._device.end_upload(upload)
                elif event.type == ecodes.EV_UINPUT and event.code == ecodes.UI_FF_ERASE:
                    erase = self._device.begin_erase(event.value)
                    erase.retval = 0
                    self._device.end_erase(erase)
                elif event.type == ecodes.EV_FF:
                    motors = self._motors.get(event.code, (0, 0))
                    self.shaken.append(motors if event.value else (0, 0))


def say(question: Callable[[], Any]) -> dict[str, str | None]:
    """The sentence and the way out of what goes wrong."""
    try:
        answer = question()
    except DeviceError as error:
        return {"message": error.message, "hint": error.hint}
    if isinstance(answer, Copilot):
        answer.close()
    return {"message": "done", "hint": None}


def frames(reader: Reader, since: int) -> list[tuple[int, int, int]]:
    with suppress(TimeoutError):  # the host will say what is missing
        reader.wait_for(lambda events: len(events) > since)
    reader.wait_until_quiet()
    # Readers are told of games that shake the pad, too.
    return [event for event in reader.events[since:] if event[0] not in (0, ecodes.EV_FF)]


@contextmanager
def watched(reader: Reader) -> Iterator[list[Any]]:
    """What the reader sees of what is done meanwhile."""
    seen: list[Any] = []
    n_before = len(reader.events)
    yield seen
    seen += frames(reader, n_before)


def play_along(results: Path) -> dict[str, Any]:
    """A pad that plays along, is unplugged while it holds a button, and comes back."""
    seen: dict[str, Any] = {"none": say(lambda: find_copilot("auto"))}
    helper = HelperPad()
    run("udevadm", "settle", "--timeout=60")
    with open_pad("uinput", [], DriverSettings(), copilot="auto").device as pad:
        assert isinstance(pad, MergedDevice)
        device = find_node(PHYS)
        reader, beside = Reader(device), InputDevice(find_copilot(NAME).node)
        seen["claims_rumble"] = ecodes.EV_FF in device.capabilities()
        seen["ours"] = say(lambda: find_copilot("X-Box 360"))
        seen["taken"] = say(lambda: Copilot(NAME))
        seen["without_right"] = as_nobody(lambda: say(lambda: Copilot(NAME)))
        with watched(reader) as seen["helper"]:
            helper.move(BTN_SOUTH=1, ABS_X=-32768, ABS_Z=1023, ABS_HAT0Y=-1)
        with watched(reader) as seen["both"]:
            pad.write(GEL_B)
        with watched(reader) as seen["helper_lets_go_of_the_stick"]:
            helper.move(ABS_X=100, ABS_Z=0, ABS_HAT0Y=0)
        with watched(reader) as seen["gel_stalls"]:
            pad.neutral()
        with watched(reader) as seen["gel_again"]:
            pad.write(GEL_B)
        seen["heard_beside"] = beside.read_one() is not None
        seen["rumble"] = rumble(device, helper)
        with watched(reader) as seen["unplugged"]:
            helper.unplug()
        seen["pad_left"] = Path(device.path).exists()
        helper = HelperPad()
        # What is held on a device that comes counts once it has been let go of.
        with watched(reader) as seen["back"]:
            deadline = time.monotonic() + PATIENCE_S
            while Button.A not in pad.helper_buttons and time.monotonic() < deadline:
                helper.move(BTN_SOUTH=1)
                time.sleep(0.2)
                if Button.A not in pad.helper_buttons:
                    helper.move(BTN_SOUTH=0)
                    time.sleep(0.5)
        seen["rumble_again"] = rumble(device, helper)
        with watched(reader) as seen["closed"]:
            pad.close()
    seen["given_back"] = say(lambda: Copilot(NAME))
    helper.unplug()
    return seen


def rumble(device: InputDevice, helper: HelperPad) -> list[tuple[int, int]]:
    """What shakes the helper's pad when a game shakes ours."""
    n_before = len(helper.shaken)
    number = upload_effect(device, make_effect(0x8000, 0x4000, 30_000))
    device.write(ecodes.EV_FF, number, 1)
    wait_for(lambda: len(helper.shaken) > n_before)
    device.write(ecodes.EV_FF, number, 0)
    wait_for(lambda: len(helper.shaken) > n_before + 1)
    erase_effect(device, number)
    return helper.shaken[n_before:]


def press_keys(results: Path) -> dict[str, Any]:
    """A keyboard that plays along, whose enter key is down at the begin."""
    names = ("ESC", "ENTER", "SPACE", "BACKSPACE", "LEFT", "RIGHT", "F5")
    keys = [ecodes.ecodes[f"KEY_{name}"] for name in names]
    heard: list[str] = []
    with UInput({ecodes.EV_KEY: keys}, name="Helper keyboard", phys="usb-2/input0") as keyboard:

        def press(key: str, value: int) -> None:
            keyboard.write(ecodes.EV_KEY, ecodes.ecodes[f"KEY_{key}"], value)
            keyboard.syn()

        desktop = Reader(InputDevice(find_copilot("Helper keyboard").node))
        press("ENTER", 1)
        settings = DriverSettings.model_validate({"copilot": {"keys": {"KEY_F5": "start"}}})
        played = open_pad("uinput", [], settings, copilot="Helper keyboard")
        with played.device:
            assert played.copilot is not None
            played.copilot.listen({"panic": ("KEY_BACKSPACE", "KEY_ESC")}, heard.append)
            reader = Reader(find_node(PHYS))
            while_held = played.copilot.describe()
            press("ENTER", 0)
            desktop.wait_for(lambda events: (ecodes.EV_KEY, ecodes.KEY_ENTER, 0) in events)
            wait_for(lambda: not _can_grab(keyboard))
            n_before = len(desktop.events)
            with watched(reader) as keys_seen:
                for key in ("SPACE", "LEFT", "F5"):
                    press(key, 1)
                    press(key, 0)
            for value in (1, 0):
                press("BACKSPACE", value)
                press("ESC", value)
            wait_for(lambda: heard)
            claims = ecodes.EV_FF in InputDevice(find_node(PHYS).path).capabilities()
        return {
            "desktop_before": desktop.events[:n_before],
            "desktop_after": desktop.events[n_before:],
            "keys": keys_seen,
            "chords": heard,
            "claims_rumble": claims,
            "while_held": while_held,
        }


def _can_grab(keyboard: UInput) -> bool:
    try:
        keyboard.device.grab()
    except OSError:
        return False
    keyboard.device.ungrab()
    time.sleep(0.05)
    return True


def yield_to_mouse(results: Path) -> dict[str, Any]:
    """Our pointer moves, waits while somebody moves the mouse, and goes on."""
    buttons, motions = [ecodes.BTN_LEFT], [ecodes.REL_X, ecodes.REL_Y]
    steps: dict[str, int] = {}
    with UInput({ecodes.EV_KEY: buttons, ecodes.EV_REL: motions}, name="Real mouse") as mouse:
        device = MergedDevice(open_device("uinput", [ExtraDevice.MOUSE]), yield_to_mouse_s=2.0)
        with device:
            device.prepare([ExtraDevice.MOUSE])
            reader = Reader(find_node(MOUSE_PHYS))
            said = device.describe_mouse()
            t_us = 0

            def move(name: str) -> None:
                nonlocal t_us
                n_before = len(reader.events)
                for _ in range(10):
                    t_us += 10_000
                    device.write(GamepadState(t_us, pointer=(500.0, 0.0), wheel=2.0))
                reader.wait_until_quiet()
                steps[name] = sum(v for k, _, v in reader.events[n_before:] if k == ecodes.EV_REL)

            move("alone")
            deadline = time.monotonic() + PATIENCE_S
            # More than once where the guest stands still for longer than the pointer yields.
            while steps.get("while the mouse moves", 1) and time.monotonic() < deadline:
                mouse.write(ecodes.EV_REL, ecodes.REL_X, 3)
                mouse.syn()
                time.sleep(0.2)
                move("while the mouse moves")
            time.sleep(2.5)
            move("afterwards")
    return {"steps": steps, "said": said}


def two_players(results: Path) -> dict[str, Any]:
    """Two pads of two players at once, one of each kind."""
    from tests.kernel.guest.reader import list_nodes
    from tests.kernel.guest.sdl import open_games

    second = open_device("hid", [ExtraDevice.KEYBOARD], player=2)
    with open_device("uinput") as first, second:
        readers = [Reader(find_node(f"neurotouch/pad{number}")) for number in (0, 1)]
        run("udevadm", "settle", "--timeout=60")
        with open_games() as games:
            counts = {name: game.n_gamepads for name, game in games.items()}
        first.write(GamepadState(0, frozenset({Button.A})))
        second.write(GamepadState(0, frozenset({Button.B})))
        for reader in readers:
            reader.wait_until_quiet()
        keys = [[event for event in reader.events if event[0] == 1] for reader in readers]
        return {"nodes": list_nodes(), "games": counts, "keys": keys}
