"""Runs inside the guest, as root: does what the tests ask about and writes what it saw.

    python -m tests.system.guest RESULTS [CHAPTER...]

The tests on the host judge; here nothing is asserted. A chapter that fails leaves its traceback,
and the next ones go on as well as they can.
"""

import json
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.system.guest import additions, package, people, service, trouble
from tests.system.guest.camera import Camera
from tests.system.guest.desk import Desk
from tests.system.guest.observation import SERVICE, run

CHAPTERS: dict[str, Callable[[Desk], Any]] = {
    "install": package.install,
    "rights": package.look_at_rights,
    "play": service.play,
    "pull": service.pull,
    "storm": service.storm,
    "order": service.order,
    "people": people.share,
    "another": service.start_another,
    "upgrade": package.upgrade,
    "versions": package.change_versions,
    "stop": service.stop,
    "crash": service.crash,
    "settings": service.read_settings,
    "switched_off": service.switch_off,
    "mute": service.stay_mute,
    "hang": service.hang,
    "clock": trouble.jump,
    "full": trouble.fill,
    "read_only": trouble.protect,
    "memory": trouble.hog,
    "frozen": trouble.freeze,
    "second": additions.play_second,
    "together": additions.start_together,
    "examples": additions.add_examples,
    "purge": package.purge,
    "set_up": package.set_up,
}

IN_CONTAINER = Path("/run/systemd/container")
"""systemd writes there which kind of container it runs in; a machine has no such file."""


def describe_machine() -> str:
    """What the service and the kernel say of it."""
    looks = (
        ("neurotouch", "status"),
        ("journalctl", "--no-pager", "--lines=20", f"--unit={SERVICE}"),
        ("journalctl", "--no-pager", "--lines=5", "--dmesg", "--grep=traps|oom|Out of memory"),
    )
    return "".join(f"\n{' '.join(look)}:\n{run(*look)['out'][-3000:]}" for look in looks)


def main() -> None:
    results = Path(sys.argv[1])
    chosen = (results / "chapters").read_text().split() or list(CHAPTERS)
    if "install" not in chosen:  # without the package no chapter has anything to see
        chosen.insert(0, "install")
    camera = None if IN_CONTAINER.exists() else Camera(results / "scene.aedat4")
    desk = Desk(results, next(results.glob("*.deb")), camera)
    for name in chosen:
        begun = time.monotonic()
        try:
            answer = {"saw": CHAPTERS[name](desk)}
        except Exception:
            answer = {"failed": traceback.format_exc() + describe_machine()}
        answer["seconds"] = round(time.monotonic() - begun, 1)
        print(f"{name}: {answer['seconds']} s", flush=True)
        unfinished = results / f"{name}.unfinished"
        unfinished.write_text(json.dumps(answer))
        unfinished.rename(results / f"{name}.json")


main()
