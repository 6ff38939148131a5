"""Makes the pad, moves it, takes it away, and asks the kernel, udev, SDL 2 and SDL 3 about it."""

import array
import contextlib
import fcntl
import os
import select
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from evdev.ecodes import ABS_HAT0Y, EV_ABS, EV_KEY, EV_MSC

from neurotouch_hid.device import Device, open_device
from neurotouch_hid.device.outputs.gamepad import PHYS
from neurotouch_hid.messages import Axis, Button, GamepadState
from tests.kernel.guest import hid
from tests.kernel.guest.opening import properties, run
from tests.kernel.guest.reader import Reader, find_node, list_nodes
from tests.kernel.guest.sdl import describe, look, open_games

JSIOCGAXES = 0x80016A11
JSIOCGBUTTONS = 0x80016A12

EVERYTHING = GamepadState(0, frozenset(Button), dict.fromkeys(Axis, 1.0))
PATIENCE_S = 60.0
"""For one move; so long only if something is missing."""

PADS = {
    "uinput": ("uinput", "xbox360"),
    "own": ("uinput", "own"),
    "hid": ("hid", "own"),
    "sony": ("uinput", "playstation"),
}
"""The kind and the identity of each pad that is tested."""


@contextlib.contextmanager
def made_pad(which: str):
    kind, identity = PADS[which]
    with open_device(kind, identity=identity) as pad:
        device = find_node(PHYS)
        run("udevadm", "settle", "--timeout=60")
        yield pad, device


def claim(which: str, results: Path) -> dict[str, Any]:
    """What everybody says of the pad at rest."""
    with made_pad(which) as (_, device), open_games() as games:
        blocks = Path("/proc/bus/input/devices").read_text().split("\n\n")
        capabilities = device.capabilities(absinfo=True)
        info = device.info
        joystick = next(Path(f"/sys/class/input/{Path(device.path).name}/device").glob("js*")).name
        return {
            "proc": next(block for block in blocks if PHYS in block).splitlines(),
            "name": device.name,
            "phys": device.phys,
            "ids": [info.bustype, info.vendor, info.product, info.version],
            "types": sorted(capabilities),
            "keys": sorted(capabilities[EV_KEY]),
            "axes": {code: list(info) for code, info in capabilities[EV_ABS]},
            "pressed": device.active_keys(),
            "nodes": list_nodes(),
            "udev": properties(Path(device.path)),
            "joydev": count_joydev(Path("/dev/input") / joystick),
            "hidapi": hid.list_pads(),
            **{name: describe(game) for name, game in games.items()},
        }


def count_joydev(node: Path) -> list[int]:
    """Return the numbers of axes and buttons of the old joystick interface."""
    counts = []
    with node.open("rb") as joystick:
        for request in (JSIOCGAXES, JSIOCGBUTTONS):
            answer = array.array("B", [0])
            fcntl.ioctl(joystick, request, answer)
            counts.append(answer[0])
    return counts


def move_every_control(which: str, results: Path) -> list[dict[str, Any]]:
    """Move one control after the other and back, and say what each reader saw."""
    moves: list[tuple[str, GamepadState]] = [
        *((button.value, GamepadState(0, frozenset({button}))) for button in Button),
        *((f"{axis.value} 1", GamepadState(0, axes={axis: 1.0})) for axis in Axis),
        *(
            (f"{axis.value} -1", GamepadState(0, axes={axis: -1.0}))
            for axis in Axis
            if "trigger" not in axis
        ),
        *(
            (f"{axis.value} 0.5", GamepadState(0, axes={axis: 0.5}))
            for axis in (Axis.LEFT_X, Axis.LEFT_TRIGGER)
        ),
    ]
    is_hid = PADS[which][0] == "hid"
    with made_pad(which) as (pad, device), open_games() as games, hid.read_pad() as reports:
        reader = Reader(device)
        return [
            {
                "move": name,
                "out": watch(pad, state, reader, reports, games, is_hid=is_hid),
                "back": watch(pad, GamepadState(0), reader, reports, games, is_hid=is_hid),
            }
            for name, state in moves
        ]


def watch(
    pad: Device,
    state: GamepadState,
    reader: Reader,
    reports: list[str],
    games: Any,
    *,
    is_hid: bool,
) -> dict[str, Any]:
    """Write a state and return what came of it: evdev events, HID reports, what games show."""
    n_before, n_reports = len(reader.events), len(reports)
    before = {name: look(game) for name, game in games.items()}
    pad.write(state)
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        seen = {name: look(game) for name, game in games.items()}
        heard = reader.events[n_before:] and (reports[n_reports:] or not is_hid)
        if heard and all(seen[name] != before[name] for name in games):
            break
        time.sleep(0.01)
    time.sleep(0.05)  # for what should not come
    seen = {name: look(game) for name, game in games.items()}
    events = [event for event in reader.events[n_before:] if event[0] != EV_MSC]  # scan codes
    return {"evdev": events, "hidapi": reports[n_reports:], **seen}


def close_while_pressed(results: Path) -> dict[str, Any]:
    """Close with everything held."""
    return part_with("uinput", lambda pad: pad.close())


def close_hid_while_pressed(results: Path) -> dict[str, Any]:
    """The same with the HID pad."""
    return part_with("hid", lambda pad: pad.close())


def kill_while_pressed(results: Path) -> dict[str, Any]:
    """Kill a process that holds everything."""
    return part_with("uinput", lambda pad: os.kill(os.getpid(), signal.SIGKILL))


def kill_hid_while_pressed(results: Path) -> dict[str, Any]:
    """The same with the HID pad."""
    return part_with("hid", lambda pad: os.kill(os.getpid(), signal.SIGKILL))


def part_with(kind: str, end: Callable[[Device], None]) -> dict[str, Any]:
    """Let a process hold everything, then end; return what a reader has seen."""
    told, tell = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            pad = open_device(kind)
            os.read(told, 1)
            pad.write(EVERYTHING)
            while not select.select([told], [], [], 0.01)[0]:
                pad.write(EVERYTHING)  # as the program does with each slice
            end(pad)
        finally:
            os._exit(0)
    reader = Reader(find_node(PHYS))
    os.write(tell, b".")
    reader.wait_for(lambda events: (EV_ABS, ABS_HAT0Y, 1) in events)
    os.write(tell, b".")
    reader.wait_for_end()
    os.waitpid(child, 0)
    os.close(told)
    os.close(tell)
    return reader.report()
