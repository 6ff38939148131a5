"""Makes a report about this machine for a bug thread, without private data."""

import importlib.metadata
import os
import platform
import pwd
import re
import socket
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

from neurotouch_hid import __version__
from neurotouch_hid.doctor import Finding
from neurotouch_hid.doctor.inventory import find_driver, find_pads
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.profile import list_profiles, load_user
from neurotouch_hid.profile.reading import find_shipped_folder
from neurotouch_hid.source.davis import find_cameras
from neurotouch_hid.status import Status
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

VARIABLES: Final = (
    "container",
    "DISPLAY",
    "LANG",
    "NO_COLOR",
    "NT_ACCESSIBLE",
    "NUMBA_CPU_NAME",
    "NUMBA_DISABLE_JIT",
    "NUMBA_NUM_THREADS",
    "SDL_GAMECONTROLLERCONFIG",
    "SDL_GAMECONTROLLER_IGNORE_DEVICES",
    "SDL_GAMECONTROLLER_IGNORE_DEVICES_EXCEPT",
    "SDL_JOYSTICK_DEVICE",
    "SDL_JOYSTICK_DISABLE_UDEV",
    "SDL_JOYSTICK_HIDAPI",
    "TERM",
    "WAYLAND_DISPLAY",
    "XDG_CURRENT_DESKTOP",
    "XDG_SEAT",
    "XDG_SESSION_TYPE",
)
"""The only environment variables that the report contains."""

LEFT_OUT: Final = (
    "your user name, real name, home folder and the name of this machine",
    "serial numbers of cameras, network and Bluetooth addresses",
    "all environment variables but those shown, and names of windows",
    "your profiles, your calibration, recordings and pictures, and the names of their files",
    "the lines of your files that have errors",
    "the names and places of devices that are not ours",
)

_PRIVATE_FACTS: Final = ("desktop",)
"""Key of the driver's status that names the active window."""
_LONG_FACTS: Final = ("missing", "missing_px")
"""Keys of each dot that is not seen; the report has them in words."""

_PACKAGES: Final = (
    *("backports.zstd", "click", "evdev-binary", "hidapi", "libusb1", "lz4", "numba", "numpy"),
    *("opencv-contrib-python-headless", "pydantic", "pyusb", "ruamel.yaml", "websockets"),
)
_MAC: Final = re.compile(r"\b(?:[0-9A-Fa-f]{2}[:-]){5}[0-9A-Fa-f]{2}\b")
_ADDRESS: Final = re.compile(r"\b(?!127\.0\.0\.1\b)(?:\d{1,3}\.){3}\d{1,3}\b")
_SERIAL: Final = re.compile(r"(?<=davis:)[0-9A-Za-z._-]+")
_RECORDING: Final = re.compile(r"[^\s'\"]*\.(?:aedat4|avi|mkv|mp4)\b", re.IGNORECASE)
_FAULT: Final = re.compile(r"(?m)((?:error|warning)\[NT\d+\]).*$")
_EXCERPT: Final = re.compile(r"(?m)\n *\d* +\| .*$")
"""A profile's errors quote its lines; the code and the place are enough for a bug report."""

_INPUTS: Final = Path("/proc/bus/input/devices")
_INPUT_NAME: Final = re.compile(r'(?m)^N: Name="(.+)"$')
_LOCAL: Final = {"localhost", "neurotouch", "root"}
"""Names that belong to no person."""

Rule = tuple[re.Pattern[str], str]


def gather(findings: Iterable[Finding]) -> dict[str, Any]:
    """Returns the report, ready for JSON and for publication.

    Args:
        findings: the doctor's findings.
    """
    running = find_driver()
    cameras = find_cameras()
    pads = find_pads()
    report: dict[str, Any] = {
        "program": {"neurotouch": __version__, "at": str(Path(__file__).parents[1])},
        "system": _describe_system(),
        "environment": {name: os.environ[name] for name in VARIABLES if name in os.environ},
        "cameras": [asdict(info) for info in cameras],
        "pads": [_describe_pad(pad.ours, asdict(pad)) for pad in pads],
        "driver": None if running is None else _strip(running),
        "doctor": [finding.as_json() for finding in findings],
    }
    said = "" if running is None else running["source"]
    serials = {info.serial for info in cameras} | set(_SERIAL.findall(said))
    ours = {pad.name for pad in pads if pad.ours}
    names = {
        "PROFILE": _find_profiles("" if running is None else running["profile"]),
        "RECORDING": _find_recording(said),
        "DEVICE": sorted(({pad.name for pad in pads} | _find_inputs()) - ours - {""}),
    }
    clean = make_cleaner([*_list_names(names), *list_rules(serials)])
    # Some versions look like network addresses; they are public.
    packages = {name: _find_version(name) for name in _PACKAGES}
    return {"packages": packages, **clean(report), "left_out": list(LEFT_OUT)}


def _list_names(names: Mapping[str, Iterable[str]]) -> list[Rule]:
    """Returns what replaces names that say something about a person, ``PROFILE 1``.

    Args:
        names: the names to replace, by the word that replaces them.
    """
    numbered = [
        (name, f"{word} {number}") for word, all_ in names.items() for number, name in _count(all_)
    ]
    numbered.sort(key=lambda each: -len(each[0]))  # a longer one before the name in it
    lines = [(_FAULT, r"\1"), (_EXCERPT, "")]
    return [*lines, *(_match_whole(*each) for each in numbered), (_RECORDING, "RECORDING")]


