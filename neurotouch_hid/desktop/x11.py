"""The active window of an X server, as window managers publish it on the root window."""

from typing import Final

from neurotouch_hid.desktop.libraries import explain_install
from neurotouch_hid.errors import DesktopError

_LONGEST_WORDS: Final = 256  # 32 bit each; class names are a few letters


class XServer:
    """Reads ``_NET_ACTIVE_WINDOW`` (EWMH) and that window's ``WM_CLASS`` (ICCCM).

    Args:
        display: the server, ``:0``.
        desktop: its name in messages.

    Raises:
        DesktopError: the server cannot be reached, or the library for it is missing.
    """

    fd: int | None = None

    def __init__(self, display: str, desktop: str) -> None:
        try:
            import xcffib  # noqa: PLC0415 - an optional extra
            import xcffib.xproto  # noqa: PLC0415
        except (ImportError, OSError):  # OSError: libxcb is missing
            raise DesktopError(
                "The library that asks X11 for the active window is missing.",
                hint=explain_install("python3-xcffib"),
            ) from None
        self.desktop = desktop
        self._xcb = xcffib
        self._wrong_window = xcffib.xproto.WindowError
        try:
            self._server = xcffib.connect(display=display)
            self._root = self._server.get_setup().roots[self._server.pref_screen].root
            self._active = self._intern("_NET_ACTIVE_WINDOW")
        except xcffib.XcffibException as error:
            raise DesktopError(f"The X server {display} cannot be reached: {error}.") from None

    def names(self) -> tuple[str, ...]:
        """Returns the instance and the class of the active window."""
        try:
            window = self._read(self._root, self._active)
            if len(window) < 4 or not any(window[:4]):
                return ()
            number = int.from_bytes(window[:4], "little")
            names = self._read(number, self._xcb.xproto.Atom.WM_CLASS)
        except self._wrong_window:
            return ()  # closed just now
        except self._xcb.XcffibException as error:
            raise DesktopError(f"The X server does not answer any more: {error}.") from None
        return tuple(name.decode("utf-8", "replace") for name in names.split(b"\0") if name)

    def close(self) -> None:
        """Ends the connection."""
        self._server.disconnect()

    def _intern(self, name: str) -> int:
        return int(self._server.core.InternAtom(False, len(name), name).reply().atom)

    def _read(self, window: int, name: int) -> bytes:
        kind = self._xcb.xproto.GetPropertyType.Any
        reply = self._server.core.GetProperty(False, window, name, kind, 0, _LONGEST_WORDS).reply()
        return bytes(reply.value.buf())
