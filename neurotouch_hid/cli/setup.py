"""``neurotouch setup``: installs rules and the menu's entry, for people who use pip."""

import os
import shlex
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from textwrap import indent
from typing import Final

import click

from neurotouch_hid.cli.setup_menu import (
    find_menu_entry,
    install_menu_entry,
    needs_menu_entry,
    remove_menu_entry,
)
from neurotouch_hid.cli.setup_windows import change_windows, list_installed
from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.doctor.rights import UDEV, has_service
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.resources import find_resources

_RULES: Final = Path("/etc/udev/rules.d")
_MODULES: Final = Path("/etc/modules-load.d")

_MEANING: Final = {
    "70-neurotouch-uinput.rules": "lets the person at the machine make virtual gamepads, "
    "keyboards and mice, with any program",
    "70-neurotouch-camera.rules": "lets the person at the machine open the camera",
    "neurotouch.conf": "loads the kernel's module for them at every start",
}


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch setup --dry-run        only show the changes\n"
    "  neurotouch setup                  show them, ask, make them (with sudo or pkexec)\n"
    "  neurotouch setup --uninstall      remove everything again\n"
    "  neurotouch setup --windows        let KDE or GNOME say which program is in front\n\n"
    "Exit codes: 0 done, 1 not done."
)
@click.option("--dry-run", is_flag=True, help="Only show the changes.")
@click.option("--uninstall", is_flag=True, help="Remove the files that setup has installed.")
@click.option("--yes", is_flag=True, help="Do not ask.")
@click.option(
    "--windows",
    is_flag=True,
    help="Only for profiles of applications: install or remove what KDE and GNOME need under "
    "Wayland.",
)
def command(dry_run: bool, uninstall: bool, yes: bool, windows: bool) -> None:
    """Install the rules that camera and pad need, for people who installed with pip.

    You also get an entry in your desktop's menu of programs. Then the program compiles for this
    processor, which the first start would do otherwise.

    The Debian package does all this itself, with fewer rights: only its service gets them.
    """
    if windows:
        change_windows(dry_run, uninstall, yes)
        return
    if has_service() and not uninstall:
        raise NeuroTouchError(
            "The Debian package is installed, and its service has all the rights it needs.",
            hint="There is nothing to do. See: systemctl status neurotouch",
        )
    files, entry = _list_files(), find_menu_entry(os.environ)
    has_entry = entry.exists() if uninstall else needs_menu_entry(os.environ)
    if uninstall:
        files = {source: target for source, target in files.items() if target.exists()}
        if list_installed(os.environ):
            echo("What the desktop got stays. Remove it: neurotouch setup --windows --uninstall")
        if not files and not has_entry:
            echo("Setup has installed nothing here, so there is nothing to remove.")
            return
    script = _remove(files) if uninstall else _install(files)
    if files:
        echo("These files will be removed:" if uninstall else "These files will be installed:")
        for source, target in files.items():
            echo(f"  {target}\n    {_MEANING[source.name]}")
        echo("with these commands, as root:")
        echo(indent("\n".join(script), "  "))
    if has_entry:
        change = "lose" if uninstall else "get"
        echo(f"Your own menu of programs will {change} this entry, without root:\n  {entry}")
    if not uninstall:
        echo(
            "Then the program compiles itself for this processor, so that the first start is short."
        )
    if dry_run:
        return
    if not yes:
        click.confirm("Continue?", abort=True)
    if files:
        _run_as_root(script)
    if has_entry:
        remove_menu_entry(entry) if uninstall else install_menu_entry(entry)
    if uninstall:
        stays = " A camera that is plugged in stays open to you until it is unplugged."
        echo(f"Done.{stays if files else ''}")
        return
    echo("All is installed. Compiling for this processor (once, half a minute or more) ...")
    _compile()
    echo("Done. Check with: neurotouch doctor")


