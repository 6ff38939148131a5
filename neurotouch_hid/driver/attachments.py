"""Everything around a running pipeline: sockets, profiles, hotkeys, desktop, sounds, viewers."""

import os
from contextlib import ExitStack, suppress
from typing import Final, Self

from neurotouch_hid.closing import Closing
from neurotouch_hid.desktop import Follower, open_window
from neurotouch_hid.device import ChordReader
from neurotouch_hid.driver.chosen import Chosen
from neurotouch_hid.driver.commands import SAID, Commands
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.extra_devices import find_extra_devices
from neurotouch_hid.driver.packet_feed import PacketFeed
from neurotouch_hid.driver.pad_opening import DriverPad
from neurotouch_hid.driver.profile_watch import ProfileWatch
from neurotouch_hid.driver.program_pauses import ProgramPauses
from neurotouch_hid.driver.source_opening import describe_source
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.driver.told_window import ToldWindow
from neurotouch_hid.driver_state import Facts, SourceFacts
from neurotouch_hid.errors import DriverError
from neurotouch_hid.monitor import SoundMonitor
from neurotouch_hid.monitor.encoder import StateEncoder
from neurotouch_hid.monitor.publisher import Publisher
from neurotouch_hid.players import find_machine_folder, find_runtime_folder
from neurotouch_hid.profile.reading import find_values
from neurotouch_hid.runtime import Pipeline, PipelineControl, Tap
from neurotouch_hid.source import FactTelling, Source
from neurotouch_hid.status import Described

_KEYBOARD_OF_SERVICE: Final = "the service may not read keyboards, so none stops it"
_SOUND_OF_SERVICE: Final = (
    "played in the session of the person at the machine, by 'neurotouch session'"
)
_NO_APPLICATIONS: Final = "none has a profile of its own"


class Attachments(Closing):
    """Opens everything around a running pipeline when the block is entered, and closes it.

    Args:
        socket: the control socket, if there is one.
        pipeline: the stages.
        source: the source.
        pad: the pad, and who plays on it.
        chosen: the profile and the values at the start.
        surroundings: the people, files and callbacks around the pipeline.

    Attributes:
        control: takes commands for the pipeline.
        taps: read its Steps: recorders, sound, viewers.
    """

    def __init__(
        self,
        socket: ControlSocket | None,
        pipeline: Pipeline,
        source: Source,
        pad: DriverPad,
        chosen: Chosen,
        surroundings: Surroundings,
    ) -> None:
        self.control = PipelineControl(pipeline, chosen.user)
        self.taps: list[Tap] = []
        self._socket = socket
        self._source = source
        self._pad = pad
        self._chosen = chosen
        self._surroundings = surroundings
        self._sound: SoundMonitor | None = None
        self._follower: Follower | None = None
        self._told: ToldWindow | None = None
        self._closing = ExitStack()

    def __enter__(self) -> Self:
        try:
            self._open()
        except BaseException:
            self.close()
            raise
        return self

    def close(self) -> None:
        """Ends all threads and sockets."""
        self._closing.close()

    def reload(self) -> None:
        """Loads the profile again; safe in a signal handler."""
        self._profiles.reload()

    def _open(self) -> None:
        surroundings, closing = self._surroundings, self._closing
        self._profiles = ProfileWatch(
            self._chosen,
            self.control,
            surroundings,
            prepare=lambda new: self._pad.device.prepare(find_extra_devices(new)),
        )
        closing.callback(self._profiles.close)
        self.control.on_command(self._hear)
        self._open_hotkeys()
        packet_feed = PacketFeed()
        closing.callback(packet_feed.close)
        self.taps.append(packet_feed)
        if not surroundings.is_service:  # which has no right to anybody's audio
            self._sound = SoundMonitor(self.control, surroundings.announce)
            closing.callback(self._sound.close)
            self.taps.append(self._sound)
        if self._socket is not None:
            self._open_feed(self._socket)
        if surroundings.people is not None:  # which sees no desktop
            self._told = ToldWindow(surroundings.people.is_present, self._profiles.follow)
            closing.callback(self._told.close)
        elif surroundings.settings.applications:
            self._follower = Follower(
                surroundings.settings.profile_of,
                lambda: open_window(os.environ),
                self._profiles.follow,
            )
            closing.callback(self._follower.close)
        if self._socket is not None:
            pauses = ProgramPauses(self.control)
            commands = Commands(
                self.control,
                self._profiles,
                packet_feed,
                pauses,
                self._source,
                surroundings,
                self._describe,
                self._told,
            )
            streams = {"record": packet_feed.serve, "pause_while_connected": pauses.serve}
            self._socket.serve(commands.answer, streams)

    def _open_hotkeys(self) -> None:
        keys, copilot = self._surroundings.settings.keys_of, self._pad.copilot
        self._chords = ChordReader(self._press, keys)
        self._closing.callback(self._chords.close)
        if copilot is not None:  # nobody else can read it
            copilot.listen(keys, self._press)
            self.control.set_helper(lambda: copilot.share.buttons)

    def _open_feed(self, socket: ControlSocket) -> None:
        encoder = StateEncoder(self.control, self._tell_facts, self._tell_source)
        admits = socket.admits if socket.has_guests else None
        try:
            feed = Publisher(find_runtime_folder(self._surroundings.player), encoder, admits)
            self.taps.append(self._closing.enter_context(feed))
        except DriverError as error:
            self._surroundings.announce(
                f"Warning: {error.message} 'neurotouch view' will not work."
            )

    def _tell_facts(self) -> Facts:
        return {
            "source": describe_source(self._source),
            "simulated": self._source.is_simulated,
            "device": self._pad.device.name,
            "file": self._profiles.file,
            "plays_sound": self._sound is not None,
            **self._pad.tell_facts(),
        }

    def _tell_source(self) -> SourceFacts:
        return self._source.tell_facts() if isinstance(self._source, FactTelling) else {}

    def _describe(self) -> Described:
        keyboard, sound, desktop = _KEYBOARD_OF_SERVICE, _SOUND_OF_SERVICE, _NO_APPLICATIONS
        if not self._surroundings.is_service:
            keyboard = self._chords.describe()
        if self._sound is not None:
            sound = self._sound.describe()
        if self._follower is not None:
            desktop = self._follower.describe()
        elif self._told is not None:
            desktop = self._told.describe()
        return {
            "source": describe_source(self._source),
            "simulated": self._source.is_simulated,
            "device": self._pad.device.name,
            "keyboard": keyboard,
            "desktop": desktop,
            "sound": sound,
            "settings": self._describe_settings(),
            **self._pad.tell_facts(),
        }

    def _describe_settings(self) -> str:
        person = self._profiles.person
        if person is not None:
            return f"those of the person at the machine, from {person.origin}"
        machine = find_machine_folder()
        if self._surroundings.is_service:
            return f"the machine's, {machine}"
        values = find_values(self._surroundings.player)
        if values.is_relative_to(machine) and values.exists():
            return f"the machine's, {values}, until this user saves values"
        return "this user's own"

    def _press(self, chord: str) -> None:
        """Acts on a hotkey: panic, or pause and its end."""
        with suppress(DriverError):  # the pipeline has stopped, so everything is released
            self.control.submit("panic" if chord == "panic" else "toggle")

    def _hear(self, command: str) -> None:
        """Handles a command of the gel that took effect, or its request for another profile."""
        if command == "next_profile":
            self._profiles.next()
        elif command in SAID:
            self._profiles.say(SAID[command])
