"""Runs inside the guest: does what the tests ask about and writes what it saw, a file a chapter.

    python -m tests.kernel.guest RESULTS MACHINE|CHAPTER...

The tests on the host judge; here nothing is asserted. A chapter that fails leaves its traceback.
"""

import json
import os
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from tests.kernel.davis import load_kernels
from tests.kernel.guest import (
    browser,
    camera,
    chords,
    copilot,
    davis,
    driver,
    examination,
    extra_devices,
    eye,
    gels,
    latency,
    minute,
    opening,
    pad,
    resident,
    rumble,
    uvc,
    vivid,
    watching,
)

PADS: dict[str, Callable[[Path], Any]] = {
    # The order matters only for the first: it unloads the module.
    "opening": opening.open_in_every_state,
    **{f"claims_{which}": partial(pad.claim, which) for which in pad.PADS},
    **{f"controls_{which}": partial(pad.move_every_control, which) for which in pad.PADS},
    "closed": pad.close_while_pressed,
    "killed": pad.kill_while_pressed,
    "closed_hid": pad.close_hid_while_pressed,
    "killed_hid": pad.kill_hid_while_pressed,
    "extra_devices": extra_devices.use,
    "companions_killed": extra_devices.kill_while_held,
    "chords": chords.press,
    "doctor_pads": examination.look_at_pads,
    "rumble": rumble.shake,
    "copilot": copilot.play_along,
    "copilot_keyboard": copilot.press_keys,
    "copilot_service": resident.play_along,
    "mouse": copilot.yield_to_mouse,
    "players": copilot.two_players,
    "watching": watching.watch,
    "tour": driver.play_tour,
    "latency": latency.measure,
    "terminated": driver.terminate,
    "driver_killed": driver.kill,
    "browser": browser.read_gamepad,  # the slowest by far
}
CAMERAS: dict[str, Callable[[Path], Any]] = {
    "davis_stream": davis.stream,
    "davis_killed": davis.take_over,
    "davis_choice": davis.choose,
    "davis_plugs": davis.replug,
    "davis_faults": davis.suffer,
    "camera": camera.watch,
    "gels": gels.play_both,
}
PROCESSORS: dict[str, Callable[[Path], Any]] = {"processor": driver.lose_processor}
VIDEO: dict[str, Callable[[Path], Any]] = {
    "vivid": vivid.look,
    "vivid_faults": vivid.suffer,
    "vivid_replugged": vivid.replug,
    "uvc_description": uvc.describe,
    "uvc_pictures": uvc.take_pictures,
    "uvc_faults": uvc.suffer,
    "uvc_source": uvc.read,
    "uvc_play": uvc.play,
    "eye": eye.read,
    "minute": minute.play,
}
MACHINES = {"pads": PADS, "cameras": CAMERAS, "processors": VIDEO | PROCESSORS}
"""The last chapter of the third takes one of its two processors away."""
CHAPTERS = PADS | CAMERAS | PROCESSORS | VIDEO


CHAPTER_LIMIT_S = 900.0 + minute.N_PICTURES / 5
"""A chapter that takes longer hangs."""


def main() -> None:
    results = Path(sys.argv[1])
    (results / "booted").touch()
    modules = ["uinput", "uhid", "evdev", "joydev", "hid-generic", "vhci-hcd", "uvcvideo"]
    subprocess.run(["modprobe", "-a", *modules], check=True)
    chapters = list(MACHINES.get(sys.argv[2], sys.argv[2:]))
    # Once for all of them: a camera must not stop to think, and drivers start in half the time.
    if not CAMERAS.keys().isdisjoint(chapters):
        with suppress(TimeoutError):  # then the chapters will say what is wrong
            load_kernels()
    if not (PADS | PROCESSORS | VIDEO).keys().isdisjoint(chapters):
        driver.load_kernels()
    for name in chapters:
        begun = time.monotonic()
        answer = play(name, results)
        answer["seconds"] = round(time.monotonic() - begun, 1)
        write(results / f"{name}.json", answer)


def play(name: str, results: Path) -> dict[str, Any]:
    """Plays a chapter in a process of its own: none hangs the others, or leaves threads to them."""
    said = results / f"{name}.said"
    player = os.fork()  # a new interpreter would take a minute here to import the same again
    if not player:
        os.setsid()
        try:
            answer = {"saw": CHAPTERS[name](results)}
        except Exception:
            answer = {"failed": traceback.format_exc()}
        write(said, answer)
        os._exit(0)
    due = time.monotonic() + CHAPTER_LIMIT_S
    while not (over := os.waitpid(player, os.WNOHANG)[0]) and time.monotonic() < due:
        time.sleep(0.05)
    with suppress(ProcessLookupError):
        os.killpg(player, signal.SIGKILL)  # and what it has started and left
    if not over:
        os.waitpid(player, 0)
        return {"failed": f"not finished after {CHAPTER_LIMIT_S:.0f} s"}
    if not said.exists():
        return {"failed": "the chapter's process ended without an answer"}
    return dict(json.loads(said.read_text()))


def write(path: Path, answer: dict[str, Any]) -> None:
    """Write an answer whole or not at all."""
    unfinished = path.with_suffix(".unfinished")
    unfinished.write_text(json.dumps(answer))
    unfinished.rename(path)


main()
