"""Opens /dev/uinput and /dev/uhid in every state that a machine can have them in."""

import os
import stat
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from neurotouch_hid.device.outputs import uhid, uinput
from neurotouch_hid.errors import DeviceError

RULES = (Path("udev/70-neurotouch-uinput.rules"), Path("udev/70-neurotouch-hid.rules"))
UDEVD = "/lib/systemd/systemd-udevd"
STATIC_TAGS = Path("/run/udev/static_node-tags/uaccess")
NOBODY = 65534


@dataclass(frozen=True)
class Maker:
    """A node that makes devices, its number, and how we open it."""

    node: Path
    minor: int
    open: Callable[[], int]


MAKERS = {
    "uinput": Maker(uinput.NODE, 223, uinput.open_uinput),
    "uhid": Maker(uhid.NODE, 239, uhid.open_uhid),
}


def open_in_every_state(results: Path) -> dict[str, Any]:
    seen: dict[str, Any] = {
        name: {"without_right": as_nobody(partial(say_how_it_opens, name))} for name in MAKERS
    }
    for name in MAKERS:
        seen[name]["with_right"] = say_how_it_opens(name)
    run("udevadm", "control", "--exit")
    loader = Path("/proc/sys/kernel/modprobe")
    usual = loader.read_text()
    for name, maker in MAKERS.items():
        run("rmmod", name)
        maker.node.unlink(missing_ok=True)
        seen[name]["without_node"] = say_how_it_opens(name)
        os.mknod(maker.node, stat.S_IFCHR | 0o600, os.makedev(10, maker.minor))
        loader.write_text("/bin/false")
        seen[name]["without_module"] = say_how_it_opens(name)
        loader.write_text(usual)

    install_rules()
    run(UDEVD, "--daemon")
    run("udevadm", "settle", "--timeout=60")
    for name, maker in MAKERS.items():
        seen[name]["static_node_tagged"] = (STATIC_TAGS / name).exists()
        seen[name]["module_loaded_by_opening"] = say_how_it_opens(name)
        run("udevadm", "trigger", "--settle", f"--name-match={name}")
        seen[name]["tags"] = properties(maker.node).get("TAGS", "")
    return seen


def install_rules() -> None:
    folder = Path("/run/udev/rules.d")
    folder.mkdir(parents=True, exist_ok=True)
    for rules in RULES:
        (folder / rules.name).write_text(rules.read_text())


def say_how_it_opens(name: str) -> dict[str, str | None]:
    try:
        os.close(MAKERS[name].open())
    except DeviceError as error:
        return {"message": error.message, "hint": error.hint}
    return {"message": "opened", "hint": None}


def as_nobody(question: Any) -> Any:
    """Ask in a child process without rights."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.setgroups([])
            os.setuid(NOBODY)
            os.write(writing, repr(question()).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as answers:
        answer = answers.read()
    os.waitpid(child, 0)
    return eval(answer)


def properties(node: Path) -> dict[str, str]:
    """Return what udev knows of a node."""
    lines = run("udevadm", "info", "--query=property", str(node)).splitlines()
    return dict(line.split("=", 1) for line in lines)


def run(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout
