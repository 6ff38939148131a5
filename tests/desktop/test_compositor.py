"""Compositors that tell the active window, as their sockets speak."""

import json
import socket
import struct
import threading
from pathlib import Path

import pytest

from neurotouch_hid.desktop import open_window
from neurotouch_hid.errors import DesktopError


class Compositor:
    """Listens at a path and gives the same answer to each question."""

    def __init__(self, path: Path, answer: bytes) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.asked: list[bytes] = []
        self._answer = answer
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(path))
        self._listener.listen()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self) -> None:
        while True:
            try:
                client, _ = self._listener.accept()
            except OSError:
                return
            with client:
                self.asked.append(client.recv(4096))
                client.sendall(self._answer)

    def close(self) -> None:
        self._listener.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._listener.close()


@pytest.fixture
def listen(tmp_path):
    opened = []

    def start(path, answer):
        opened.append(Compositor(tmp_path / path, answer))
        return opened[-1]

    yield start
    for compositor in opened:
        compositor.close()


def frame(payload: bytes, magic: bytes = b"i3-ipc", length: int | None = None) -> bytes:
    n_bytes = len(payload) if length is None else length
    return struct.pack("=6sII", magic, n_bytes, 4) + payload


def tree(**window) -> bytes:
    aside = {"focused": False, "app_id": "foot", "nodes": []}
    inner = {"focused": False, "nodes": [aside], "floating_nodes": [{"focused": True, **window}]}
    return json.dumps({"focused": False, "nodes": [inner], "floating_nodes": []}).encode()


def names(environment):
    return open_window(environment).names()


def test_sway_tells_the_focused_window(listen, tmp_path):
    sway = listen("sway", frame(tree(app_id="org.supertuxkart")))
    assert names({"SWAYSOCK": str(tmp_path / "sway")}) == ("org.supertuxkart",)
    assert sway.asked == [struct.pack("=6sII", b"i3-ipc", 0, 4)]


def test_sway_tells_the_class_of_an_x11_program(listen, tmp_path):
    properties = {"class": "SuperTuxKart", "instance": "stk"}
    listen("sway", frame(tree(app_id=None, window_properties=properties)))
    assert names({"SWAYSOCK": str(tmp_path / "sway")}) == ("SuperTuxKart", "stk")


def test_sway_without_a_window(listen, tmp_path):
    listen("sway", frame(b'{"focused": false, "nodes": []}'))
    assert names({"SWAYSOCK": str(tmp_path / "sway")}) == ()


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"hello",
        frame(b"{}", magic=b"i4-ipc"),
        frame(b"", length=1 << 31),
        frame(b"{", length=1),
        frame(b"[" * 100_000),
        frame(b"{}", length=3),
    ],
)
def test_nonsense_from_sway_is_an_error(listen, tmp_path, answer):
    listen("sway", answer)
    with pytest.raises(DesktopError, match="sway"):
        names({"SWAYSOCK": str(tmp_path / "sway")})


def test_hyprland_tells_the_active_window(listen, tmp_path):
    answer = json.dumps({"class": "steam_app_1", "initialClass": "steam", "pid": 7}).encode()
    hyprland = listen("hypr/abc/.socket.sock", answer)
    environment = {"HYPRLAND_INSTANCE_SIGNATURE": "abc", "XDG_RUNTIME_DIR": str(tmp_path)}
    assert names(environment) == ("steam_app_1", "steam")
    assert hyprland.asked == [b"j/activewindow"]


@pytest.mark.parametrize(("answer", "found"), [(b"{}", ()), (b"", ()), (b"[]", ())])
def test_hyprland_without_a_window(listen, tmp_path, answer, found):
    listen("hypr/abc/.socket.sock", answer)
    environment = {"HYPRLAND_INSTANCE_SIGNATURE": "abc", "XDG_RUNTIME_DIR": str(tmp_path)}
    assert names(environment) == found


def test_compositor_that_is_gone_is_an_error(tmp_path):
    with pytest.raises(DesktopError, match="sway cannot be reached"):
        names({"SWAYSOCK": str(tmp_path / "sway")})


@pytest.mark.parametrize("desktop", ["GNOME", "ubuntu:GNOME", "KDE"])
def test_gnome_and_kde_under_wayland_say_how_to_make_them_tell(tmp_path, desktop):
    environment = {"WAYLAND_DISPLAY": "w", "XDG_CURRENT_DESKTOP": desktop, "HOME": str(tmp_path)}
    with pytest.raises(DesktopError, match=f"{desktop} does not tell programs") as caught:
        open_window(environment)
    assert "setup --windows" in caught.value.hint


def test_other_wayland_desktop_says_that_it_does_not_tell(tmp_path):
    environment = {"WAYLAND_DISPLAY": "w", "XDG_RUNTIME_DIR": str(tmp_path)}
    with pytest.raises(DesktopError, match="This desktop does not tell programs") as caught:
        open_window(environment)
    assert "profile use" in caught.value.hint


def test_machine_without_a_desktop_says_so():
    with pytest.raises(DesktopError, match="No desktop"):
        open_window({})
