"""The active window of KDE and GNOME under Wayland: small scripts in the desktop tell it by D-Bus.

``neurotouch setup --windows`` installs them, and only then are they used.
"""

import json
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from neurotouch_hid.desktop.libraries import explain_install
from neurotouch_hid.errors import DesktopError
from neurotouch_hid.partial_file import write_whole

if TYPE_CHECKING:
    from jeepney.io.blocking import DBusConnection
    from jeepney.low_level import Message

_PATIENCE_S: Final = 2.0
_KWIN: Final = "org.kde.KWin"
_SHELL: Final = "org.gnome.Shell"
_BUS: Final = "org.freedesktop.DBus"
GNOME_UUID: Final = "windows@neurotouch-hid"
WINDOWS_PATH: Final = "/io/github/neurotouch_hid/Windows"
WINDOWS_INTERFACE: Final = "io.github.neurotouch_hid.Windows"


class _Teller:
    """A program of the desktop that tells names by the session bus.

    Args:
        owner: the bus name of the desktop; when it goes, the connection ends.
        desktop: its name, for people.
    """

    def __init__(self, owner: str, desktop: str) -> None:
        self.desktop = desktop
        self._owner = owner
        self._unique = ""
        self._names: tuple[str, ...] = ()
        self._is_told = False
        self._bus = _connect(desktop)
        self.fd: int | None = self._bus.sock.fileno()

    def names(self) -> tuple[str, ...]:
        """Returns the names of the active window's application, as it was told last.

        Raises:
            DesktopError: the desktop or the bus is gone.
        """
        while (message := self._receive(0.0)) is not None:
            self._hear(message)
        return self._names

    def close(self) -> None:
        """Ends the connection to the bus."""
        self._bus.close()

    def _receive(self, timeout_s: float) -> "Message | None":
        try:
            return self._bus.receive(timeout=max(timeout_s, 0.0))
        except TimeoutError:
            return None
        except (OSError, ValueError) as error:
            raise DesktopError(f"The session bus is gone: {error}.") from None

    def _hear(self, message: "Message") -> None:
        from jeepney import HeaderFields, MessageType, new_method_return  # noqa: PLC0415

        fields = message.header.fields
        member = fields.get(HeaderFields.member)
        sender = fields.get(HeaderFields.sender)
        if sender == _BUS and member == "NameOwnerChanged" and message.body[0] == self._owner:
            raise DesktopError(f"The desktop {self.desktop} has ended.")
        if member == "Activated" and sender == self._unique and message.body:
            self._names = _read_names(message.body)
            self._is_told = True
        if message.header.message_type is MessageType.method_call:
            self._bus.send(new_method_return(message))

    def _follow_owner(self) -> None:
        """Finds out who owns the desktop's name, and asks to be told when that changes.

        Raises:
            DesktopError: nobody owns it.
        """
        from jeepney import MatchRule  # noqa: PLC0415

        rule = MatchRule(
            type="signal",
            sender=_BUS,
            interface=_BUS,
            member="NameOwnerChanged",
            path="/org/freedesktop/DBus",
        )
        rule.add_arg_condition(0, self._owner)
        self._ask(_BUS, "/org/freedesktop/DBus", _BUS, "AddMatch", "s", rule.serialise())
        (self._unique,) = self._ask(
            _BUS, "/org/freedesktop/DBus", _BUS, "GetNameOwner", "s", self._owner
        )

    def _ask(
        self, owner: str, path: str, interface: str, method: str, types: str = "", *values: Any
    ) -> tuple[Any, ...]:
        """Returns the answer of a method.

        Raises:
            DesktopError: there is none, or it is an error.
        """
        from jeepney import (  # noqa: PLC0415
            DBusAddress,
            HeaderFields,
            MessageType,
            new_method_call,
        )

        address = DBusAddress(path, owner, interface)
        serial = next(self._bus.outgoing_serial)
        self._bus.send(new_method_call(address, method, types or None, values), serial=serial)
        # Not jeepney's own way to wait: it drops what the desktop tells meanwhile.
        end_s = time.monotonic() + _PATIENCE_S
        while (answer := self._receive(end_s - time.monotonic())) is not None:
            if answer.header.fields.get(HeaderFields.reply_serial) == serial:
                break
            self._hear(answer)
        else:
            raise DesktopError(f"The desktop {self.desktop} does not answer.")
        if answer.header.message_type is MessageType.error:
            raise DesktopError(f"The desktop {self.desktop} refuses: {_read_error(answer.body)}.")
        return tuple(answer.body)


