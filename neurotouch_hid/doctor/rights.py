"""Checks whether this person has the right to make a virtual gamepad."""

import os
import shlex
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from neurotouch_hid.doctor.finding import Finding, approve, fail, skip, warn
from neurotouch_hid.doctor.inventory import find_driver
from neurotouch_hid.resources import find_resources

_NODE: Final = Path("/dev/uinput")
_MATCH: Final = f"--name-match={_NODE}"
_LOADED: Final = Path("/sys/class/misc/uinput")
"""This path exists if the module is loaded or built in."""

FOLDERS: Final = tuple(
    Path(folder) / "udev/rules.d" for folder in ("/etc", "/run", "/usr/local/lib", "/usr/lib")
)
"""Folders of udev's rules; a file hides one of the same name in a later folder."""

_LATEST: Final = "73-seat-late.rules"
"""The file that applies the tag uaccess, so a rule that sets the tag must sort before it."""

SERVICE_RULE: Final = Path("/usr/lib/udev/rules.d/70-neurotouch-service.rules")
"""Part of the Debian package, whose service makes the pad."""

SYSTEMD: Final = Path("/run/systemd/system")
"""This path exists where systemd runs."""

_MODULES: Final = "/etc/modules-load.d/neurotouch.conf"
PACKAGED_MODULES: Final = Path("/usr/lib/modules-load.d/neurotouch.conf")
"""Part of the Debian package, which loads the module at every start."""

UDEV: Final = Path("/run/udev/control")
"""This path exists where udev runs; in most containers it does not."""


def has_service() -> bool:
    """Tells whether the Debian package's service can run here."""
    return SERVICE_RULE.exists() and SYSTEMD.exists()


def apply_rules(match: str) -> tuple[str, ...]:
    """Returns the commands by which udev applies changed rules at once; none where no udev runs.

    Args:
        match: which devices, as options of ``udevadm trigger``.
    """
    if not UDEV.exists():
        return ()
    return (
        "sudo udevadm control --reload",
        f"sudo udevadm trigger --action=change {match}",
        "sudo udevadm settle --timeout=10",
    )


def install_rule(name: str) -> str:
    """Returns the command that installs one of our rules."""
    source = find_resources("udev") / name
    return shlex.join(
        ["sudo", "install", "-D", "-m", "644", str(source), f"/etc/udev/rules.d/{name}"]
    )


def _load_module() -> tuple[str, ...]:
    """Returns the commands that load the module, now and at every start."""
    for_ever = f"echo uinput | sudo tee {_MODULES}"
    return (*(() if PACKAGED_MODULES.exists() else (for_ever,)), "sudo modprobe uinput")


def check_module() -> Finding:
    """Checks whether the kernel's module for virtual devices exists and is loaded."""
    if _LOADED.exists():
        return approve("The kernel module uinput is loaded.")
    if not _NODE.exists():
        return fail(
            "There is no /dev/uinput: the kernel module uinput is not loaded.",
            "Load it, now and at every start; in a container the host must pass it on.",
            *_load_module(),
        )
    return warn(
        "/dev/uinput exists, but the kernel module uinput behind it is not loaded.",
        "On most systems, opening it loads the module; newer ones must load it at every start.",
        *_load_module(),
    )


def needs_no_right() -> str:
    """Returns why this person needs no right to make a pad; empty if they need one."""
    if os.access(_NODE, os.R_OK | os.W_OK):
        return "You may make virtual gamepads."
    running = find_driver()
    if running is not None and running["device"] != "memory":
        return f"The running driver has a pad: {running['device']}."
    if has_service():
        return "The service makes the pad once a camera is plugged in, so you need no right for it."
    return ""


def check_pad_right() -> Finding:
    """Checks whether this user may write to it."""
    if reason := needs_no_right():
        return approve(reason)
    if not _NODE.exists():
        return skip("Needs /dev/uinput.")
    mode = stat.S_IMODE(_NODE.stat().st_mode)
    return fail(
        f"You have no right to write to /dev/uinput (its mode is {mode:04o}).",
        "Allow it for the person at the machine, as 'neurotouch setup' does.",
        install_rule("70-neurotouch-uinput.rules"),
        *apply_rules(_MATCH),
    )


def check_rule(folders: tuple[Path, ...] = FOLDERS) -> Finding:
    """Checks that a rule gives it to the person at the machine, and early enough."""
    found = list(_find_rules(folders))
    if not found:
        if reason := needs_no_right():
            return skip(f"No rule is needed. {reason}")
        return warn(
            "No udev rule gives /dev/uinput to the person at the machine.",
            "Install ours, as 'neurotouch setup' does.",
            install_rule("70-neurotouch-uinput.rules"),
            *apply_rules(_MATCH),
        )
    in_time = [(path, line) for path, line in found if path.name < _LATEST]
    if not in_time:
        path = found[0][0]
        return warn(
            f"{path} applies too late: its name must sort before {_LATEST}.",
            "Give it a number below 73, or install ours beside it.",
            install_rule("70-neurotouch-uinput.rules"),
            *apply_rules(_MATCH),
        )
    lasting = [path for path, line in in_time if "static_node=uinput" in line]
    if not lasting:
        path = in_time[0][0]
        return warn(
            f"{path} says nothing of static_node=uinput, so it applies only once the module is "
            "loaded.",
            "Load the module at every start.",
            *_load_module(),
        )
    return approve(f"{lasting[0]} gives /dev/uinput to the person at the machine.")


def _find_rules(folders: tuple[Path, ...]) -> Iterator[tuple[Path, str]]:
    """Yields the rules that tag uinput with uaccess, with their files; omits hidden files."""
    files: dict[str, Path] = {}
    for folder in reversed(folders):
        files |= {path.name: path for path in folder.glob("*.rules")}
    for _, path in sorted(files.items()):
        try:
            text = path.read_text(errors="replace").replace("\\\n", " ")
        except OSError:
            continue
        for line in text.splitlines():
            if line.lstrip().startswith("#"):
                continue
            if "uinput" in line and "uaccess" in line:
                yield path, line


def check_seat() -> Finding:
    """Checks whether this person's session has a seat at the machine, as logind defines it."""
    if os.geteuid() == 0:
        return skip("You are root and need no seat.")
    if os.environ.get("XDG_SEAT"):
        return approve(f"You sit at {os.environ['XDG_SEAT']}.")
    if reason := needs_no_right():
        return skip(f"No seat is needed. {reason}")
    where = "over ssh" if os.environ.get("SSH_CONNECTION") else "in a session without a seat"
    return warn(
        f"You are logged in {where}, and rules for the person at the machine do not apply there.",
        "Log in at the machine itself; or give your user the group 'input', which may also read "
        "all keyboards, and log in again.",
        'echo \'KERNEL=="uinput", SUBSYSTEM=="misc", GROUP="input", MODE="0660", '
        'OPTIONS+="static_node=uinput"\' | sudo tee /etc/udev/rules.d/71-neurotouch-group.rules',
        'sudo usermod -aG input "$(id -un)"',
        *apply_rules(_MATCH),
    )
