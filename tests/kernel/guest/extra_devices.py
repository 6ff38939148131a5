"""Makes keyboard and mouse beside the pad, uses them, and asks the kernel, udev and SDL."""

import contextlib
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import evdev
from evdev.ecodes import EV_KEY, EV_REL

from neurotouch_hid.device import Device, ExtraDevice, open_device
from neurotouch_hid.device.outputs import keyboard, mouse
from neurotouch_hid.messages import GamepadState
from tests.kernel.guest.opening import properties, run
from tests.kernel.guest.reader import Reader, find_node, list_nodes
from tests.kernel.guest.sdl import open_games

PLACES = {"keyboard": keyboard.PHYS, "mouse": mouse.PHYS}

CHORD = frozenset({"KEY_X", "KEY_LEFTCTRL"})
MAGIC = frozenset({"KEY_LEFTALT", "KEY_SYSRQ", "KEY_H"})
LEFT = frozenset({"BTN_LEFT"})
HELD = GamepadState(0, keys=CHORD, mouse_buttons=LEFT)

ACTIONS: dict[str, list[GamepadState]] = {
    "chord": [GamepadState(0, keys=CHORD), GamepadState(0)],
    # With Alt and Print down, the kernel would take H for itself and print its help.
    "magic": [
        GamepadState(0, keys=MAGIC - {"KEY_H"}),
        GamepadState(0, keys=MAGIC),
        GamepadState(0),
    ],
    "buttons": [
        *(GamepadState(0, mouse_buttons=frozenset({name})) for name in mouse.BUTTONS),
        GamepadState(0),
    ],
    # 0.1 s of 333 px/s to the right and 50 px/s up; then 0.1 s of the wheel at 12 clicks/s.
    "motion": [GamepadState(t_us, pointer=(333.0, -50.0)) for t_us in range(0, 100_001, 10_000)],
    "wheel": [GamepadState(t_us, wheel=-12.0) for t_us in range(100_000, 200_001, 10_000)],
}


def use(results: Path) -> dict[str, Any]:
    """What everybody says of keyboard and mouse, and what a reader of each sees."""
    before = list_nodes()
    with open_device("uinput", ExtraDevice) as device:
        nodes = {name: find_node(phys) for name, phys in PLACES.items()}
        run("udevadm", "settle", "--timeout=60")
        seen: dict[str, Any] = {"nodes_before": before, "nodes": list_nodes()}
        with open_games() as games:
            for name, game in games.items():
                seen[name] = {"n_joysticks": game.n_joysticks, "n_gamepads": game.n_gamepads}
        for name, node in nodes.items():
            seen[name] = describe(node)
        readers = {name: Reader(node) for name, node in nodes.items()}
        seen["keys"] = {key: press(device, readers["keyboard"], key) for key in keyboard.KEYS}
        for action, states in ACTIONS.items():
            seen[action] = {name: [] for name in readers}
            n_before = {name: len(reader.events) for name, reader in readers.items()}
            for state in states:
                device.write(state)
            for name, reader in readers.items():
                reader.wait_until_quiet()
                seen[action][name] = reader.events[n_before[name] :]
    for reader in readers.values():
        reader.wait_for_end()
    return {**seen, "nodes_after": list_nodes()}


def describe(node: evdev.InputDevice) -> dict[str, Any]:
    """What the kernel and udev say of a node at rest."""
    blocks = Path("/proc/bus/input/devices").read_text().split("\n\n")
    capabilities = node.capabilities()
    info = node.info
    return {
        "proc": [
            line.strip()
            for line in next(block for block in blocks if node.phys in block).splitlines()
        ],
        "name": node.name,
        "ids": [info.bustype, info.vendor, info.product, info.version],
        "types": sorted(capabilities),
        "keys": sorted(capabilities[EV_KEY]),
        "motions": sorted(capabilities.get(EV_REL, [])),
        "pressed": node.active_keys(),
        "udev": properties(Path(node.path)),
    }


def press(device: Device, reader: Reader, key: str) -> list[tuple[int, int, int]]:
    """Press one key and let it go; return what the reader saw."""
    n_before = len(reader.events)
    device.write(GamepadState(0, keys=frozenset({key})))
    device.write(GamepadState(0))
    with contextlib.suppress(TimeoutError):  # the host will say what is missing
        reader.wait_for(lambda events: len(events) >= n_before + 4)
    return reader.events[n_before:]


def kill_while_held(results: Path) -> dict[str, Any]:
    """Kill a process that holds a chord and a mouse button."""
    with held() as (child, readers):
        os.kill(child, signal.SIGKILL)
        for reader in readers.values():
            reader.wait_for_end()
    return {name: reader.report() for name, reader in readers.items()}


@contextlib.contextmanager
def held() -> Iterator[tuple[int, dict[str, Reader]]]:
    """A process that holds a chord and a mouse button, and readers that have seen it."""
    told, tell = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            device = open_device("uinput", ExtraDevice)
            os.read(told, 1)
            device.write(HELD)
            signal.pause()
        finally:
            os._exit(0)
    readers = {name: Reader(find_node(phys)) for name, phys in PLACES.items()}
    os.write(tell, b".")
    for reader in readers.values():
        reader.wait_for(lambda events: len(events) > 1)
    yield child, readers
    os.waitpid(child, 0)
    os.close(told)
    os.close(tell)