class KWin(_Teller):
    """KDE Plasma 5 and 6: gives KWin a script that calls us whenever another window is active.

    The script ends with the connection, so an ended driver leaves nothing in KWin.

    Args:
        script: the installed script.
        runtime: ``$XDG_RUNTIME_DIR``: the script with our address is written here meanwhile.

    Raises:
        DesktopError: KWin does not answer, or the library for D-Bus is missing.
    """

    def __init__(self, script: Path, runtime: Path) -> None:
        super().__init__(_KWIN, "KDE")
        self._copy: Path | None = None
        try:
            self._follow_owner()
            self._start(script, runtime)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Takes the script out of KWin, and ends the connection."""
        if self._copy is not None:
            with suppress(DesktopError):
                self._script("unloadScript", "s", self._plugin)
            self._copy.unlink(missing_ok=True)
        super().close()

    def _start(self, script: Path, runtime: Path) -> None:
        listener = self._bus.unique_name
        # A name for each connection: another player's driver has a script of its own.
        self._plugin = "neurotouch-hid" + listener.replace(":", "-").replace(".", "-")
        try:
            text = script.read_text(encoding="utf-8")
            copy = runtime / f"{self._plugin}.js"
            write_whole(copy, f"const LISTENER = {json.dumps(listener)};\n{text}".encode())
            self._copy = copy
        except OSError as error:
            raise DesktopError(f"The script for KWin cannot be read: {error}.") from None
        self._script("loadScript", "ss", str(self._copy), self._plugin)
        self._script("start")
        end_s = time.monotonic() + _PATIENCE_S
        while not self._is_told:
            message = self._receive(end_s - time.monotonic())
            if message is None:
                raise DesktopError("The script in KWin does not answer.")
            self._hear(message)

    def _script(self, method: str, types: str = "", *values: str) -> None:
        self._ask(_KWIN, "/Scripting", "org.kde.kwin.Scripting", method, types, *values)


class GnomeShell(_Teller):
    """GNOME 45 and later: our extension tells the active window.

    Raises:
        DesktopError: GNOME Shell does not answer, the extension is not switched on, or the library
            for D-Bus is missing.
    """

    def __init__(self) -> None:
        super().__init__(_SHELL, "GNOME")
        from jeepney import MatchRule  # noqa: PLC0415

        try:
            self._follow_owner()
            rule = MatchRule(type="signal", sender=_SHELL, interface=WINDOWS_INTERFACE)
            self._ask(_BUS, "/org/freedesktop/DBus", _BUS, "AddMatch", "s", rule.serialise())
            self._names = self._ask_names()
        except BaseException:
            self.close()
            raise

    def _ask_names(self) -> tuple[str, ...]:
        try:
            return _read_names(self._ask(_SHELL, WINDOWS_PATH, WINDOWS_INTERFACE, "GetNames"))
        except DesktopError:
            raise DesktopError(
                "GNOME does not run the extension that tells the active window.",
                hint="Log out and in again after installing it, or switch it on in 'Extensions'.",
            ) from None


def _connect(desktop: str) -> "DBusConnection":
    try:
        from jeepney.io.blocking import open_dbus_connection  # noqa: PLC0415 - an optional extra
    except ImportError:
        raise DesktopError(
            f"The library that asks {desktop} for the active window is missing.",
            hint=explain_install("python3-jeepney"),
        ) from None
    try:
        return open_dbus_connection("SESSION")
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise DesktopError(f"The session bus cannot be reached: {error}.") from None


def _read_names(body: tuple[Any, ...]) -> tuple[str, ...]:
    """Returns the names in the body of a message: texts, or a list of them."""
    texts = body[0] if body and isinstance(body[0], list) else body
    return tuple(dict.fromkeys(text for text in texts if isinstance(text, str) and text))


def _read_error(body: tuple[Any, ...]) -> str:
    return str(body[0]).rstrip(".") if body else "no reason given"


def find_kwin_script(environment: Mapping[str, str]) -> Path:
    """Returns where ``neurotouch setup --windows`` installs the script for KWin."""
    return find_data_folder(environment) / "neurotouch" / "kwin-windows.js"


def find_gnome_extension(environment: Mapping[str, str]) -> Path:
    """Returns the folder where ``neurotouch setup --windows`` installs the extension of GNOME."""
    return find_data_folder(environment) / "gnome-shell" / "extensions" / GNOME_UUID


def find_data_folder(environment: Mapping[str, str]) -> Path:
    """Returns the folder where desktops look for what a person has installed."""
    default = Path(environment.get("HOME", "/")) / ".local" / "share"
    found = Path(environment.get("XDG_DATA_HOME") or default)
    return found if found.is_absolute() else default
