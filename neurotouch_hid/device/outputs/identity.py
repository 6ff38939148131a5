"""Identities: the controller models that a pad can emulate, and checks against misreading."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, Final, Literal

from evdev import ecodes

from neurotouch_hid.device.outputs.gamepad import ControlLayout
from neurotouch_hid.device.outputs.spec import DeviceSpec
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.files.faults import SHOWN_COLUMNS
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.printable import make_printable

PadKind = Literal["uinput", "hid"]

USUAL: Final[dict[str, str]] = {"uinput": "xbox360", "hid": "own"}
"""The default identity of each kind of pad."""

PLACE: Final = "neurotouch/pad"
"""Physical path of pads, before a number; udev rules and this program find our own pads by it."""

_KEYS: Final = {"name", "vendor", "product", "version", "layout"}
_NAME_BYTES: Final[dict[str, int]] = {"uinput": 79, "hid": 127}
"""Bytes of a name that the kernel keeps, without the closing zero (linux/uinput.h, uhid.h)."""

# SDL (since 2025) takes nodes with such names for parts of something else, not for pads.
_NO_BEGIN: Final = ("uinput-", "Mouse ", "gpio_ir_recv")
_NO_PART: Final = (
    " Keyboard",
    "Trackpad",
    "Clickpad",
    "Synaptics ",
    " Laptop ",
    " LED ",
    " Thelio ",
)
_NO_END: Final = (
    *(
        " Motion Sensors",
        " IMU",
        " Touchpad",
        " Accelerometer",
        " IR",
        " Motion Plus",
    ),
    *(" Nunchuk", " Pen", " Finger", " System Control"),
)

_DRIVEN_BY_SDL: Final = {0x045E: "Microsoft", 0x054C: "Sony", 0x057E: "Nintendo"}
"""Vendors whose pads SDL reads through hidraw, in the format of the real ones."""


@dataclass(frozen=True, slots=True)
class Identity:
    """The controller model that a pad emulates.

    Attributes:
        name: what programs show.
        vendor: USB vendor id.
        product: USB product id.
        version: of the device; mapping databases tell layouts apart by it.
        layout: the controls and their codes.
    """

    name: str
    vendor: int
    product: int
    version: int
    layout: ControlLayout

    def make_spec(self, player: int = 1, *, rumbles: bool = False) -> DeviceSpec:
        """Returns the description of the pad of a player (1, 2, ...) for the kernel."""
        return DeviceSpec(
            self.name,
            (ecodes.BUS_USB, self.vendor, self.product, self.version),
            f"{PLACE}{player - 1}",
            self.layout.controls,
            rumbles=rumbles,
        )


@cache
def load_identities() -> Mapping[str, Identity]:
    """Returns the identities that come with the program, by name."""
    said = _read_shipped()
    return {name: _make(table) for name, table in said["identities"].items()}


def choose_identity(wanted: str | None, kind: PadKind) -> Identity:
    """Returns the identity of this name or in this file, if programs read it correctly.

    Args:
        wanted: a shipped name, or the path of a TOML file; None for the usual one.
        kind: ``uinput`` or ``hid``.

    Raises:
        DeviceError: there is no such identity, or some program would misread it.
    """
    shipped = load_identities()
    wanted = wanted or USUAL[kind]
    if wanted in shipped:
        identity = shipped[wanted]
    elif wanted.endswith(".toml"):
        identity = _read_file(Path(wanted))
    else:
        raise DeviceError(
            f"There is no identity called {wanted!r}.",
            hint=f"Use one of {', '.join(shipped)}, or the path of a .toml file of your own.",
        )
    check_identity(identity, kind)
    return identity


def check_identity(identity: Identity, kind: PadKind) -> None:
    """Refuses identities that programs are known to misread.

    Raises:
        DeviceError: names the program and its mistake.
    """
    _check_name(identity.name, kind)
    ids = f"{identity.vendor:04x}:{identity.product:04x}"
    match (identity.vendor, identity.product, identity.version):
        case (0, _, _) | (_, 0, _):
            reason = "SDL puts the name in the place of ids that are 0, and Godot sees no pad"
        case (0x28DE, 0x11FF, _):
            reason = "SDL takes it for Steam's own virtual pad, which it hides"
        case (0x045E, 0x028E, 0x0001):
            reason = "SDL knows version 0x0001 with an inverted D-pad and without a guide button"
        case (0x045E, 0x028E, 0x0210):
            reason = "SDL knows version 0x0210 as another maker's pad, with other buttons"
        case (vendor, _, _) if kind == "hid" and vendor in _DRIVEN_BY_SDL:
            maker = _DRIVEN_BY_SDL[vendor]
            reason = f"SDL reads pads of {maker} through hidraw and would misread our reports"
        case (0x1209, product, _) if 0x0001 <= product <= 0x0010:
            reason = (
                "pid.codes keeps these ids for private tests; other people's tests use them too"
            )
        case _:
            return
    raise DeviceError(
        f"A pad cannot be {ids}, version {identity.version:#06x}: {reason}.",
        hint="With the device hid use the identity 'own'." if kind == "hid" else "Use other ids.",
    )


def _check_name(name: str, kind: PadKind) -> None:
    if not name or not name.isprintable() or len(name.encode()) > _NAME_BYTES[kind]:
        raise DeviceError(
            f"'{make_printable(name[:SHOWN_COLUMNS])}' is not a valid name for a pad.",
            hint=f"Use 1 to {_NAME_BYTES[kind]} bytes of printable characters.",
        )
    for what, reads in (
        *((f"begins with {word!r}", name.startswith(word)) for word in _NO_BEGIN),
        *((f"contains {word!r}", word in name) for word in _NO_PART),
        *((f"ends with {word!r}", name.endswith(word)) for word in _NO_END),
    ):
        if reads:
            raise DeviceError(
                f"SDL would ignore a pad called {name!r}, because the name {what}.",
                hint="Choose another name.",
            )


def _read_shipped() -> dict[str, Any]:
    text = (
        resources.files("neurotouch_hid.device.outputs")
        .joinpath("identities.toml")
        .read_text("utf-8")
    )
    return tomllib.loads(text)


def _read_file(path: Path) -> Identity:
    try:
        table = tomllib.loads(read_text(path, MAX_SETTINGS_BYTES))
    except OSError as error:
        raise DeviceError(f"'{path}' cannot be read: {error.strerror}.") from None
    except RecursionError:
        raise DeviceError(f"'{path}' has too many brackets in one another.") from None
    except ValueError as error:  # a mistake in the TOML, or a number of thousands of digits
        raise DeviceError(f"'{path}' is not valid TOML: {error}.") from None
    for key in ("name", "layout"):
        if not isinstance(table.get(key), str):
            raise DeviceError(f"{path}: {key!r} must be set, to text.")
    for key in ("vendor", "product", "version"):
        value = table.get(key)
        if type(value) is not int or not 0 <= value <= 0xFFFF:
            raise DeviceError(f"{path}: {key!r} must be set, to a number up to 0xffff.")
    if unknown := table.keys() - _KEYS:
        raise DeviceError(f"{path}: unknown key {min(unknown)!r}.")
    layouts = _read_shipped()["layouts"]
    if table["layout"] not in layouts:
        raise DeviceError(f"{path}: 'layout' must be one of {', '.join(layouts)}.")
    return _make(table)


def _make(table: Mapping[str, Any]) -> Identity:
    layout = ControlLayout.parse(_read_shipped()["layouts"][table["layout"]])
    return Identity(table["name"], table["vendor"], table["product"], table["version"], layout)
