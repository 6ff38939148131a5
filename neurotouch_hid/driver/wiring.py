"""What surrounds a line that plays live: control socket, profiles, keyboard, desktop, sound."""

import os
from collections.abc import Callable
from contextlib import ExitStack, suppress
from types import TracebackType
from typing import Self

import click

from neurotouch_hid.client import find_runtime_folder
from neurotouch_hid.desktop import Follower, open_window
from neurotouch_hid.device import ChordReader, Copilot, Device
from neurotouch_hid.driver.broadcast import Broadcast
from neurotouch_hid.driver.commands import SAID, Commands
from neurotouch_hid.driver.control import ControlSocket
from neurotouch_hid.driver.extra_devices import find_companions
from neurotouch_hid.driver.reload import ProfileWatch
from neurotouch_hid.driver.settings import DriverSettings
from neurotouch_hid.errors import AlreadyRunningError, DriverError, ProfileError
from neurotouch_hid.monitor import SoundMonitor
from neurotouch_hid.monitor.encoder import Facts, Observer
from neurotouch_hid.monitor.publisher import Feed
from neurotouch_hid.profile import Profile, UserSettings
from neurotouch_hid.profile.reading.library import find_profile
from neurotouch_hid.runtime import Pipeline, Session, Stopwatch, Tap


def take_control(closing: ExitStack) -> ControlSocket | None:
    """The control socket, closed by ``closing``; None, with a warning, where none can be made.

    Raises:
        AlreadyRunningError: another driver runs.
    """
    try:
        return closing.enter_context(ControlSocket(find_runtime_folder()))
    except AlreadyRunningError:
        raise
    except DriverError as error:
        click.echo(f"Warning: {error.message} 'neurotouch pause' will not work.", err=True)
        return None


class Live:
    """Listens to the outside while a line plays; a context manager.

    Args:
        control: where commands come in, if anywhere.
        pipeline: the line.
        stopwatch: watches its stages.
        device: the pad.
        name: the profile as it was asked for.
        profile: what it says.
        user: the person's values.
        settings: chords and applications.
        source: the name of the source.
        facts: what else those who look on are told.
        copilot: a device that plays along; chords are heard on it too.

    Attributes:
        session: what the line obeys.
        taps: what reads the line's Steps: sound, and the feed of those who look on.
    """

    def __init__(
        self,
        control: ControlSocket | None,
        pipeline: Pipeline,
        stopwatch: Stopwatch,
        device: Device,
        *,
        name: str,
        profile: Profile,
        user: UserSettings,
        settings: DriverSettings,
        source: str,
        facts: Facts | None = None,
        copilot: Copilot | None = None,
    ) -> None:
        self.session = Session(pipeline, stopwatch, user)
        self._control = control
        self._closing = ExitStack()
        self._profiles = ProfileWatch(
            name,
            profile,
            user,
            self.session,
            announce=_announce,
            prepare=lambda new: device.prepare(find_companions(new)),
        )
        self._closing.callback(self._profiles.close)
        self.session.listen(self._hear)
        chords = ChordReader(self._press, settings.keys_of)
        self._closing.callback(chords.close)
        if copilot is not None:  # nobody else can read it
            copilot.listen(settings.keys_of, self._press)
            self.session.follow(lambda: copilot.share.buttons)
        self.sound = SoundMonitor(self.session, _announce)
        self._closing.callback(self.sound.close)
        self._broadcast = Broadcast()
        self._closing.callback(self._broadcast.close)
        self.taps: list[Tap] = [self.sound, self._broadcast]
        if control is not None:
            looks: Facts = {
                "source": lambda: source,
                "device": lambda: device.name,
                "file": self._find_file,
            }
            observer = Observer(self.session, stopwatch, {**looks, **(facts or {})})
            self._open_feed(observer, control)
        self._facts: dict[str, Callable[[], str]] = {
            "source": lambda: source,
            "device": lambda: device.name,
            "keyboard": chords.describe,
            "desktop": lambda: "none has a profile of its own",
            "sound": self.sound.describe,
            **(facts or {}),
        }
        if settings.applications:
            follower = Follower(
                settings.profile_of, lambda: open_window(os.environ), self._profiles.follow
            )
            self._closing.callback(follower.close)
            self._facts["desktop"] = follower.describe

    def reload(self) -> None:
        """Loads the profile anew; safe in a signal handler."""
        self._profiles.reload()

    def __enter__(self) -> Self:
        if self._control is not None:
            commands = Commands(self.session, self._profiles, self._facts, self._broadcast)
            self._control.serve(commands.answer)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._closing.close()

    def _open_feed(self, observer: Observer, control: ControlSocket) -> None:
        admits = control.admits if control.has_guests else None
        try:
            feed = Feed(find_runtime_folder(), observer, admits)
            self.taps.append(self._closing.enter_context(feed))
        except DriverError as error:
            click.echo(f"Warning: {error.message} 'neurotouch view' will not work.", err=True)

    def _find_file(self) -> str:
        """Where the profile that holds lies; empty if it has gone."""
        with suppress(ProfileError, OSError, RuntimeError):  # the last: a link leads to itself
            return str(find_profile(self._profiles.name).resolve())
        return ""

    def _press(self, chord: str) -> None:
        """What the keyboard orders: panic, or pause and its end."""
        with suppress(DriverError):  # the line stands still, so everything is released
            self.session.tell("panic" if chord == "panic" else "toggle")

    def _hear(self, command: str) -> None:
        """What the line tells: a command has taken effect, or the gel asks for another profile."""
        if command == "next_profile":
            self._profiles.next()
        elif command in SAID:
            self._profiles.say(SAID[command])


def _announce(sentence: str) -> None:
    with suppress(OSError):  # the terminal has gone, or the disk that keeps it is full
        click.echo(sentence, err=True)
