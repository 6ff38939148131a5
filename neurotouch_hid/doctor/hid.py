"""Checks whether a HID pad can be made, if a person has chosen one."""

import os
import shlex
import shutil
import stat
import subprocess
from pathlib import Path
from typing import Final

from neurotouch_hid.doctor.finding import Finding, approve, fail, skip
from neurotouch_hid.doctor.rights import SERVICE_RULE, apply_rules, install_rule
from neurotouch_hid.driver.service_settings import ServiceSettings, find_service_file
from neurotouch_hid.profile.reading import load_settings

_NODE: Final = Path("/dev/uhid")
_LOADED: Final = Path("/sys/class/misc/uhid")
"""This path exists if the module is loaded or built in."""

_SERVICE_FILE: Final = Path("/etc/neurotouch/service.yaml")
_EXAMPLE: Final = "/usr/share/doc/neurotouch-hid/examples/hid.conf"
_DROP_IN: Final = "/etc/systemd/system/neurotouch.service.d/hid.conf"
_LOAD: Final = (
    "echo uhid | sudo tee /etc/modules-load.d/neurotouch-hid.conf",
    "sudo modprobe uhid",
)
_PATIENCE_S: Final = 5.0


def check_hid(
    files: tuple[Path, ...] = (),
    *,
    node: Path = _NODE,
    loaded: Path = _LOADED,
    package: Path = SERVICE_RULE,
) -> Finding:
    """Checks what a HID pad needs: the kernel module, the right, and the service's own right.

    Args:
        files: possible settings files; by default those of this machine and this person.
        node: the node that makes HID devices.
        loaded: path that exists if its module is loaded.
        package: path that exists if the Debian package is installed.
    """
    asking = _find_asking(files or (_SERVICE_FILE, find_service_file()))
    usable = os.access(node, os.R_OK | os.W_OK)
    if asking is None:
        if usable:
            return approve("You can also make a HID pad: neurotouch run --device hid")
        return skip("No HID pad is requested ('device: hid' in service.yaml).")
    asks = f"{asking} requests a HID pad"
    if not node.exists() or not loaded.exists():
        return fail(
            f"{asks}, but the kernel module uhid is not loaded.",
            "Load it, now and at every start. If it is not found, install your distribution's "
            "package of extra kernel modules; in a container the host must pass /dev/uhid on.",
            *_LOAD,
        )
    if package.exists():
        return _check_service(asks)
    if usable:
        return approve(f"{asks}, and you have the right to make one.")
    mode = stat.S_IMODE(node.stat().st_mode)
    return fail(
        f"{asks}, but you have no right to write to {node} (its mode is {mode:04o}).",
        "Allow it for the person at the machine. Note that all of that person's programs can then "
        "make HID devices of any kind.",
        install_rule("70-neurotouch-hid.rules"),
        *apply_rules("--name-match=/dev/uhid"),
    )


def _find_asking(files: tuple[Path, ...]) -> Path | None:
    """Returns the first of the files that requests a HID pad.

    Raises:
        ProfileError: one of them has mistakes.
    """
    for file in files:
        if load_settings(file, ServiceSettings).device == "hid":
            return file
    return None


def _check_service(asks: str) -> Finding:
    """Checks whether the service may use the node; it must be allowed to explicitly."""
    if not shutil.which("systemctl"):
        return skip("systemd does not run here.")
    done = subprocess.run(
        ["systemctl", "show", "neurotouch.service", "--property=DeviceAllow"],  # noqa: S607
        capture_output=True,
        text=True,
        check=False,
        timeout=_PATIENCE_S,
    )
    if "/dev/uhid" in done.stdout:
        return approve(f"{asks}, and the service has the right to make one.")
    return fail(
        f"{asks}, but the service has no right to /dev/uhid.",
        "Allow it. Note that this right also allows keyboards and security keys.",
        shlex.join(["sudo", "install", "-D", "-m", "644", _EXAMPLE, _DROP_IN]),
        "sudo systemctl daemon-reload",
        "sudo systemctl restart neurotouch",
    )
