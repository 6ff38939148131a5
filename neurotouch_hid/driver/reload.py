"""Profiles while the line runs: reloads what is saved, switches when told, never in the line."""

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal

from neurotouch_hid.errors import NeuroTouchError, ProfileError
from neurotouch_hid.profile import Profile, UserSettings, load_profile, load_user
from neurotouch_hid.profile.reading.library import find_profile, find_user_file, find_user_folder
from neurotouch_hid.runtime.session import Session

POLL_S: Final = 0.25
"""A saved file is noticed, and left alone for one poll more because an editor may still be writing:
together with loading that is within the second that is promised."""

Stamp = tuple[int, int, int]
"""Inode, mtime in ns and size of a file: an editor that replaces files changes the inode."""

Action = Literal["reload", "use", "follow", "next", "say", "stop"]


@dataclass(frozen=True, slots=True)
class _Wish:
    """What a person wants to be loaded; ``done`` gets the name of the profile that then holds."""

    action: Action
    name: str | None = None
    done: Future[str] = field(default_factory=Future)


class ProfileWatch:
    """Keeps the profile of a running line up to date, in a thread of its own.

    The profile chosen by hand holds wherever no application asks for another one. A file that
    cannot be used changes nothing: the profile before goes on.

    Args:
        name: the profile that holds at the start, by name or path.
        profile: what it says.
        user: the person's values at the start.
        session: the running line.
        announce: tells the person a sentence; called in the thread of the watch.
        prepare: is given each profile before the pipeline gets it.
        player: the player number; None means the one of the environment.
    """

    def __init__(
        self,
        name: str,
        profile: Profile,
        user: UserSettings,
        session: Session,
        announce: Callable[[str], object],
        prepare: Callable[[Profile], None],
        player: int | None = None,
    ) -> None:
        self._chosen = self._name = name
        self._held = profile, user
        self._session = session
        self._announce = announce
        self._prepare = prepare
        self._wishes: queue.SimpleQueue[_Wish] = queue.SimpleQueue()
        self._player = player
        self._loaded = self._seen = _read_stamps(name, player)
        self._thread = threading.Thread(target=self._work, name="profiles", daemon=True)
        self._thread.start()

    @property
    def name(self) -> str:
        """The profile that holds, as it was asked for."""
        return self._name

    def reload(self) -> Future[str]:
        """Loads the files again, changed or not. A signal handler may call this."""
        return self._wish("reload")

    def use(self, name: str) -> Future[str]:
        """Goes on with another profile; the future holds its name, or why it cannot be used."""
        return self._wish("use", name)

    def follow(self, name: str | None) -> Future[str]:
        """Goes on with the profile an application asks for; None: with the one chosen by hand."""
        return self._wish("follow", name)

    def next(self) -> Future[str]:
        """Goes on with the next of the person's favourites."""
        return self._wish("next")

    def say(self, sentence: str) -> None:
        """Announces a sentence, in the thread of the watch: whoever calls does not wait."""
        self._wish("say", sentence)

    def close(self) -> None:
        """Ends the thread; sentences that were to be said are said first."""
        self._wish("stop")
        self._thread.join()

    def _wish(self, action: Action, name: str | None = None) -> Future[str]:
        wish = _Wish(action, name)
        self._wishes.put(wish)  # SimpleQueue.put is reentrant, so signal handlers may come here
        return wish.done

    def _work(self) -> None:
        due = time.monotonic() + POLL_S
        while True:
            try:
                wish = self._wishes.get(timeout=max(due - time.monotonic(), 0.0))
            except queue.Empty:
                self._look()
                due = time.monotonic() + POLL_S
                continue
            if wish.action == "stop":
                return
            if wish.action == "say":
                self._announce(wish.name or "")
                continue
            try:
                self._grant(wish)
                wish.done.set_result(self._held[0].name)
            except NeuroTouchError as error:
                wish.done.set_exception(error)

    def _look(self) -> None:
        """Reloads what has changed since it was loaded and has then been quiet for one poll."""
        stamps = _read_stamps(self._name, self._player)
        settled, self._seen = stamps == self._seen, stamps
        if stamps != self._loaded and settled:
            with suppress(NeuroTouchError):  # announced; the profile before goes on
                self._go_on_with(self._name, "has been reloaded", only_if_changed=True)

    def _grant(self, wish: _Wish) -> None:
        match wish.action:
            case "use":
                self._go_on_with(wish.name or "", "is in use")
                self._chosen = self._name
            case "follow":
                wanted = wish.name or self._chosen
                if wanted != self._name:
                    self._go_on_with(wanted, "is in use for this application")
            case "next":
                self._go_on_with(self._find_next(), "is in use")
                self._chosen = self._name
            case _:
                self._go_on_with(self._name, "has been reloaded")

    def _find_next(self) -> str:
        slots = self._held[1].slots
        place = slots.index(self._name) + 1 if self._name in slots else 0
        return slots[place % len(slots)]

    def _go_on_with(self, name: str, what: str, *, only_if_changed: bool = False) -> None:
        """Loads a profile and the person's values and hands both to the line.

        Raises:
            NeuroTouchError: one of the files cannot be used, or the line takes no orders; it has
                been announced, and what holds goes on.
        """
        self._loaded = _read_stamps(
            name, self._player
        )  # before reading: what is saved meanwhile counts again
        try:
            new = profile, user = load_profile(name), load_user(player=self._player)
            if only_if_changed and new == self._held:
                return  # another file, or a comment: no reason to release anything
            self._prepare(profile)
            self._session.switch(profile, user)
        except NeuroTouchError as error:
            self._session.note_error(error.message.split("\n", 1)[0])
            self._announce(f"The profile '{self._held[0].name}' goes on as it was: {error.message}")
            raise
        self._held, self._name = new, name
        self._announce(f"The profile '{profile.name}' {what}.")


def _read_stamps(name: str, player: int | None) -> dict[Path, Stamp]:
    """The stamps of a profile's file, of all it may be built on, and of the person's values.

    Files that are not there have none. Shipped profiles change with the program only.
    """
    paths = [find_user_file(player)]
    with suppress(ProfileError):
        paths.append(find_profile(name))
    with suppress(OSError):
        paths += find_user_folder().glob("*.yaml")
    stamps = {}
    for path in paths:
        with suppress(OSError, ValueError):
            found = path.stat()
            stamps[path] = found.st_ino, found.st_mtime_ns, found.st_size
    return stamps
