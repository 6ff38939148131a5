"""Presses chords on somebody's keyboard and on our own."""

import time
from pathlib import Path
from typing import Any

from evdev import UInput, ecodes

from neurotouch_hid.device import ChordReader, ExtraDevice, find_keyboards, open_device
from neurotouch_hid.device.inputs.hotkeys import CHORDS
from neurotouch_hid.messages import GamepadState

PATIENCE_S = 120.0
KEYS = sorted(ecodes.ecodes[key] for key in (*CHORDS["panic"], "KEY_A", "KEY_SPACE"))


def press(results: Path) -> dict[str, Any]:
    """What is heard of each chord, on which keyboards."""
    heard: list[str] = []
    with open_device("uinput", [ExtraDevice.KEYBOARD]) as ours:
        reader = ChordReader(heard.append)
        before = reader.describe()
        ours.write(GamepadState(0, keys=frozenset(CHORDS["panic"])))
        time.sleep(0.5)
        ours.write(GamepadState(0))
        on_ours = list(heard)
        with UInput({ecodes.EV_KEY: KEYS}, name="Real keyboard", phys="usb-1/input0") as keyboard:
            deadline = time.monotonic() + PATIENCE_S
            while "Real keyboard" not in reader.describe() and time.monotonic() < deadline:
                time.sleep(0.05)
            found = [device.name for device in find_keyboards()]
            for chord in ("pause", "panic"):
                for value in (1, 0):
                    for key in CHORDS[chord]:
                        keyboard.write(ecodes.EV_KEY, ecodes.ecodes[key], value)
                    keyboard.syn()
            while len(heard) < 2 and time.monotonic() < deadline:
                time.sleep(0.05)
        reader.close()
    return {"before": before, "on_ours": on_ours, "found": found, "heard": heard}
