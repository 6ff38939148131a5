"""``neurotouch session``: gives the system's service a person's settings, and plays its sounds.

It also tells the service which profile the application in front has.
"""

import fcntl
import os
import select
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Final

import click

from neurotouch_hid.cli.session_window import WindowTeller
from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.closing import Closing
from neurotouch_hid.files.stamps import Stamp, read_stamps

if TYPE_CHECKING:
    import socket

    from neurotouch_hid.monitor.stream_sound import StreamSound

AGAIN_S: Final = 2.0
"""Interval of looking for a driver; also the first pause before settings are handed over again."""

MOST_S: Final = 60.0
"""The longest such pause. It doubles: a profile with errors is refused again, and each time the
service's journal says so."""

LOOK_S: Final = 1.0
"""Interval of looking for changes of the person's files."""

HZ: Final = 30
"""States a second, more than there are sounds a second."""

HandOver = Callable[[int], bool]
"""Hands the settings of a player to the running driver; returns whether the driver has them."""


@click.command(
    epilog="\b\nExamples:\n"
    "  systemctl --user status neurotouch-session       its state; it starts with your session\n"
    "  systemctl --user mask --now neurotouch-session   switch it off; 'unmask' switches it on\n"
    "  neurotouch session                               the same by hand; Ctrl-C ends it\n\n"
    "Exit codes: 0 ended by a signal, 75 it already runs for this user."
)
def command() -> None:
    """Connect the system's service with this session: your settings and your loudspeakers.

    The service can read no home folder and play no sound. While you are at the machine, this
    program gives it your settings whenever a file of them changes. It plays the service's sounds
    and speech as your own values say. It is silent while a driver of your own runs, which plays its
    sounds itself. If your driver.yaml gives applications a profile, it tells the service which
    profile the active window has.
    """
    from neurotouch_hid.handover import hand_over
    from neurotouch_hid.players import PLAYER, PLAYERS, find_player, find_runtime_folder
    from neurotouch_hid.process.signals import stop_on_signals

    def announce(sentence: str) -> None:
        with suppress(OSError):  # the terminal has gone
            echo(sentence, err=True)

    told: dict[int, str] = {}

    def give(player: int) -> bool:
        done = hand_over(player)
        refusal = f"{done.text} {done.fix}".strip() if done.status == "refused" else ""
        if refusal and told.get(player) != refusal:  # it is tried again, and said once
            announce(f"Warning: {refusal}")
        told[player] = refusal
        return done.status == "plays"

    players = [find_player()] if os.environ.get(PLAYER) else [int(name) for name in PLAYERS]
    stop = stop_on_signals()
    with _only_one(find_runtime_folder(players[0]) / "session"):
        if sys.stderr.isatty():
            announce("The service gets your settings, and its sounds play here. Ctrl-C ends this.")
        serve(players, give, stop, announce)


def serve(
    players: Iterable[int], hand_over: HandOver, stop: Event, announce: Callable[[str], object]
) -> None:
    """Hands settings over and plays sounds until ``stop`` is set.

    Args:
        players: numbers of the players.
        hand_over: called when a player's files have changed, until it returns True.
        stop: ends it within a second, or when a driver has answered.
        announce: shows the person a sentence; called from several threads.
    """
    with ExitStack() as stack:
        links = [stack.enter_context(_Link(player, hand_over, announce)) for player in players]
        due_s = 0.0
        while not stop.is_set():
            now_s = time.monotonic()
            if now_s >= due_s:
                due_s = now_s + LOOK_S
                for link in links:
                    link.look(now_s)
            peers = {link.peer: link for link in links if link.peer is not None}
            if not peers:
                stop.wait(LOOK_S)
                continue
            for peer in select.select(list(peers), [], [], LOOK_S)[0]:
                peers[peer].hear()