def _count(names: Iterable[str]) -> Iterable[tuple[int, str]]:
    return enumerate(dict.fromkeys(names), 1)


def _find_profiles(active: str) -> list[str]:
    """Returns the names of profiles that did not come with the program, the active one first."""
    shipped = {path.stem for path in find_shipped_folder().glob("*.yaml")}
    names = [active]
    with suppress(NeuroTouchError):  # the doctor's findings say so
        names += list_profiles()
    with suppress(NeuroTouchError):
        names += load_user().slots
    return [name for name in names if name and name not in shipped]


def _find_recording(source: str) -> list[str]:
    """Returns the recording that a driver plays, as it names it; none for another source."""
    if find_source_kind(source) is not SourceKind.RECORDING:
        return []
    path = source.removeprefix(f"{SourceKind.RECORDING}:")
    return [path, Path(path).name, Path(path).stem]


def _find_inputs() -> set[str]:
    """Returns what the input devices of this machine call themselves."""
    with suppress(OSError):
        return set(_INPUT_NAME.findall(_INPUTS.read_text(errors="replace")))
    return set()


def _match_whole(text: str, instead: str) -> Rule:
    """Returns the rule that replaces a text, but not a part of a longer word."""
    return re.compile(rf"(?<![A-Za-z0-9]){re.escape(text)}(?![A-Za-z0-9])"), instead


def list_rules(serials: Iterable[str] = ()) -> list[Rule]:
    """Returns the private texts to remove, and their replacements.

    Args:
        serials: serial numbers of cameras.
    """
    names, real, homes = _find_person()
    host = socket.gethostname()
    secrets = [
        *((path, "~") for path in homes if len(path) > 1),
        *((name, "USER") for name in names if name not in _LOCAL),
        *((name, "NAME") for name in real if name not in _LOCAL),
        *((name, "HOST") for name in {host, host.split(".")[0]} if name not in _LOCAL),
        *((serial, "SERIAL") for serial in serials if serial),
    ]
    secrets.sort(key=lambda secret: -len(secret[0]))  # a path before the name in it
    exact = [_match_whole(*secret) for secret in secrets]
    return [*exact, (_MAC, "ADDRESS"), (_ADDRESS, "ADDRESS"), (_SERIAL, "SERIAL")]


def _find_person() -> tuple[set[str], set[str], set[str]]:
    """Returns the person's user names, real names and home folders."""
    variables = ("USER", "LOGNAME", "SUDO_USER")
    names = {os.environ[name] for name in variables if os.environ.get(name)}
    real, homes = set(), {os.environ.get("HOME", "")}
    with suppress(KeyError):  # a container may not know its own user
        account = pwd.getpwuid(os.getuid())
        names.add(account.pw_name)
        homes.add(account.pw_dir)
        real = {account.pw_gecos.split(",")[0]} - {""}
    return names, real, homes


def make_cleaner(rules: Iterable[Rule]) -> Callable[[Any], Any]:
    """Returns a function that applies the rules to every text in a value, keys included."""
    rules = tuple(rules)

    def clean(value: Any) -> Any:
        match value:
            case str():
                for pattern, instead in rules:
                    value = pattern.sub(instead, value)
                return value
            case dict():
                return {clean(key): clean(each) for key, each in value.items()}
            case list() | tuple():
                return [clean(each) for each in value]
            case _:
                return value

    return clean


def format_report(report: dict[str, Any]) -> str:
    """Returns the report for people: a heading for each part, a fact on each line."""
    lines = []
    for part, content in report.items():
        lines.append(f"{part.replace('_', ' ')}:")
        lines += [f"  {line}" for line in _list_lines(content)] or ["  none"]
    return "\n".join([*lines, ""])


def _list_lines(content: Any) -> list[str]:
    match content:
        case None:
            return []
        case {"check": check, "status": status, "sentence": sentence}:
            return [f"{status} {check}: {sentence}"]
        case dict():
            return [line for key, each in content.items() for line in _label(str(key), each)]
        case list():
            return [line for each in content for line in _list_lines(each)]
        case _:
            return [str(content)]


def _label(key: str, value: Any) -> list[str]:
    if isinstance(value, dict | list):
        inner = _list_lines(value)
        return [f"{key}:", *(f"  {line}" for line in inner)] if inner else []
    return [f"{key}: {value}"]


def _describe_system() -> dict[str, Any]:
    system = platform.freedesktop_os_release() if Path("/etc/os-release").exists() else {}
    memory_gb = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    return {
        "os": system.get("PRETTY_NAME", platform.system()),
        "kernel": platform.release(),
        "machine": platform.machine(),
        "python": platform.python_version(),
        "libc": " ".join(platform.libc_ver()),
        "processor": _find_processor(),
        "processors": len(os.sched_getaffinity(0)),
        "memory_gb": round(memory_gb, 1),
        "over_ssh": "SSH_CONNECTION" in os.environ,
        "root": os.geteuid() == 0,
    }


def _find_processor() -> str:
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return "unknown"


def _find_version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "missing"


def _describe_pad(ours: bool, pad: dict[str, Any]) -> dict[str, Any]:
    """Describes a pad.

    The physical path of a foreign pad can be a Bluetooth address, so it is left out.
    """
    return pad if ours else {**pad, "place": "left out"}


def _strip(status: Status) -> dict[str, Any]:
    gel = {key: value for key, value in status["gel"].items() if key not in _LONG_FACTS}
    kept = {key: value for key, value in status.items() if key not in _PRIVATE_FACTS}
    return kept | {"gel": gel}
