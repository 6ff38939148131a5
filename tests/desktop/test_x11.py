"""A real X server with a window manager's properties and two programs' windows."""

import os
import shutil
import subprocess

import pytest

from neurotouch_hid.desktop import Follower, open_window
from neurotouch_hid.errors import DesktopError
from tests.waiting import wait_until

xcffib = pytest.importorskip("xcffib")
xproto = pytest.importorskip("xcffib.xproto")

LIMIT_S = 60.0


class Desktop:
    """Does what a window manager and its programs do."""

    def __init__(self, display: str) -> None:
        self.display = display
        self.server = xcffib.connect(display=display)
        self.screen = self.server.get_setup().roots[0]

    def open(self, instance: str, kind: str) -> int:
        window = self.server.generate_id()
        core = self.server.core
        core.CreateWindow(
            0, window, self.screen.root, 0, 0, 9, 9, 0, xproto.WindowClass.CopyFromParent, 0, 0, []
        )
        names = f"{instance}\0{kind}\0"
        self._set(window, xproto.Atom.WM_CLASS, xproto.Atom.STRING, 8, len(names), names)
        return window

    def activate(self, window: int) -> None:
        name = "_NET_ACTIVE_WINDOW"
        atom = self.server.core.InternAtom(False, len(name), name).reply().atom
        self._set(self.screen.root, atom, xproto.Atom.WINDOW, 32, 1, [window])

    def destroy(self, window: int) -> None:
        self.server.core.DestroyWindow(window)
        self.server.flush()
        self.server.core.GetInputFocus().reply()

    def _set(self, window, name, kind, width, count, value) -> None:
        self.server.core.ChangeProperty(
            xproto.PropMode.Replace, window, name, kind, width, count, value
        )
        self.server.core.GetInputFocus().reply()  # an answer: the server has done it


@pytest.fixture(scope="module")
def display():
    """The name of a fresh X server."""
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is not installed (Debian: apt install xvfb)")
    read, write = os.pipe()
    # Without -noreset the server begins anew when its last client goes, and drops the next one.
    options = ["-displayfd", str(write), "-screen", "0", "64x64x24", "-nolisten", "tcp", "-noreset"]
    with subprocess.Popen(
        ["Xvfb", *options],
        pass_fds=[write],
        stderr=subprocess.DEVNULL,
    ) as server:
        os.close(write)
        with os.fdopen(read) as said:
            number = said.readline().strip()
        assert number, "the X server did not start"
        yield f":{number}"
        server.terminate()


@pytest.fixture
def desktop(display):
    desktop = Desktop(display)
    yield desktop
    desktop.server.disconnect()


def test_active_window_is_named_by_instance_and_class(desktop):
    window = open_window({"DISPLAY": desktop.display})
    assert window.desktop == "X11"
    game, editor = desktop.open("stk", "SuperTuxKart"), desktop.open("ed", "Editor")
    desktop.activate(game)
    assert window.names() == ("stk", "SuperTuxKart")
    desktop.activate(editor)
    assert window.names() == ("ed", "Editor")
    desktop.activate(0)
    assert window.names() == ()
    desktop.activate(game)
    desktop.destroy(game)
    assert window.names() == ()
    window.close()


def test_under_wayland_only_x11_programs_are_seen_and_it_says_so(desktop):
    window = open_window({"DISPLAY": desktop.display, "WAYLAND_DISPLAY": "wayland-0"})
    assert "X11 programs only" in window.desktop
    window.close()


def test_server_that_is_not_there_is_an_error():
    with pytest.raises(DesktopError, match=":4242 cannot be reached"):
        open_window({"DISPLAY": ":4242"})


def test_each_application_gets_its_profile(desktop):
    wanted: list[str | None] = []
    game, editor = desktop.open("stk", "SuperTuxKart"), desktop.open("ed", "Editor")
    desktop.activate(editor)
    follower = Follower(
        {"supertuxkart": "racing"}, lambda: open_window({"DISPLAY": desktop.display}), wanted.append
    )

    def wait(n: int) -> None:
        wait_until(lambda: len(wanted) >= n)

    try:
        desktop.activate(game)
        wait(1)
        assert "SuperTuxKart is in front (X11)" in follower.describe()
        desktop.activate(editor)
        wait(2)
    finally:
        follower.close()
    assert wanted == ["racing", None]


def test_desktop_that_does_not_tell_is_described(tmp_path):
    def refuse():
        raise DesktopError("This desktop is silent.", hint="Ask another.")

    follower = Follower({"x": "racing"}, refuse, lambda name: None)
    wait_until(lambda: "silent" in follower.describe())
    follower.close()
    assert follower.describe() == "This desktop is silent. Ask another."
