"""niri's stream of events, as its documents show it."""

import json
import socket
import threading
from contextlib import suppress
from pathlib import Path

import pytest

from neurotouch_hid.desktop import open_window
from neurotouch_hid.errors import DesktopError
from tests.waiting import wait_until


class Niri:
    """Speaks at a socket as niri does."""

    def __init__(self, path: Path, first: list[bytes]) -> None:
        self.first, self.path = first, path
        self.asked = b""
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(str(path))
        self.listener.listen()
        self.has_peer = threading.Event()
        self.thread = threading.Thread(target=self._serve)
        self.thread.start()

    def _serve(self) -> None:
        self.peer, _ = self.listener.accept()
        self.asked = self.peer.recv(4096)
        with suppress(OSError):  # the driver has left before the end
            for line in self.first:
                self.peer.sendall(line)
        self.has_peer.set()

    def tell(self, **event) -> None:
        self.peer.sendall(json.dumps(event).encode() + b"\n")

    def close(self) -> None:
        self.thread.join()
        self.peer.close()
        self.listener.close()
        self.path.unlink()


def window(number: int, app_id: str | None, is_focused: bool = False) -> dict:
    return {
        "id": number,
        "title": "a title",
        "app_id": app_id,
        "pid": 7,
        "workspace_id": 1,
        "is_focused": is_focused,
        "is_floating": False,
        "is_urgent": False,
    }


def begin(*windows: dict) -> list[bytes]:
    told = [
        {"Ok": "Handled"},
        {"WorkspacesChanged": {"workspaces": [{"id": 1, "idx": 1, "is_focused": True}]}},
        {"WindowsChanged": {"windows": list(windows)}},
        {"KeyboardLayoutsChanged": {"keyboard_layouts": {"names": ["us"], "current_idx": 0}}},
        {"OverviewOpenedOrClosed": {"is_open": False}},
    ]
    return [json.dumps(each).encode() + b"\n" for each in told]


def test_focused_window_is_told(tmp_path):
    niri = Niri(
        tmp_path / "niri.wayland-1.7.sock",
        begin(window(3, "game", is_focused=True), window(4, "editor")),
    )
    active = open_window({"NIRI_SOCKET": str(niri.path), "WAYLAND_DISPLAY": "wayland-1"})
    assert active.names() == ("game",)
    assert niri.asked == b'"EventStream"\n'
    for event, names in [
        ({"WindowFocusChanged": {"id": 4}}, ("editor",)),
        ({"WindowFocusChanged": {"id": None}}, ()),
        ({"WindowOpenedOrChanged": {"window": window(5, "new", is_focused=True)}}, ("new",)),
        ({"WindowOpenedOrChanged": {"window": window(5, "newer", is_focused=True)}}, ("newer",)),
        ({"WindowClosed": {"id": 5}}, ()),
        ({"WindowFocusChanged": {"id": 3}}, ("game",)),
        ({"SomethingOfALaterVersion": {"id": 3}}, ("game",)),
        ({"WindowsChanged": {"windows": [window(8, None, is_focused=True)]}}, ()),
    ]:
        niri.tell(**event)
        wait_until(lambda names=names: active.names() == names)
    active.close()
    niri.close()


def test_niri_that_was_started_again_has_another_socket(tmp_path):
    old = tmp_path / "niri.wayland-1.7.sock"
    environment = {"NIRI_SOCKET": str(old)}
    niri = Niri(old, begin())
    active = open_window(environment)
    assert active.names() == ()
    niri.close()
    with pytest.raises(DesktopError, match="closed"):
        active.names()
    active.close()
    with pytest.raises(DesktopError, match="niri cannot be reached"):
        open_window(environment)
    niri = Niri(tmp_path / "niri.wayland-1.8.sock", begin(window(1, "game", is_focused=True)))
    active = open_window(environment)
    assert active.names() == ("game",)
    active.close()
    niri.close()


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"hello\n",
        b"[" * 100_000 + b"\n",
        b'{"Err": "no such request"}\n',
    ],
)
def test_nonsense_from_niri_is_an_error(tmp_path, answer):
    niri = Niri(tmp_path / "niri.sock", [answer])
    active = open_window({"NIRI_SOCKET": str(niri.path)})
    assert niri.has_peer.wait(60)
    niri.peer.shutdown(socket.SHUT_WR)
    with pytest.raises(DesktopError, match="niri"):
        active.names()
    active.close()
    niri.close()


@pytest.mark.parametrize(
    "windows", [7, None, ["x"], [{"id": "a"}], [{"id": 1, "app_id": 7, "is_focused": True}]]
)
def test_windows_of_another_kind_are_none(tmp_path, windows):
    line = json.dumps({"WindowsChanged": {"windows": windows}}).encode() + b"\n"
    niri = Niri(tmp_path / "niri.sock", [line, b'{"WindowClosed": {"id": [1]}}\n', b"7\n"])
    active = open_window({"NIRI_SOCKET": str(niri.path)})
    assert active.names() == ()
    active.close()
    niri.close()
