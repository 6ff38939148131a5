"""``neurotouch setup --windows``: lets KDE and GNOME tell which program is in front."""

import ast
import importlib.util
import os
import shutil
import subprocess
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Final

import click

from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.desktop import GNOME_UUID, find_gnome_extension, find_kwin_script
from neurotouch_hid.desktop.libraries import explain_install
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.players import SERVICE_UNIT
from neurotouch_hid.resources import find_resources

_LISTS: Final = ("enabled-extensions", "disabled-extensions")
_EXTENSION_FILES: Final = ("metadata.json", "extension.js")


def change_windows(dry_run: bool, uninstall: bool, yes: bool) -> None:
    """Installs what this desktop needs, or removes all that was installed; asks first.

    Raises:
        NeuroTouchError: this desktop needs nothing, or it could not be done.
    """
    environment = dict(os.environ)
    files = list_installed(environment) if uninstall else _list_files(environment)
    is_gnome = any(find_gnome_extension(environment) in path.parents for path in files)
    if uninstall and not files:
        echo("Setup has installed nothing here, so there is nothing to remove.")
        return
    echo("These files will be removed:" if uninstall else "These files will be installed:")
    for path in files:
        echo(f"  {path}")
    if is_gnome:
        echo(f"GNOME's list of extensions will {'lose' if uninstall else 'get'} {GNOME_UUID}.")
    if not uninstall:
        echo("They tell the driver which program is in front. They do not read titles.")
    if dry_run:
        return
    if not yes:
        click.confirm("Continue?", abort=True)
    try:
        if uninstall:
            _remove(files, is_gnome)
        else:
            _install(files, is_gnome)
    except OSError as error:
        raise NeuroTouchError(
            f"It stopped before the end: {error.filename}: {error.strerror}.",
            hint="The command can safely be run again.",
        ) from error
    if uninstall:
        echo("Done.")
    elif is_gnome:
        echo("Done. Log out and in again, then start the driver: GNOME loads it then.")
    elif SERVICE_UNIT.exists():
        echo("Done. For the service: systemctl --user restart neurotouch-session")
    else:
        echo("Done. Start the driver again: it uses it from then on.")
    if not uninstall and importlib.util.find_spec("jeepney") is None:
        echo(f"The driver needs one more library. {explain_install('python3-jeepney')}")


def _list_files(environment: Mapping[str, str]) -> dict[Path, str]:
    """Returns the files that this desktop needs, with their text.

    Raises:
        NeuroTouchError: it needs none.
    """
    desktops = environment.get("XDG_CURRENT_DESKTOP", "").split(":")
    source = find_resources("windows")
    if environment.get("WAYLAND_DISPLAY") and "KDE" in desktops:
        path = find_kwin_script(environment)
        return {path: (source / path.name).read_text(encoding="utf-8")}
    if environment.get("WAYLAND_DISPLAY") and "GNOME" in desktops:
        folder = find_gnome_extension(environment)
        return {
            folder / name: (source / name).read_text(encoding="utf-8") for name in _EXTENSION_FILES
        }
    if not environment.get("WAYLAND_DISPLAY") and not environment.get("DISPLAY"):
        raise NeuroTouchError(
            "No desktop is running here.",
            hint="Type this in a terminal of the desktop, not as root and not over the network.",
        )
    raise NeuroTouchError(
        "This desktop needs nothing installed: only KDE and GNOME under Wayland do.",
        hint="See which windows are seen while a driver runs: neurotouch status",
    )


def list_installed(environment: Mapping[str, str]) -> dict[Path, str]:
    """Returns the files that this command has installed for the person, without their text."""
    folder = find_gnome_extension(environment)
    paths = [find_kwin_script(environment), *(folder / name for name in _EXTENSION_FILES)]
    return {path: "" for path in paths if path.exists()}


def _install(files: Mapping[Path, str], is_gnome: bool) -> None:
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text.encode())
    if is_gnome:
        enabled = _read_list("enabled-extensions")
        if GNOME_UUID not in enabled:
            _write_list("enabled-extensions", [*enabled, GNOME_UUID])


def _remove(files: Mapping[Path, str], is_gnome: bool) -> None:
    if is_gnome:
        for name in _LISTS:
            found = _read_list(name)
            if GNOME_UUID in found:
                _write_list(name, [each for each in found if each != GNOME_UUID])
    for path in files:
        path.unlink(missing_ok=True)
    for folder in {path.parent for path in files}:
        with suppress(OSError):  # another program has put a file there
            folder.rmdir()


def _read_list(name: str) -> list[str]:
    """Returns a list of GNOME's settings.

    Raises:
        NeuroTouchError: the settings cannot be read.
    """
    text = _ask_gsettings("get", name).removeprefix("@as ")
    try:
        return [str(each) for each in ast.literal_eval(text)]
    except (ValueError, SyntaxError):
        raise NeuroTouchError(f"GNOME's setting '{name}' cannot be read: {text}.") from None


def _write_list(name: str, extensions: list[str]) -> None:
    """Changes a list of GNOME's settings; the default leaves no entry."""
    _ask_gsettings("reset", name)
    if _read_list(name) != extensions:
        _ask_gsettings("set", name, str(extensions))


def _ask_gsettings(*words: str) -> str:
    program = shutil.which("gsettings")
    if program is None:
        raise NeuroTouchError(
            "The program 'gsettings' is missing, so GNOME's settings cannot be changed.",
            hint="Install it (Debian: libglib2.0-bin), then type this again.",
        )
    action, *rest = words
    done = subprocess.run(  # noqa: S603 - a program of the system, with names of our own
        [program, action, "org.gnome.shell", *rest], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise NeuroTouchError(f"GNOME's settings cannot be changed: {done.stderr.strip()}.")
    return done.stdout.strip()
