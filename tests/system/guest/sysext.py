"""The image for systems with a read-only ``/usr``: merged, played with, renewed, removed.

    python -m tests.system.guest.sysext RESULTS

Runs in a guest of its own, without the package. The folder of results has two images, ``older.raw``
and ``newer.raw``, and the kernels compiled for both.
"""

import json
import signal
import subprocess
import sys
import time
import traceback
from contextlib import suppress
from pathlib import Path
from typing import Any

from tests.system.guest.camera import Camera
from tests.system.guest.observation import (
    PLAYER,
    Reader,
    find_pad,
    run,
    run_as,
    wait_for,
)
from tests.system.guest.package import find_allowed, find_camera

_IMAGE = Path("/var/lib/extensions/neurotouch-hid.raw")
_HOME = Path(f"/home/{PLAYER}")
_PLACES = ("/etc", "/usr", "/var", "/run", "-name", "*neurotouch*")
_STARTS_S = 600.0
_TOPS = ("/bin/", "/lib/", "/lib64/", "/sbin/")
"""Of ``/usr``; in the root they are links, under which the kernel shows no file."""


class Play:
    """A driver that the player started.

    Args:
        results: the folder for what it says.
    """

    def __init__(self, results: Path) -> None:
        with (results / "driver.txt").open("a") as output:
            self._process = subprocess.Popen(
                ["neurotouch", "run"],
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                user=PLAYER,
                group=PLAYER,
                extra_groups=[],
                env={
                    "PATH": "/usr/bin:/bin",
                    "HOME": str(_HOME),
                    "XDG_RUNTIME_DIR": f"/run/user/{_HOME.stat().st_uid}",
                    "NUMBA_CPU_NAME": "generic",
                },
            )
        self.reader = Reader(wait_for(find_pad, _STARTS_S))
        wait_for(self.reader.is_pushed)

    def push_again(self) -> bool:
        """Returns whether the pad goes neutral and then is pushed out, on the same node."""
        wait_for(self.reader.is_neutral)
        wait_for(self.reader.is_pushed)
        return self.reader.ended is None

    def stop(self) -> int:
        """Asks the driver to end, and returns its exit code."""
        self._process.send_signal(signal.SIGINT)
        return self._process.wait(120)


def main() -> None:
    results = Path(sys.argv[1])
    try:
        answer = {"saw": use(results, Camera(results / "scene.aedat4"))}
    except Exception:
        said = (results / "driver.txt").read_text() if (results / "driver.txt").exists() else ""
        answer = {"failed": traceback.format_exc() + said[-3000:]}
    (results / "sysext.json").write_text(json.dumps(answer))


def use(results: Path, camera: Camera) -> dict[str, Any]:
    """Does what docs/install.md says, and notes what there is after each step."""
    # Of the system's own libraries, the program needs this one.
    run("apt-get", "install", "--yes", "libusb-1.0-0")
    run("mount", "--bind", "/usr", "/usr")
    run("mount", "-o", "remount,bind,ro", "/usr")
    _prepare_player(results)
    camera.plug()
    wait_for(find_camera)
    saw: dict[str, Any] = {"before": _look()}

    _copy(results / "older.raw")
    saw["merge"] = run("systemctl", "enable", "--now", "systemd-sysext")
    saw["merged"] = _look()
    saw["setup"] = run("neurotouch", "setup", "--yes")
    run("udevadm", "settle")
    saw["set_up"] = _look()
    play = Play(results)
    saw["plays"] = play.push_again()

    _copy(results / "newer.raw")
    saw["refresh"] = run("systemd-sysext", "refresh")
    saw["plays_on"] = play.push_again()
    saw["renewed"] = _look()
    saw["ended"] = play.stop()
    wait_for(lambda: find_pad() is None)
    play = Play(results)
    saw["plays_renewed"] = play.push_again()
    saw["ended_renewed"] = play.stop()

    saw["uninstall"] = run("neurotouch", "setup", "--uninstall", "--yes")
    _IMAGE.unlink()
    saw["last_refresh"] = run("systemd-sysext", "refresh")
    run("udevadm", "settle")
    time.sleep(1.0)
    return {**saw, "after": _look()}


def _prepare_player(results: Path) -> None:
    """Gives the player the compiled kernels, and a camera with a quarter of the packets."""
    cache, settings = _HOME / ".cache", _HOME / ".config/neurotouch"
    for folder in (cache, settings):
        folder.mkdir(parents=True)
    run("cp", "-r", str(results / "compiled-extension"), str(cache / "neurotouch"))
    (settings / "camera.yaml").write_text("version: 1\nearly_packet_delay_us: 1000\n")
    run("chown", "-R", f"{PLAYER}:{PLAYER}", str(_HOME))


def _copy(image: Path) -> None:
    run("install", "-D", "-m", "644", str(image), str(_IMAGE))


def _look() -> dict[str, Any]:
    """What is there: the command, its files, rights of the player, and what is mounted."""
    return {
        "version": run_as(PLAYER, "sh", "-c", "neurotouch --version")["out"].strip(),
        "files": sorted(run("find", *_PLACES)["out"].split()),
        "allowed": find_allowed("/dev/uinput", find_camera() or ""),
        "usr_is_read_only": run("touch", "/usr/bin/written")["code"] != 0,
        "mounts": run("findmnt", "--noheadings", "--output=FSTYPE", "/usr")["out"].split(),
        "failed_units": run("systemctl", "--failed", "--no-legend", "--plain")["out"],
        "loops": run("losetup", "--noheadings", "--list", "--output=BACK-FILE")["out"].split("\n"),
        "holders": find_holders(),
    }


def find_holders() -> dict[str, list[str]]:
    """Finds programs that still use files of an extension that is no longer mounted.

    A program that began, or loaded a library of ``/usr``, while an extension lay over it keeps
    this layer, and the loop device of its image, until it ends. The kernel shows such a file by
    its path in the layer, so without ``/usr``.

    Returns:
        By process id and name, the paths of the libraries.
    """
    holders = {}
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it has ended
            words = (line.split() for line in (process / "maps").read_text().splitlines())
            paths = {line[5] for line in words if len(line) > 5 and line[5].startswith(_TOPS)}
            if paths:
                name = (process / "comm").read_text().strip()
                holders[f"{process.name} {name}"] = sorted(paths)
    return holders


if __name__ == "__main__":
    main()