class _Link(Closing):
    """Connection between the person and the driver of one player.

    Args:
        player: number of the player.
        hand_over: see ``serve``.
        announce: shows the person a sentence.
    """

    def __init__(self, player: int, hand_over: HandOver, announce: Callable[[str], object]) -> None:
        from neurotouch_hid.subscriber import Subscriber

        self._player = player
        self._hand_over = hand_over
        self._announce = announce
        self._subscriber = Subscriber(player)
        self._connect_s = 0.0
        self._values: dict[Path, Stamp] = {}
        self._given: dict[Path, Stamp] | None = None
        self._tried: dict[Path, Stamp] | None = None
        self._give_s = self._pause_s = 0.0
        self._sound: StreamSound | None = None
        self._window = WindowTeller(player, announce)

    @property
    def peer(self) -> "socket.socket | None":
        """The connection to a driver's states; None without one, or if no sound is wanted."""
        return self._subscriber.peer

    def look(self, now_s: float) -> None:
        """Checks files and drivers; to be called about once a second.

        Args:
            now_s: present time on a steady clock.
        """
        self._look_at_values()
        self._give(now_s)
        self._window.look(now_s)
        if not self._wants_sound():
            self._leave(now_s)
        elif self.peer is None and now_s >= self._connect_s:
            self._connect_s = now_s + AGAIN_S
            self._subscriber.want(HZ)
            self._subscriber.connect()
        elif self.peer is not None and self._finds_nearer(self.peer):
            self._leave(now_s)

    def hear(self) -> None:
        """Plays the sounds of the newest state."""
        state = self._subscriber.take()
        if state is not None and self._sound is not None and not self._sound.hear(state):
            self._subscriber.want(
                0
            )  # that driver plays its own sounds; the connection shows when it ends
        if self.peer is None:  # the driver has ended, or does not admit this person now
            self._leave(time.monotonic())

    def close(self) -> None:
        """Disconnects from the driver and the desktop, and ends the sound thread."""
        self._window.close()
        self._subscriber.close()
        if self._sound is not None:
            self._sound.close()

    def _leave(self, now_s: float) -> None:
        self._subscriber.close()
        self._connect_s = now_s + AGAIN_S
        if self._sound is not None:
            self._sound.forget()

    def _finds_nearer(self, peer: "socket.socket") -> bool:
        """Returns True if a driver of the person's own has started since the connection."""
        from neurotouch_hid.client import is_served
        from neurotouch_hid.players import list_runtime_folders

        folders = list_runtime_folders(self._player)
        with suppress(OSError, ValueError):
            place = folders.index(Path(peer.getpeername()).parent)
            return any(is_served(folder) for folder in folders[:place])
        return False

    def _give(self, now_s: float) -> None:
        """Hands the settings over if the files have changed and a driver runs."""
        from neurotouch_hid.errors import NeuroTouchError
        from neurotouch_hid.players import has_socket, list_runtime_folders

        files = _stamp_settings(self._player)
        if files == self._given:
            return
        if files != self._tried:
            self._tried, self._give_s, self._pause_s = files, now_s, AGAIN_S
        folders = list_runtime_folders(self._player)
        if now_s < self._give_s or not any(map(has_socket, folders)):
            return
        with suppress(NeuroTouchError):
            if self._hand_over(self._player):
                self._given = files
                return
        self._give_s = now_s + self._pause_s
        self._pause_s = min(2 * self._pause_s, MOST_S)

    def _wants_sound(self) -> bool:
        return self._sound is not None and self._sound.feedback.sound != "none"

    def _look_at_values(self) -> None:
        """Reads the person's values, or the machine's, when their files have changed."""
        files = _stamp_values(self._player)
        if files == self._values:
            return
        self._values = files
        if self._sound is None and not any(map(_mentions_sound, files)):
            return  # what reads and plays them takes 33 MB
        from neurotouch_hid.errors import NeuroTouchError
        from neurotouch_hid.monitor.stream_sound import StreamSound
        from neurotouch_hid.profile import load_user

        try:
            feedback = load_user(player=self._player).feedback
        except NeuroTouchError as error:
            self._announce(f"Warning: the sounds stay as they were. {error.message}")
            return
        if self._sound is None:
            self._sound = StreamSound(self._announce)
        self._sound.feedback = feedback


def _stamp_settings(player: int) -> dict[Path, Stamp]:
    """Returns the person's files as they are now: values and profiles."""
    from neurotouch_hid.players import find_config_folder, find_user_file

    return read_stamps([find_user_file(player), *find_config_folder().glob("profiles/*.yaml")])


def _stamp_values(player: int) -> dict[Path, Stamp]:
    """Returns the stamps of all files that may contain this person's choice of sounds."""
    from neurotouch_hid.players import find_machine_folder, find_user_file

    return read_stamps([find_user_file(player), find_user_file(player, find_machine_folder())])


def _mentions_sound(path: Path) -> bool:
    try:
        return b"sound" in path.read_bytes()
    except OSError:
        return False


@contextmanager
def _only_one(path: Path) -> Iterator[None]:
    """Makes sure that only one of these runs for each user.

    Raises:
        AlreadyRunningError: one runs.
        DriverError: the lock cannot be made.
    """
    from neurotouch_hid.errors import AlreadyRunningError, DriverError

    try:
        path.parent.mkdir(mode=0o700, exist_ok=True)
        lock = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
    except OSError as error:
        raise DriverError(f"No lock can be made: {error.strerror} ({path}).") from None
    try:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise AlreadyRunningError(
                "'neurotouch session' already runs for this user.",
                hint="See what it does: systemctl --user status neurotouch-session",
            ) from None
        yield
    finally:
        os.close(lock)
