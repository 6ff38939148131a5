"""Loads saved and requested profiles while the pipeline runs, in a thread beside it."""

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal

from neurotouch_hid.driver.chosen import Chosen, load_chosen
from neurotouch_hid.driver.people import Person
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.errors import NeuroTouchError, ProfileError
from neurotouch_hid.files.small_file import find_real_path, means_path
from neurotouch_hid.files.stamps import Stamp, read_stamps
from neurotouch_hid.profile import Profile, UserSettings, load_profile, load_user
from neurotouch_hid.profile.reading import (
    find_profile,
    find_shipped_folder,
    find_values,
    list_changeable_folders,
)
from neurotouch_hid.runtime.pipeline_control import PipelineControl

POLL_S: Final = 0.25
"""A saved file is noticed, and left alone for one poll more because an editor may still be writing:
together with loading that is within the second that is promised."""

Action = Literal["reload", "refresh", "use", "follow", "next", "say", "stop"]


@dataclass(frozen=True, slots=True)
class _Request:
    """A request to load something; ``done`` gets the name of the new profile."""

    action: Action
    name: str | None = None
    done: Future[str] = field(default_factory=Future)


class ProfileWatch:
    """Keeps the profile of a running driver up to date, in a thread of its own.

    The profile chosen by hand is active wherever no application asks for another one. A file that
    cannot be used changes nothing: the profile before goes on.

    Args:
        chosen: the profile and the values at the start.
        control: takes the loaded profiles for the pipeline.
        surroundings: the people whose files are watched; ``announce`` is called in the watch's
            thread.
        prepare: is given each profile before the pipeline gets it.
    """

    def __init__(
        self,
        chosen: Chosen,
        control: PipelineControl,
        surroundings: Surroundings,
        prepare: Callable[[Profile], object],
    ) -> None:
        self._name, self._chosen = chosen.name, chosen.name
        self._person = chosen.person
        self._is_substitute = False
        self._held = chosen.profile, chosen.user
        self._control = control
        self._people, self._default = surroundings.people, surroundings.default
        self._player, self._announce = surroundings.player, surroundings.announce
        self._prepare = prepare
        self._requests: queue.SimpleQueue[_Request] = queue.SimpleQueue()
        self._loaded = self._seen = self._read_stamps(chosen.name)
        self._thread = threading.Thread(target=self._work, name="profiles", daemon=True)
        self._thread.start()

    @property
    def name(self) -> str:
        """The active profile, as it was asked for."""
        return self._name

    @property
    def person(self) -> Person | None:
        """The person whose settings apply; None: those of this process's user."""
        return self._person

    @property
    def file(self) -> str:
        """The file of the active profile, as its owner calls it; empty if it has gone."""
        with suppress(ProfileError, OSError):
            path = find_real_path(find_profile(self._name, self._folder))
            if path.is_symlink():  # it leads to itself
                return ""
            return str(path if self._person is None else self._person.name_file(path))
        return ""

    def reload(self) -> Future[str]:
        """Loads the files again, changed or not. A signal handler may call this."""
        return self._ask("reload")

    def refresh(self) -> Future[str]:
        """Loads the files again; unless they have changed, nothing is released."""
        return self._ask("refresh")

    def use(self, name: str) -> Future[str]:
        """Goes on with another profile; the future gets its name, or why it cannot be used."""
        return self._ask("use", name)

    def follow(self, name: str | None) -> Future[str]:
        """Goes on with the profile an application asks for; None: with the one chosen by hand."""
        return self._ask("follow", name)

    def next(self) -> Future[str]:
        """Goes on with the next of the person's favourites."""
        return self._ask("next")

    def say(self, sentence: str) -> None:
        """Announces a sentence, in the thread of the watch: the caller does not wait."""
        self._ask("say", sentence)

    def close(self) -> None:
        """Ends the thread; sentences that were to be said are said first."""
        self._ask("stop")
        self._thread.join()

    def _ask(self, action: Action, name: str | None = None) -> Future[str]:
        request = _Request(action, name)
        self._requests.put(request)  # reentrant, so signal handlers may come here
        return request.done

    def _work(self) -> None:
        due = time.monotonic() + POLL_S
        while True:
            try:
                request = self._requests.get(timeout=max(due - time.monotonic(), 0.0))
            except queue.Empty:
                self._look()
                due = time.monotonic() + POLL_S
                continue
            if request.action == "stop":
                return
            if request.action == "say":
                self._announce(request.name or "")
                continue
            try:
                self._follow_person()
                self._carry_out(request)
                request.done.set_result(self._held[0].name)
            except NeuroTouchError as error:
                request.done.set_exception(error)

    def _look(self) -> None:
        """Reloads files that have changed since they were loaded, and then not for one poll."""
        if self._follow_person():
            return
        stamps = self._read_stamps(self._name)
        settled, self._seen = stamps == self._seen, stamps
        if stamps != self._loaded and settled:
            with suppress(NeuroTouchError):  # announced; the profile before goes on
                self._go_on_with(self._name, "has been reloaded", only_if_changed=True)

    @property
    def _folder(self) -> Path | None:
        return None if self._person is None else self._person.folder

    def _follow_person(self) -> bool:
        """Goes on with the settings of another person as soon as one is at the machine.

        Returns:
            Whether there is another person.
        """
        person = None if self._people is None else self._people.find_present()
        if person == self._person:
            return False
        self._person = person
        whose = "the machine" if person is None else f"user {person.uid}"
        self._announce(f"The settings of {whose} apply now.")
        self._choose()
        return True

    def _choose(self) -> None:
        """Goes on with the choice of the person at the machine.

        The choice of the person before never goes on: where the new settings cannot be used, the
        machine's apply, and where these cannot be used either, the shipped default.
        """
        choices = (
            lambda: load_chosen(self._person, self._default, self._player),
            lambda: load_chosen(None, self._default, self._player),
            _load_shipped,
        )
        for number, load in enumerate(choices):
            with suppress(NeuroTouchError):  # announced
                self._switch(load, "is in use")
                self._chosen, self._is_substitute = self._name, number > 0
                return

    def _carry_out(self, request: _Request) -> None:
        match request.action:
            case "reload" | "refresh" if self._is_substitute:
                self._choose()
            case "refresh":
                self._go_on_with(self._name, "has been reloaded", only_if_changed=True)
            case "use":
                self._go_on_with(request.name or "", "is in use")
                self._chosen, self._is_substitute = self._name, False
            case "follow":
                wanted = request.name or self._chosen
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
        """Goes on with a profile and the person's values as they are in the files now.

        Raises:
            NeuroTouchError: as ``_switch``.
        """

        def load() -> Chosen:
            user = load_user(player=self._player, folder=self._folder)
            return Chosen(name, load_profile(name, self._folder), user)

        self._switch(load, what, name, only_if_changed=only_if_changed)

    def _switch(
        self,
        load: Callable[[], Chosen],
        what: str,
        name: str = "",
        *,
        only_if_changed: bool = False,
    ) -> None:
        """Loads a profile and values and hands both to the pipeline.

        Args:
            load: gives them.
            what: for the announcement.
            name: of the profile, where it is known before it is loaded.
            only_if_changed: do nothing if they are those that apply already.

        Raises:
            NeuroTouchError: one of the files cannot be used, or the pipeline takes no commands.
                It has been announced, and the active profile goes on.
        """
        # Before reading: what is saved meanwhile counts again.
        self._loaded = self._read_stamps(name or self._name)
        try:
            chosen = load()
            held = chosen.profile, chosen.user
            if only_if_changed and held == self._held:
                # Another file, a comment, or a mistake that is mended: nothing is released.
                if self._control.forget_errors():
                    self._announce(f"The profile '{held[0].name}' is in order again.")
                return
            self._prepare(chosen.profile)
            self._control.switch(*held)
        except NeuroTouchError as error:
            self._control.note_error(error.message.split("\n", 1)[0])
            self._announce(f"The profile '{self._held[0].name}' goes on as it was: {error.message}")
            raise
        self._control.forget_errors()
        self._held, self._name = held, chosen.name
        self._announce(f"The profile '{chosen.profile.name}' {what}.")

    def _read_stamps(self, name: str) -> dict[Path, Stamp]:
        """Returns the stamps of a profile, of all that it may build on, and of the person's values.

        Files that are not there have none. Shipped profiles change with the program only.
        """
        paths = [find_values(self._player, self._folder)]
        if means_path(name):
            paths.append(Path(name))
        with suppress(OSError):
            for folder in list_changeable_folders(self._folder):
                paths += folder.glob("*.yaml")
        return read_stamps(paths)


def _load_shipped() -> Chosen:
    return Chosen("default", load_profile(find_shipped_folder() / "default.yaml"), UserSettings())
