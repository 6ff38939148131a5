"""Checks for other programs that come between our pad and the games."""

import configparser
import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from neurotouch_hid.doctor.finding import Finding, approve, skip, warn
from neurotouch_hid.doctor.inventory import find_processes
from neurotouch_hid.players import find_home

_STEAM: Final = {"steam", "steamwebhelper"}
_REMAPPERS: Final = {
    "input-remapper-service": "input-remapper",
    "input-remapper": "input-remapper",
    "keyd": "keyd",
    "kanata": "kanata",
    "kmonad": "kmonad",
    "xremap": "xremap",
    "inputplumber": "InputPlumber",
    "hhd": "Handheld Daemon",
    "antimicrox": "AntiMicroX",
    "antimicro": "AntiMicro",
    "xboxdrv": "xboxdrv",
    "sc-controller": "SC Controller",
    "scc-daemon": "SC Controller",
    "qjoypad": "QJoyPad",
}
_FLATPAK: Final = Path("/var/lib/flatpak")
_SNAPS: Final = Path("/snap")
_PLAYERS: Final = {
    "com.valvesoftware.Steam": "Steam",
    "org.mozilla.firefox": "Firefox",
    "org.chromium.Chromium": "Chromium",
    "com.google.Chrome": "Chrome",
    "com.brave.Browser": "Brave",
    "net.lutris.Lutris": "Lutris",
    "com.heroicgameslauncher.hgl": "Heroic",
    "com.usebottles.bottles": "Bottles",
    "org.libretro.RetroArch": "RetroArch",
}
_SNAP_PLAYERS: Final = ("firefox", "chromium", "steam", "brave")
_GNOME: Final = "org.gnome.desktop.a11y.keyboard"
_GNOME_KEYS: Final = {"slowkeys-enable": "slow keys", "bouncekeys-enable": "bounce keys"}
_KDE_KEYS: Final = {"SlowKeys": "slow keys", "BounceKeys": "bounce keys"}


def check_steam() -> Finding:
    """Checks whether Steam runs, whose own pad may double ours."""
    if not find_processes(_STEAM):
        return approve("Steam does not run.")
    return warn(
        "Steam runs: with Steam Input a game may see our pad twice, as itself and as Steam's.",
        "If a game reacts twice: in Steam, the game's Properties, Controller, 'Disable Steam "
        "Input'. Or start the game with SDL_GAMECONTROLLER_IGNORE_DEVICES=0x28de/0x11ff",
    )


def check_remappers() -> Finding:
    """Checks whether other programs take input devices for themselves."""
    found = find_processes(set(_REMAPPERS))
    if not found:
        return approve("No other known remapper runs.")
    names = ", ".join(f"{_REMAPPERS[each.name]} (PID {each.pid})" for each in found)
    return warn(
        f"Other remappers run: {names}. They may grab our pad, or the keyboard with the keys "
        "that stop us, for themselves.",
        "If buttons do not arrive, exclude devices whose physical path begins with "
        "'neurotouch/', or end them.",
    )


def check_sandboxes(
    flatpaks: tuple[Path, ...] = (), snaps: Path = _SNAPS, home: Path | None = None
) -> Finding:
    """Checks whether games and browsers in sandboxes can see game controllers."""
    home = home or find_home()
    flatpaks = flatpaks or (_FLATPAK, home / ".local/share/flatpak")
    shut = list(_find_shut_flatpaks(flatpaks, home))
    caged = [name for name in _SNAP_PLAYERS if (snaps / name).is_dir()]
    if not shut and not caged:
        return approve("No game or browser in a sandbox is kept from game controllers.")
    sentences, commands = [], []
    if shut:
        names = ", ".join(_PLAYERS[app] for app in shut)
        sentences.append(f"{names} (Flatpak) may not see game controllers.")
        commands += [f"flatpak override --user --device=all {app}" for app in shut]
    if caged:
        sentences.append(f"{', '.join(caged)} (Snap) may need permission to see game controllers.")
        commands += [f"sudo snap connect {name}:joystick" for name in caged]
    return warn(" ".join(sentences), "Grant it to the programs you play with.", *commands)


def _find_shut_flatpaks(folders: tuple[Path, ...], home: Path) -> Iterator[str]:
    for app in _PLAYERS:
        for folder in folders:
            metadata = folder / "app" / app / "current/active/metadata"
            if not metadata.exists():
                continue
            overrides = (folder, home / ".local/share/flatpak")
            files = (metadata, *(place / "overrides" / app for place in overrides))
            given = {device for file in files for device in _read_devices(file)}
            if not given & {"all", "input"}:
                yield app
            break


def _read_devices(file: Path) -> list[str]:
    """Returns the devices that a Flatpak file grants."""
    said = configparser.ConfigParser(strict=False, interpolation=None)
    with suppress(OSError, configparser.Error):
        said.read_string(file.read_text(errors="replace"))
        return said.get("Context", "devices", fallback="").split(";")
    return []


def check_desktop() -> Finding:
    """Checks whether the desktop filters keys, which would filter ours twice."""
    on = [*_ask_gnome(), *_ask_kde(find_home() / ".config/kaccessrc")]
    if not on:
        if not os.environ.get("XDG_CURRENT_DESKTOP"):
            return skip("No desktop runs here.")
        return approve("The desktop does not filter keys.")
    return warn(
        f"The desktop has {' and '.join(on)} switched on: keys that our profiles press are "
        "filtered twice and may come late or not at all. Pads and mice are not affected.",
        "Use a profile with pad buttons; or hold keys longer than the desktop asks for; or let "
        "only one of both filter.",
    )


def _ask_gnome() -> Iterator[str]:
    if "GNOME" not in os.environ.get("XDG_CURRENT_DESKTOP", "") or not shutil.which("gsettings"):
        return
    for key, name in _GNOME_KEYS.items():
        done = subprocess.run(  # noqa: S603
            ["gsettings", "get", _GNOME, key],  # noqa: S607
            capture_output=True,
            text=True,
            check=False,
            timeout=3,
        )
        if done.stdout.strip() == "true":
            yield name


def _ask_kde(file: Path) -> Iterator[str]:
    said = configparser.ConfigParser(strict=False, interpolation=None)
    with suppress(OSError, configparser.Error):
        said.read_string(file.read_text(errors="replace"))
        for key, name in _KDE_KEYS.items():
            if said.get("Keyboard", key, fallback="false") == "true":
                yield name
