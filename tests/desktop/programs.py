"""Programs with a window, and compositors without a screen, for the tests of desktops."""

import mmap
import os
import shutil
import signal
import socket
import struct
import subprocess
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

import pytest

from neurotouch_hid.desktop.wayland import Message, Wayland, find_display, pack
from neurotouch_hid.errors import DesktopError
from tests.waiting import wait_until

LIMIT_S = 60.0
SIDE = 64
ACTIVATED = 4  # among the states of xdg_toplevel


class Program:
    """A Wayland program with one window, which answers the compositor in a thread.

    Args:
        environment: names the compositor.
        app_id: what the window says of its program.

    Attributes:
        active_s: when the compositor has told it that its window is active; None: not yet.
    """

    def __init__(self, environment: Mapping[str, str], app_id: str) -> None:
        self.wayland = Wayland(find_display(environment))
        registry, found = self.wayland.list_globals()
        compositor, shm, self.shell = (
            self.wayland.bind(registry, name, found[name][0], 1)
            for name in ("wl_compositor", "wl_shm", "xdg_wm_base")
        )
        self.active_s: float | None = None
        self.surface, pool, self.buffer, self.xdg, self.toplevel = (
            self.wayland.new() for _ in range(5)
        )
        send = self.wayland.send
        send(compositor, 0, self.surface)
        n_bytes = 4 * SIDE * SIDE
        memory = os.memfd_create("window")
        os.truncate(memory, n_bytes)
        with mmap.mmap(memory, n_bytes) as pixels:
            pixels[:] = b"\xff" * n_bytes
        # A request with a descriptor goes by itself.
        self.wayland.peer.sendmsg(
            [pack(shm, 0, pool, n_bytes)],
            [(socket.SOL_SOCKET, socket.SCM_RIGHTS, struct.pack("i", memory))],
        )
        os.close(memory)
        send(pool, 0, self.buffer, 0, SIDE, SIDE, 4 * SIDE, 1)
        send(self.shell, 2, self.xdg, self.surface)
        send(self.xdg, 1, self.toplevel)
        send(self.toplevel, 2, "a title that nobody may keep")
        send(self.toplevel, 3, app_id)
        send(self.surface, 6)
        self.done = threading.Event()
        self.thread = threading.Thread(target=self._answer, daemon=True)
        self.thread.start()

    def close(self) -> None:
        """Ends as a program ends: its window goes."""
        self.done.set()
        self.thread.join()
        self.wayland.close()

    def _answer(self) -> None:
        while not self.done.is_set():
            try:
                for message in self.wayland.take(0.05):
                    self._hear(message)
            except DesktopError:
                return

    def _hear(self, message: Message) -> None:
        send = self.wayland.send
        if message.sender == self.xdg:
            send(self.xdg, 4, message.take_word())
            send(self.surface, 1, self.buffer, 0, 0)
            send(self.surface, 2, 0, 0, SIDE, SIDE)
            send(self.surface, 6)
        elif message.sender == self.toplevel and message.opcode == 0 and self.active_s is None:
            states = message.take_array(8)
            if ACTIVATED in struct.unpack(f"={len(states) // 4}I", states):
                self.active_s = time.monotonic()
        elif message.sender == self.shell:
            send(self.shell, 3, message.take_word())


@contextmanager
def session_bus() -> Iterator[str]:
    """Gives the address of a fresh session bus."""
    options = ["--session", "--nofork", "--print-address=1"]
    with subprocess.Popen(
        ["dbus-daemon", *options], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as daemon:
        assert daemon.stdout is not None
        try:
            yield daemon.stdout.readline().strip()
        finally:
            daemon.terminate()


class Compositor:
    """A compositor without a screen; can be started again.

    Args:
        command: the program and its options.
        environment: with ``WAYLAND_DISPLAY``, which names its socket.
        log: what it says is written there.
        user: number of the user who runs it, and of the group; None: this one.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        log: Path,
        user: int | None = None,
    ) -> None:
        self.command, self.environment, self.log = command, dict(environment), log
        self.user = user
        self.start()

    def start(self) -> None:
        """Starts it and waits for its socket."""
        inner = {key: value for key, value in self.environment.items() if key != "WAYLAND_DISPLAY"}
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                self.command,
                env=inner,
                stdout=log,
                stderr=log,
                start_new_session=True,
                user=self.user,
                group=self.user,
                extra_groups=None if self.user is None else [],
            )
        wait_until(self._answers, lambda: self.log.read_text(errors="replace")[-3000:])

    def _answers(self) -> bool:
        assert self.process.poll() is None, self.log.read_text(errors="replace")[-3000:]
        try:
            Wayland(find_display(self.environment)).close()
        except DesktopError:
            return False
        return True

    def end(self) -> None:
        """Ends it at once, as a crash does, and what it has started."""
        for number in (signal.SIGTERM, signal.SIGKILL):
            if self.process.poll() is None:
                os.killpg(self.process.pid, number)
                with_limit = time.monotonic() + 5.0
                while self.process.poll() is None and time.monotonic() < with_limit:
                    time.sleep(0.02)
        for left in Path(self.environment["XDG_RUNTIME_DIR"]).glob(
            self.environment["WAYLAND_DISPLAY"] + "*"
        ):
            left.unlink()


def skip(sentence: str) -> NoReturn:
    """Skips the test, or fails on a machine that is meant to have what it needs."""
    if os.environ.get("NEUROTOUCH_REQUIRE_DESKTOPS") == "1":
        pytest.fail(sentence)
    pytest.skip(sentence)


def find_without_rights(name: str, folder: Path) -> str | None:
    """Returns a program without its file's capabilities, which a container may not grant."""
    found = shutil.which(name)
    if found is None:
        return None
    copy = folder / name  # the same name: KWin looks at it
    shutil.copyfile(found, copy)
    copy.chmod(0o755)
    return str(copy)
