"""Compositors that list their windows: the real sway without a screen, and COSMIC's words."""

import os
import socket
import struct
import threading
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from neurotouch_hid.desktop import open_window
from neurotouch_hid.desktop.wayland import pack
from neurotouch_hid.errors import DesktopError
from tests.desktop.programs import Compositor, Program, find_without_rights, skip
from tests.waiting import wait_until

NOBODY = 65534


@pytest.fixture
def sway(tmp_path):
    """A sway of this test's own, asked by the common protocol and not at its own socket."""
    with TemporaryDirectory(prefix="sway-") as name:
        folder = Path(name)
        program = find_without_rights("sway", folder)
        if program is None:
            skip("sway is not installed (Debian: apt install sway)")
        (folder / "config").touch()
        environment = {
            **{key: os.environ[key] for key in ("PATH", "LANG") if key in os.environ},
            "HOME": name,
            "XDG_RUNTIME_DIR": name,
            "WAYLAND_DISPLAY": "wayland-1",  # the first that it takes
            "WLR_BACKENDS": "headless",
            "WLR_RENDERER": "pixman",
            "WLR_LIBINPUT_NO_DEVICES": "1",
        }
        user = None
        if os.geteuid() == 0:  # sway refuses to run as root
            user = NOBODY
            os.chown(folder, user, -1)
        command = [program, "--config", str(folder / "config")]
        compositor = Compositor(command, environment, tmp_path / "sway.log", user)
        yield compositor
        compositor.end()


def test_active_window_of_sway_also_after_a_restart(sway):
    for _ in range(2):
        window = open_window(sway.environment)
        assert window.desktop == "Wayland"
        assert window.names() == ()
        game = Program(sway.environment, "org.example.game")
        wait_until(lambda: window.names() == ("org.example.game",))  # noqa: B023
        editor = Program(sway.environment, "org.example.editor")
        wait_until(lambda: window.names() == ("org.example.editor",))  # noqa: B023
        again = open_window(sway.environment)
        assert again.names() == ("org.example.editor",)
        again.close()
        editor.close()
        wait_until(lambda: window.names() == ("org.example.game",))  # noqa: B023
        game.close()
        wait_until(lambda: window.names() == ())  # noqa: B023
        sway.end()
        wait_until(lambda: is_gone(window))  # noqa: B023
        window.close()
        sway.start()


def is_gone(window) -> bool:
    """Returns whether the compositor of a window that has been opened has ended."""
    try:
        window.names()
    except DesktopError:
        return True
    return False


