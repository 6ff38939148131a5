"""The active window of COSMIC, and of compositors with the protocol of wlroots, under Wayland."""

import struct
from collections.abc import Mapping
from typing import Final

from neurotouch_hid.desktop.wayland import Message, Wayland, find_display
from neurotouch_hid.errors import DesktopError

_LIST: Final = "ext_foreign_toplevel_list_v1"
_COSMIC: Final = "zcosmic_toplevel_info_v1"
_WLROOTS: Final = "zwlr_foreign_toplevel_manager_v1"

_ACTIVATED: Final = 2  # among the states of a window, in both protocols
_NEW_WINDOW: Final = 0  # event of both lists

# Events of a window, and the request that frees it. Titles have events too, which nobody reads.
_COSMIC_VERSION: Final = 2  # the first that builds on the common list
_GET_STATES: Final = 1
_LISTED_CLOSED, _LISTED_APP_ID, _LISTED_DESTROY = 0, 3, 0
_COSMIC_STATE, _COSMIC_DESTROY = 8, 0
_WLROOTS_APP_ID, _WLROOTS_STATE, _WLROOTS_CLOSED, _WLROOTS_DESTROY = 1, 4, 6, 7


class Toplevels:
    """Hears of all windows from the compositor, and which of them is active.

    Args:
        environment: names the compositor's socket.

    Attributes:
        fd: becomes readable when a window changes.

    Raises:
        DesktopError: the compositor cannot be reached, or has none of these protocols.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._app_ids: dict[int, str] = {}
        self._active: dict[int, bool] = {}
        self._cosmic: int | None = None
        self._window_of: dict[int, int] = {}  # of COSMIC's object with the states of a window
        self._wayland = Wayland(find_display(environment))
        self.fd: int | None = self._wayland.peer.fileno()
        try:
            self._begin()
        except BaseException:
            self._wayland.close()
            raise

    def names(self) -> tuple[str, ...]:
        """Returns the application id of the active window."""
        for message in self._wayland.take():
            self._hear(message)
        found = [self._app_ids.get(window, "") for window, on in self._active.items() if on]
        return tuple(name for name in found[:1] if name)

    def close(self) -> None:
        """Ends the connection."""
        self._wayland.close()

    def _begin(self) -> None:
        registry, found = self._wayland.list_globals()
        if _LIST in found and found.get(_COSMIC, (0, 0))[1] >= _COSMIC_VERSION:
            self.desktop = "COSMIC"
            name, _ = found[_COSMIC]
            self._cosmic = self._wayland.bind(registry, _COSMIC, name, _COSMIC_VERSION)
            self._list = self._wayland.bind(registry, _LIST, found[_LIST][0], 1)
        elif _WLROOTS in found:
            self.desktop = "Wayland"
            self._list = self._wayland.bind(registry, _WLROOTS, found[_WLROOTS][0], 1)
        else:
            raise DesktopError("The Wayland compositor does not tell which window is active.")
        # The windows come first, and what was asked about them comes second.
        self._wayland.round_trip(self._hear)
        self._wayland.round_trip(self._hear)

    def _hear(self, message: Message) -> None:
        if message.sender == self._list:
            if message.opcode == _NEW_WINDOW:
                self._add(message.take_word())
        elif message.sender in self._window_of:
            if message.opcode == _COSMIC_STATE:
                self._active[self._window_of[message.sender]] = _is_active(message.take_array())
        elif message.sender in self._active:
            self._hear_window(message)

    def _add(self, window: int) -> None:
        self._active[window] = False
        if self._cosmic is not None:
            states = self._wayland.new()
            self._window_of[states] = window
            self._wayland.send(self._cosmic, _GET_STATES, states, window)

    def _hear_window(self, message: Message) -> None:
        window, is_cosmic = message.sender, self._cosmic is not None
        if message.opcode == (_LISTED_APP_ID if is_cosmic else _WLROOTS_APP_ID):
            self._app_ids[window] = message.take_text()
        elif message.opcode == (_LISTED_CLOSED if is_cosmic else _WLROOTS_CLOSED):
            del self._active[window]
            self._app_ids.pop(window, None)
            for states in [key for key, value in self._window_of.items() if value == window]:
                del self._window_of[states]
                self._wayland.send(states, _COSMIC_DESTROY)
            self._wayland.send(window, _LISTED_DESTROY if is_cosmic else _WLROOTS_DESTROY)
        elif not is_cosmic and message.opcode == _WLROOTS_STATE:
            self._active[window] = _is_active(message.take_array())


def _is_active(states: bytes) -> bool:
    return _ACTIVATED in (
        state for (state,) in struct.iter_unpack("=I", states[: len(states) & ~3])
    )
