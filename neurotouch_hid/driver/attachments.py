"""Connects a running pipeline with the world around it."""

import os
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Self

from neurotouch_hid.closing import Closing
from neurotouch_hid.desktop import Follower, open_window
from neurotouch_hid.device import ChordReader, Copilot, Device
from neurotouch_hid.driver.broadcast import Broadcast
from neurotouch_hid.driver.commands import SAID, Commands
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.extra_devices import find_extra_devices
from neurotouch_hid.driver.people import People, Person
from neurotouch_hid.driver.profile_watch import ProfileWatch
from neurotouch_hid.driver.settings import DriverSettings
from neurotouch_hid.errors import DriverError
from neurotouch_hid.monitor import SoundMonitor
from neurotouch_hid.monitor.encoder import Facts, StateEncoder
from neurotouch_hid.monitor.publisher import Publisher
from neurotouch_hid.players import find_machine_folder, find_runtime_folder
from neurotouch_hid.profile import Profile, UserSettings
from neurotouch_hid.runtime import Pipeline, PipelineControl, Tap
from neurotouch_hid.source import Source


class Attachments(Closing):
    """Everything around a running pipeline: commands, profiles, hotkeys, desktop, sound, viewers.

    Args:
        control: where commands come in, if anywhere.
        pipeline: the stages.
        device: the pad.
        name: the profile as the person asked for it.
        profile: the profile at the start.
        user: the person's values.
        settings: hotkeys and applications.
        source: the source.
        player: the player number; None means the one of the environment.
        announce: is told sentences for the person, from several threads.
        facts: what ``status`` and the page are told beside the state of the pipeline.
        copilot: a device that plays along; hotkeys work on it too.
        end: ends the driver; None if only systemd may.
        people: a service's settings of the people at the machine.
        person: the one at the machine at the start.
        default: a service's profile for a person who has chosen none.

    Attributes:
        control: takes commands for the pipeline.
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
        source: Source,
        player: int | None = None,
        announce: Callable[[str], object] = str,  # says nothing
        facts: Facts | None = None,
        copilot: Copilot | None = None,
        end: Callable[[], object] | None = None,
        people: People | None = None,
        person: Person | None = None,
        default: str | None = None,
    ) -> None:
        self.control = PipelineControl(pipeline, user)
        self._socket = control
        self._end = end
        self._people = people
        self._is_simulated = source.is_simulated
        self._player = player
        self._announce = announce
        self._closing = ExitStack()
        self._profiles = ProfileWatch(
            name,
            profile,
            user,
            self.control,
            announce=announce,
            prepare=lambda new: device.prepare(find_extra_devices(new)),
            player=player,
            people=people,
            person=person,
            default=default,
        )
        self._closing.callback(self._profiles.close)
        self.control.on_command(self._hear)
        chords = ChordReader(self._press, settings.keys_of)
        self._closing.callback(chords.close)
        if copilot is not None:  # nobody else can read it
            copilot.listen(settings.keys_of, self._press)
            self.control.set_helper(lambda: copilot.share.buttons)
        self._broadcast = Broadcast()
        self._closing.callback(self._broadcast.close)
        self.taps: list[Tap] = [self._broadcast]
        describe_sound = _describe_sound_of_service
        if people is None:
            sound = SoundMonitor(self.control, announce)
            self._closing.callback(sound.close)
            self.taps.append(sound)
            describe_sound = sound.describe
        if control is not None:
            looks: Facts = {
                "source": lambda: source.name,
                "simulated": lambda: source.is_simulated,
                "device": lambda: device.name,
                "file": lambda: self._profiles.file,
                "plays_sound": lambda: people is None,
            }
            encoder = StateEncoder(self.control, {**looks, **(facts or {})})
            self._open_feed(encoder, control)
        self._facts: dict[str, Callable[[], str]] = {
            "source": lambda: source.name,
            "device": lambda: device.name,
            "keyboard": chords.describe,
            "desktop": lambda: "none has a profile of its own",
            "sound": describe_sound,
            "settings": self._describe_settings,
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
        if self._socket is not None:
            commands = Commands(
                self.control,
                self._profiles,
                self._facts,
                self._broadcast,
                self._end,
                self._people,
                is_simulated=self._is_simulated,
            )
            self._socket.serve(commands.answer)
        return self

    def close(self) -> None:
        """Ends all threads and sockets."""
        self._closing.close()

    def _open_feed(self, encoder: StateEncoder, control: ControlSocket) -> None:
        admits = control.admits if control.has_guests else None
        try:
            feed = Publisher(find_runtime_folder(self._player), encoder, admits)
            self.taps.append(self._closing.enter_context(feed))
        except DriverError as error:
            self._announce(f"Warning: {error.message} 'neurotouch view' will not work.")

    def _describe_settings(self) -> str:
        person = self._profiles.person
        if person is not None:
            return f"those of the person at the machine, from {person.origin}"
        if self._people is None:
            return "this user's own"
        return f"the machine's, {find_machine_folder()}"

    def _press(self, chord: str) -> None:
        """Acts on a hotkey: panic, or pause and its end."""
        with suppress(DriverError):  # the pipeline has stopped, so everything is released
            self.control.submit("panic" if chord == "panic" else "toggle")

    def _hear(self, command: str) -> None:
        """Handles what the gel asks for: a command took effect, or another profile is wanted."""
        if command == "next_profile":
            self._profiles.next()
        elif command in SAID:
            self._profiles.say(SAID[command])


def _describe_sound_of_service() -> str:
    """Returns where the sounds of a service are played: it has no right to anybody's audio."""
    return "played in the session of the person at the machine, by 'neurotouch session'"
