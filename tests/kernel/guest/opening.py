"""Opens /dev/uinput in every state that a machine can have it in."""

import os
import stat
import subprocess
from pathlib import Path
from typing import Any

from neurotouch_hid.device.uinput import NODE, open_uinput
from neurotouch_hid.errors import DeviceError

RULES = Path("udev/70-neurotouch-uinput.rules")
UDEVD = "/lib/systemd/systemd-udevd"
STATIC_TAG = Path("/run/udev/static_node-tags/uaccess/uinput")
NOBODY = 65534


def open_in_every_state(results: Path) -> dict[str, Any]:
    seen: dict[str, Any] = {
        "without_right": as_nobody(say_how_it_opens),
        "with_right": say_how_it_opens(),
    }
    run("udevadm", "control", "--exit")
    run("rmmod", "uinput")
    NODE.unlink(missing_ok=True)
    seen["without_node"] = say_how_it_opens()

    os.mknod(NODE, stat.S_IFCHR | 0o600, os.makedev(10, 223))
    loader = Path("/proc/sys/kernel/modprobe")
    usual = loader.read_text()
    loader.write_text("/bin/false")
    seen["without_module"] = say_how_it_opens()
    loader.write_text(usual)

    install_rules()
    run(UDEVD, "--daemon")
    run("udevadm", "settle", "--timeout=20")
    seen["static_node_tagged"] = STATIC_TAG.exists()
    seen["module_loaded_by_opening"] = say_how_it_opens()
    run("udevadm", "trigger", "--settle", "--name-match=uinput")
    seen["tags"] = properties(NODE).get("TAGS", "")
    return seen


def install_rules() -> None:
    folder = Path("/run/udev/rules.d")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / RULES.name).write_text(RULES.read_text())


def say_how_it_opens() -> dict[str, str | None]:
    try:
        os.close(open_uinput())
    except DeviceError as error:
        return {"message": error.message, "hint": error.hint}
    return {"message": "opened", "hint": None}


def as_nobody(question: Any) -> Any:
    """Ask in a child process without rights."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.setgroups([])
        os.setuid(NOBODY)
        answer = question()
        os.write(writing, repr(answer).encode())
        os._exit(0)
    os.waitpid(child, 0)
    os.close(writing)
    with os.fdopen(reading) as answers:
        return eval(answers.read())


def properties(node: Path) -> dict[str, str]:
    """Return what udev knows of a node."""
    lines = run("udevadm", "info", "--query=property", str(node)).splitlines()
    return dict(line.split("=", 1) for line in lines)


def run(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout
