"""Answers the questions on the control socket of a running driver."""

import re
from base64 import b64encode
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import Any, Final, cast

from neurotouch_hid.client import LOADING_S, REQUEST_S
from neurotouch_hid.driver.packet_feed import PacketFeed
from neurotouch_hid.driver.profile_watch import ProfileWatch
from neurotouch_hid.driver.program_pauses import ProgramPauses
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.driver.told_window import ToldWindow
from neurotouch_hid.errors import DriverError, NeuroTouchError
from neurotouch_hid.printable import make_printable
from neurotouch_hid.runtime.command_queue import CommandName
from neurotouch_hid.runtime.pipeline_control import PipelineControl
from neurotouch_hid.source import Source
from neurotouch_hid.status import Answer, Described, Done
from neurotouch_hid.vocabulary import NAME_PATTERN, PipelineState

COMMANDS: Final = (
    "pause",
    "resume",
    "pause_while_connected",
    "panic",
    "stop",
    "reload",
    "status",
    "use",
    "settings",
    "record",
    "gel",
    "window",
)

SAID: Final = {
    "pause": "Paused. Everything is released until: neurotouch resume",
    "resume": "Resumed. The next gesture counts.",
    "panic": "Stopped by panic. Everything is released until: neurotouch resume",
}
"""The sentences about a command that has taken effect."""

_ALREADY: Final = {
    "pause": "Already paused. Go on with: neurotouch resume",
    "resume": "Already running.",
    "panic": "Already stopped by panic. Go on with: neurotouch resume",
}
"""The sentences about a command that changes nothing."""

_BEGINS: Final[Mapping[PipelineState, str]] = {
    "paused": "pause",
    "running": "resume",
    "panic": "panic",
}
"""The command that leads to each state of the pipeline: a pause during a panic leaves the panic."""

_WAIT_S: Final = 0.8 * REQUEST_S


class Commands:
    """Answers the questions within ``REQUEST_S``, or ``LOADING_S`` where a profile is to be loaded.

    Args:
        control: takes the commands for the pipeline.
        profiles: loads its profiles.
        packet_feed: hands out the packets that the pipeline gets.
        pauses: pauses it for other programs.
        source: gives these packets.
        surroundings: the people, files and callbacks around the pipeline.
        describe: describes what surrounds the pipeline; called for each ``status``.
        window: a service's; None for a driver that asks the desktop itself.
    """

    def __init__(
        self,
        control: PipelineControl,
        profiles: ProfileWatch,
        packet_feed: PacketFeed,
        pauses: ProgramPauses,
        source: Source,
        surroundings: Surroundings,
        describe: Callable[[], Described],
        window: ToldWindow | None,
    ) -> None:
        self._control = control
        self._profiles = profiles
        self._packets = packet_feed
        self._pauses = pauses
        self._source = source
        self._end, self._people = surroundings.end, surroundings.people
        self._seed, self._gel_file = surroundings.seed, surroundings.gel_file
        self._describe = describe
        self._window = window

    def answer(self, question: dict[str, Any], uid: int) -> Answer:
        """Returns the answer to a question of a user from the socket."""
        try:
            return self._apply(question, uid)
        except NeuroTouchError as error:
            return {"ok": False, "error": error.message, "hint": error.hint}

    def _apply(self, question: dict[str, Any], uid: int) -> Answer:
        match question["command"]:
            case "pause" | "resume" | "panic" as command:
                return self._submit(cast(CommandName, command))
            case "stop":
                return self._stop()
            case "reload" | "settings" | "window":
                return self._take(question, uid)
            case "use":
                return self._use(question.get("profile"))
            case "status" | "gel" as asked:
                return self._tell(asked)
            case "record" | "pause_while_connected" as begun:
                return self._begin_stream(begun)
            case unknown:
                raise DriverError(
                    f"There is no command '{make_printable(unknown[:64])}'.",
                    hint=f"Commands: {', '.join(COMMANDS)}.",
                )

    def _begin_stream(self, begun: str) -> Answer:
        """Returns the first line of an answer that goes on for as long as the connection."""
        if begun == "pause_while_connected":
            self._pauses.require_place()
            return {"ok": True, "text": "The state follows, now and at the end of the pause."}
        self._packets.require_place()
        return {
            "ok": True,
            "source": self._source.name,
            "simulated": self._source.is_simulated,
            "seed": self._seed,
            "text": "Packets follow.",
        }

    def _tell(self, asked: str) -> Answer:
        if asked == "status":
            return {"ok": True, "version": 1, **self._control.status(), **self._describe()}
        file = b64encode(self._gel_file).decode()  # byte for byte, as it was read
        return {"ok": True, "file": file, "text": "The file of the gel is in 'file'."}

    def _submit(self, command: CommandName) -> Done:
        before = self._control.mapping.state
        done = self._control.submit(command).done
        if _is_done(done, _WAIT_S):
            after = done.result()
            said = _ALREADY if after == before else SAID
            return {"ok": True, "done": True, "text": said[_BEGINS[after]]}
        text = (
            f"No data from the source. The pad is released; '{command}' takes effect when "
            "data resumes."
        )
        return {"ok": True, "done": False, "text": text}

    def _stop(self) -> Done:
        if self._end is None:
            raise DriverError(
                "The system's service plays, and only an administrator can end it.",
                hint="Release everything: neurotouch panic. To end it: "
                "sudo systemctl stop neurotouch",
            )
        self._end()
        return {"ok": True, "text": "Ended. The pad is neutral."}

    def _take(self, question: dict[str, Any], uid: int) -> Done:
        """Takes what a person has changed: saved files, or the application in front."""
        match question["command"]:
            case "window":
                if self._window is None:
                    raise DriverError("This driver asks the desktop itself.")
                self._window.tell(uid, question)
                return {"ok": True, "text": "The profile follows the window."}
            case "reload":
                return self._report(self._profiles.reload())
            case _ if self._people is not None:
                self._people.keep(uid, question)
        return self._report(self._profiles.refresh())

    def _use(self, profile: object) -> Done:
        if not isinstance(profile, str):
            raise DriverError("The profile to use is missing.")
        if self._people is not None and not re.fullmatch(NAME_PATTERN, profile):
            # The service reads files that the asker may not, and an error quotes their lines.
            raise DriverError(
                "The service takes profiles by name only.",
                hint="Import it first: neurotouch profile import FILE",
            )
        return self._report(self._profiles.use(profile))

    def _report(self, done: Future[str]) -> Done:
        if not _is_done(done, LOADING_S):
            raise DriverError(
                f"The profile is still being loaded after {LOADING_S:g} s.",
                hint="See later which one is active: neurotouch status",
            )
        name = done.result()
        return {
            "ok": True,
            "done": True,
            "profile": name,
            "text": f"Profile '{name}' is now active.",
        }


def _is_done(done: Future[Any], wait_s: float) -> bool:
    """Returns True once it is done, False if that takes longer.

    Raises:
        NeuroTouchError: it has failed.
    """
    try:
        done.result(wait_s)
    except FutureTimeoutError:
        return False
    return True