class Cosmic:
    """Speaks COSMIC's protocols as their descriptions say, at a socket.

    Args:
        path: the socket.
        cosmic_version: of the protocol with the states.
    """

    LIST, COSMIC, OUTPUT = 7, 8, 9
    FIRST_WINDOW = 0xFF000000

    def __init__(self, path: Path, cosmic_version: int = 3) -> None:
        self.cosmic_version = cosmic_version
        self.objects: dict[str, int] = {}
        self.states_of: dict[int, int] = {}
        self.destroyed: list[int] = []
        self.active = self.FIRST_WINDOW
        self.windows = {self.FIRST_WINDOW: "org.example.game", self.FIRST_WINDOW + 1: "editor"}
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(str(path))
        self.listener.listen()
        self.peer: socket.socket | None = None
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def close(self) -> None:
        for each in filter(None, (self.peer, self.listener)):
            each.shutdown(socket.SHUT_RDWR)
            each.close()
        self.thread.join()

    def activate(self, window: int) -> None:
        """Makes another window the active one, in one piece."""
        self.active = window
        self.send(b"".join(self.tell_states(each) for each in self.states_of))

    def end(self, window: int) -> None:
        self.send(pack(window, 0))

    def send(self, data: bytes) -> None:
        assert self.peer is not None
        self.peer.sendall(data)

    def tell_states(self, window: int) -> bytes:
        states = struct.pack("=2I", 0, 2) if window == self.active else struct.pack("=I", 0)
        header = struct.pack("=IHH", self.states_of[window], 8, 12 + len(states))
        output = pack(self.states_of[window], 4, self.OUTPUT)
        return output + header + struct.pack("=I", len(states)) + states

    def _serve(self) -> None:
        try:
            self.peer, _ = self.listener.accept()
        except OSError:
            return
        received = b""
        while True:
            try:
                piece = self.peer.recv(65536)
            except OSError:
                return
            if not piece:
                return
            received += piece
            while len(received) >= 8:
                number, opcode, length = struct.unpack_from("=IHH", received)
                if len(received) < length:
                    break
                self._answer(number, opcode, received[8:length])
                received = received[length:]

    def _answer(self, number: int, opcode: int, body: bytes) -> None:
        words = struct.unpack(f"={len(body) // 4}I", body)
        if (number, opcode) == (1, 0):
            self.send(pack(words[0], 0, 0) + pack(1, 1, words[0]))
        elif (number, opcode) == (1, 1):
            self.objects["registry"] = words[0]
            for name, interface, version in (
                (1, "wl_compositor", 6),
                (self.LIST, "ext_foreign_toplevel_list_v1", 1),
                (self.COSMIC, "zcosmic_toplevel_info_v1", self.cosmic_version),
            ):
                self.send(pack(words[0], 0, name, interface, version))
        elif (number, opcode) == (self.objects.get("registry"), 0):
            if words[0] == self.LIST:
                self.objects["list"] = words[-1]
                for window, app_id in self.windows.items():
                    self.send(pack(words[-1], 0, window))
                    self.send(pack(window, 2, "a title") + pack(window, 3, app_id))
                    self.send(pack(window, 4, "an identifier") + pack(window, 1))
            else:
                assert words[-2] == 2, "the version that the program understands"
                self.objects["cosmic"] = words[-1]
        elif (number, opcode) == (self.objects.get("cosmic"), 1):
            self.states_of[words[1]] = words[0]
            self.send(self.tell_states(words[1]) + pack(self.objects["cosmic"], 2))
        elif opcode == 0:
            self.destroyed.append(number)


@pytest.fixture
def environment(tmp_path):
    return {"WAYLAND_DISPLAY": "wayland-1", "XDG_RUNTIME_DIR": str(tmp_path)}


@pytest.fixture
def cosmic(tmp_path):
    compositor = Cosmic(tmp_path / "wayland-1")
    yield compositor
    compositor.close()


def test_active_window_of_cosmic(cosmic, environment):
    _, second = cosmic.windows
    window = open_window(environment)
    assert window.desktop == "COSMIC"
    assert window.names() == ("org.example.game",)
    cosmic.activate(second)
    wait_until(lambda: window.names() == ("editor",))
    cosmic.end(second)
    wait_until(lambda: window.names() == ())
    wait_until(lambda: sorted(cosmic.destroyed) == sorted([second, cosmic.states_of[second]]))
    window.close()


def test_older_cosmic_is_not_spoken_to(tmp_path, environment):
    compositor = Cosmic(tmp_path / "wayland-1", cosmic_version=1)
    with pytest.raises(DesktopError, match="does not tell"):
        open_window(environment)
    compositor.close()


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"\0" * 8,
        pack(1, 0, 3, 1, "no such object"),
        pack(2, 0, 1, "wl_compositor"),
        struct.pack("=IHHII", 2, 0, 16, 1, 1 << 31),
    ],
)
def test_nonsense_from_a_compositor_is_an_error(tmp_path, environment, answer):
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(str(tmp_path / "wayland-1"))
    listener.listen()

    def answer_once() -> None:
        peer, _ = listener.accept()
        with peer:
            peer.recv(4096)
            peer.sendall(answer)

    thread = threading.Thread(target=answer_once)
    thread.start()
    with pytest.raises(DesktopError, match="does not tell"):
        open_window(environment)
    thread.join()
    listener.close()
