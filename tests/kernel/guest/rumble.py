"""Shakes our pad as games do, and looks at who is told."""

import fcntl
import json
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

from evdev import InputDevice, ecodes, ff

from neurotouch_hid.device import open_device
from neurotouch_hid.device.inputs.rumble_player import upload_effect
from neurotouch_hid.device.outputs.effects import Rumble
from neurotouch_hid.device.outputs.gamepad import PHYS
from tests.kernel.guest.opening import run
from tests.kernel.guest.reader import find_node
from tests.kernel.guest.sdl import look, open_games

UPLOADS = 100
EVIOCRMFF = 0x40044581


def shake(results: Path) -> dict[str, Any]:
    """What SDL 2, SDL 3 and plain evdev make of a pad that claims to rumble, and what we hear."""
    heard: list[Rumble] = []
    seen: dict[str, Any] = {}
    sys.setswitchinterval(0.001)  # as the driver has it, see process/realtime.py
    with open_device("uinput", hear_rumble=heard.append) as pad:
        device = find_node(PHYS)
        run("udevadm", "settle", "--timeout=60")
        seen["effects"] = device.capabilities()[ecodes.EV_FF]
        seen["n_effects"] = device.ff_effects_count
        with open_games() as games:
            for n, (name, game) in enumerate(games.items(), 1):
                begun = time.monotonic()
                works = game.rumbles()
                seen[name] = {"works": works, "took_s": time.monotonic() - begun}
                wait_for(lambda game=game, n=n: not look(game) and len(heard) >= 2 * n)
        seen["heard_of_games"] = [[each.strong, each.weak, each.seconds] for each in heard]
        heard.clear()
        seen["uploads_s"] = upload_many(device)
        seen["uploads_while_busy_s"] = upload_while_busy(device)
        seen["heard_of_evdev"] = len(heard)
        heard.clear()
        number = upload_effect(device, make_effect(0x8000, 0x4000, 10_000))
        device.write(ecodes.EV_FF, number, 1)
        wait_for(lambda: heard)
        seen["playing"] = [heard[-1].strong, heard[-1].weak]
        device.write(ecodes.EV_FF, ecodes.FF_GAIN, 0x7FFF)
        wait_for(lambda: heard[-1].strong < 0.4)
        seen["with_half_the_gain"] = [heard[-1].strong, heard[-1].weak]
        pad.close()  # in the middle of it
        wait_for(lambda: heard[-1].seconds == 0.0)
        seen["at_the_end"] = [heard[-1].strong, heard[-1].weak]
    return seen


def make_effect(strong: int, weak: int, length_ms: int) -> ff.Effect:
    """A rumble effect that the kernel has not numbered yet."""
    return ff.Effect(
        ecodes.FF_RUMBLE,
        -1,
        0,
        ff.Trigger(0, 0),
        ff.Replay(length_ms, 0),
        ff.EffectType(ff_rumble_effect=ff.Rumble(strong, weak)),
    )


def upload_many(device: InputDevice) -> list[float]:
    """How long each of some uploads holds the game."""
    took = []
    for _ in range(UPLOADS):
        begun = time.monotonic()
        number = upload_effect(device, make_effect(0xFFFF, 0, 1000))
        took.append(round(time.monotonic() - begun, 6))
        erase_effect(device, number)
    return took


def upload_while_busy(device: InputDevice) -> list[float]:
    """The same from another process, while a thread of ours does nothing but compute."""
    done = threading.Event()

    def compute() -> None:
        while not done.is_set():
            sum(range(1000))

    thread = threading.Thread(target=compute)
    thread.start()
    try:
        command = [sys.executable, "-m", "tests.kernel.guest.rumble", device.path]
        said = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    finally:
        done.set()
        thread.join()
    took: list[float] = json.loads(said)
    return took


def erase_effect(device: InputDevice, number: int) -> None:
    """Take an effect back; evdev's own way would hold up the thread that answers."""
    fcntl.ioctl(device.fd, EVIOCRMFF, number)


def wait_for(condition: Any, patience_s: float = 60.0) -> None:
    """Wait until it holds, or long enough; the host judges."""
    deadline = time.monotonic() + patience_s
    while not condition() and time.monotonic() < deadline:
        time.sleep(0.005)


if __name__ == "__main__":
    print(json.dumps(upload_many(InputDevice(sys.argv[1]))))
