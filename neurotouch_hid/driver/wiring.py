"""Connects a running pipeline with the world around it."""

import os
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Self

from neurotouch_hid.client import find_runtime_folder
from neurotouch_hid.closing import Closing
from neurotouch_hid.desktop import Follower, open_window
from neurotouch_hid.device import ChordReader, Copilot, Device
from neurotouch_hid.driver.broadcast import Broadcast
from neurotouch_hid.driver.commands import SAID, Commands
from neurotouch_hid.driver.control import ControlSocket
from neurotouch_hid.driver.extra_devices import find_extra_devices
from neurotouch_hid.driver.reload import ProfileWatch
from neurotouch_hid.driver.settings import DriverSettings
from neurotouch_hid.errors import DriverError, ProfileError
from neurotouch_hid.monitor import SoundMonitor
from neurotouch_hid.monitor.encoder import Facts, StateEncoder
from neurotouch_hid.monitor.publisher import Publisher
from neurotouch_hid.profile import Profile, UserSettings
from neurotouch_hid.profile.reading.library import find_profile
from neurotouch_hid.runtime import Pipeline, Session, Tap


class Wiring(Closing):
    """Everything around a running pipeline: commands, profiles, hotkeys, desktop, sound, viewers.

    Args:
        control: where commands come in, if anywhere.
        pipeline: the stages.
        device: the pad.
        name: the profile as the person asked for it.
        profile: the profile at the start.
        user: the person's values.
        settings: hotkeys and applications.
        source: the name of the source.
        player: the player number; None means the one of the environment.
        announce: is told sentences for the person, from several threads.
        facts: what ``status`` and the page are told beside the state of the pipeline.
        copilot: a device that plays along; hotkeys work on it too.

    Attributes:
        session: takes commands for the pipeline.
        taps: what reads its Steps: sound, recorders, viewers.
    """

    def __init__(
        self,
        control: ControlSocket | None,
        pipeline: Pipeline,
        device: Device,
        *,
        name: str,
        profile: Profile,
        user: UserSettings,
        settings: DriverSettings,
        source: str,
        player: int | None = None,
        announce: Callable[[str], object] = str,  # says nothing
        facts: Facts | None = None,
        copilot: Copilot | None = None,
    ) -> None:
        self.session = Session(pipeline, user)
        self._control = control
        self._player = player
        self._announce = announce
        self._closing = ExitStack()
        self._profiles = ProfileWatch(
            name,
            profile,
            user,
            self.session,
            announce=announce,
            prepare=lambda new: device.prepare(find_extra_devices(new)),
            player=player,
        )
        self._closing.callback(self._profiles.close)
        self.session.on_command(self._hear)
        chords = ChordReader(self._press, settings.keys_of)
        self._closing.callback(chords.close)
        if copilot is not None:  # nobody else can read it
            copilot.listen(settings.keys_of, self._press)
            self.session.set_helper(lambda: copilot.share.buttons)
        self.sound = SoundMonitor(self.session, announce)
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
            observer = StateEncoder(self.session, {**looks, **(facts or {})})
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
        """Loads the profile again; safe in a signal handler."""
        self._profiles.reload()

    def __enter__(self) -> Self:
        if self._control is not None:
            commands = Commands(self.session, self._profiles, self._facts, self._broadcast)
            self._control.serve(commands.answer)
        return self

    def close(self) -> None:
        """Ends all threads and sockets."""
        self._closing.close()

    def _open_feed(self, observer: StateEncoder, control: ControlSocket) -> None:
        admits = control.admits if control.has_guests else None
        try:
            feed = Publisher(find_runtime_folder(self._player), observer, admits)
            self.taps.append(self._closing.enter_context(feed))
        except DriverError as error:
            self._announce(f"Warning: {error.message} 'neurotouch view' will not work.")

    def _find_file(self) -> str:
        """Where the profile that holds lies; empty if it has gone."""
        with suppress(ProfileError, OSError, RuntimeError):  # the last: a link leads to itself
            return str(find_profile(self._profiles.name).resolve())
        return ""

    def _press(self, chord: str) -> None:
        """What the keyboard orders: panic, or pause and its end."""
        with suppress(DriverError):  # the line stands still, so everything is released
            self.session.submit("panic" if chord == "panic" else "toggle")

    def _hear(self, command: str) -> None:
        """What the line tells: a command has taken effect, or the gel asks for another profile."""
        if command == "next_profile":
            self._profiles.next()
        elif command in SAID:
            self._profiles.say(SAID[command])
