"""Runs inside the guest: does what the tests ask about and writes what it saw, a file a chapter.

    python -m tests.kernel.guest RESULTS [CHAPTER...]

The tests on the host judge; here nothing is asserted. A chapter that fails leaves its traceback.
"""

import json
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.kernel.guest import chords, companions, driver, opening, pad

CHAPTERS: dict[str, Callable[[Path], Any]] = {
    # The order matters only for the first: it unloads the module.
    "opening": opening.open_in_every_state,
    "claims": pad.claim,
    "controls": pad.move_every_control,
    "closed": pad.close_while_pressed,
    "killed": pad.kill_while_pressed,
    "companions": companions.use,
    "companions_killed": companions.kill_while_held,
    "chords": chords.press,
    "tour": driver.play_tour,
    "terminated": driver.terminate,
    "driver_killed": driver.kill,
}


def main() -> None:
    results = Path(sys.argv[1])
    (results / "booted").touch()
    subprocess.run(["modprobe", "-a", "uinput", "evdev", "joydev"], check=True)
    for name in sys.argv[2:] or CHAPTERS:
        begun = time.monotonic()
        try:
            answer = {"saw": CHAPTERS[name](results)}
        except Exception:
            answer = {"failed": traceback.format_exc()}
        answer["seconds"] = round(time.monotonic() - begun, 1)
        unfinished = results / f"{name}.unfinished"
        unfinished.write_text(json.dumps(answer))
        unfinished.rename(results / f"{name}.json")


main()