def _list_files() -> dict[Path, Path]:
    """Yields each file that comes with the program, and its destination."""
    rules, modules = find_resources("udev"), find_resources("modules-load.d")
    return {
        rules / "70-neurotouch-uinput.rules": _RULES / "70-neurotouch-uinput.rules",
        rules / "70-neurotouch-camera.rules": _RULES / "70-neurotouch-camera.rules",
        modules / "neurotouch.conf": _MODULES / "neurotouch.conf",
    }


def _install(files: dict[Path, Path]) -> list[str]:
    """Gives the commands that install each file.

    They hold its text: root must not read it from a folder that others can write, where it may
    have changed since it was shown.
    """
    copies = [
        f"install -D -m 644 /dev/stdin {shlex.quote(str(target))} << 'END'\n"
        f"{source.read_text(encoding='utf-8')}END"
        for source, target in files.items()
    ]
    # The module first: without it there is no device to trigger.
    return [*copies, "modprobe uinput", "udevadm control --reload", *_have_udev_look_again()]


def _remove(files: dict[Path, Path]) -> list[str]:
    return [
        shlex.join(["rm", "-f", *map(str, files.values())]),
        "udevadm control --reload",
        # The first trigger still finds the tag of the removed rule, and gives the right once more.
        *_have_udev_look_again(),
        # A node keeps rights once given: this removes them, and other rules give theirs again.
        "if [ -e /dev/uinput ]; then chmod 600 /dev/uinput; fi",
        *_have_udev_look_again(),
    ]


def _have_udev_look_again() -> list[str]:
    return [
        "udevadm trigger --action=change --sysname-match=uinput",
        "udevadm trigger --action=change --subsystem-match=usb --attr-match=idVendor=152a",
        "udevadm settle --timeout=10",
    ]


def _compile() -> None:
    """Compiles what the first start would compile; if this fails, the first start does it.

    With ``sudo neurotouch setup`` it would be kept for root, not for the person who plays.
    """
    from neurotouch_hid.driver import Driver, DriverOptions
    from neurotouch_hid.process.kernel_cache import find_cache_trouble

    later = "This will be done at the first start instead."
    if os.geteuid() == 0 and os.environ.keys() & {"SUDO_UID", "PKEXEC_UID"}:
        echo(later)
        return
    options = DriverOptions(profile="default", device="memory", personal=False, wait=True)
    try:
        for source in (options.source, "sim:tour"):  # the camera, and that of a demo
            Driver(replace(options, source=source)).compile()
    except NeuroTouchError as error:
        echo(f"{error} {later}")
    if trouble := find_cache_trouble():
        echo(f"Warning: {trouble}")


def _list_gates() -> tuple[str, ...]:
    """Returns the ways to become root; the first asks where the person can answer."""
    desktop = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if desktop and not sys.stdin.isatty():  # the page has started us
        return "pkexec", "sudo"
    return "sudo", "pkexec"


def _run_as_root(script: list[str]) -> None:
    """Runs the commands up to the first that fails; asks for the password once.

    Raises:
        NeuroTouchError: one of them failed, or there is no way to become root.
    """
    if not UDEV.exists():
        raise NeuroTouchError(
            "No udev runs here, so there is nothing to set up.",
            hint="In a container: run this on the host; pass /dev/uinput and the camera to it.",
        )
    shell = ["sh", "-euc", "\n".join(script)]
    if os.geteuid() != 0:
        gate = next(filter(None, map(shutil.which, _list_gates())), None)
        if gate is None:
            raise NeuroTouchError(
                "Neither sudo nor pkexec is installed, so this command cannot become root.",
                hint="Ask an administrator to run the commands above.",
            )
        shell.insert(0, gate)
    done = subprocess.run(shell, check=False)  # noqa: S603 -- shown above, word by word
    if done.returncode != 0:
        raise NeuroTouchError(
            f"It stopped before the end: exit code {done.returncode}.",
            hint="The cause is above. The command can safely be run again.",
        )
