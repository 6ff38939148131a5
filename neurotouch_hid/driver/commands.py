"""What the questions on the control socket mean to a running driver."""

import re
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import Any, Final, cast

from neurotouch_hid.client import LOADING_S, REQUEST_S, Answer
from neurotouch_hid.driver.broadcast import Broadcast
from neurotouch_hid.driver.control_socket import STREAM
from neurotouch_hid.driver.people import People
from neurotouch_hid.driver.reload import ProfileWatch
from neurotouch_hid.errors import DriverError, NeuroTouchError
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.mapping import State
from neurotouch_hid.runtime.command_queue import CommandName
from neurotouch_hid.runtime.session import Session
from neurotouch_hid.vocabulary import NAME_PATTERN

COMMANDS: Final = (
    "pause",
    "resume",
    "panic",
    "stop",
    "reload",
    "status",
    "use",
    "settings",
    "record",
)

SAID: Final = {
    "pause": "Paused: everything is released. Go on with: neurotouch resume",
    "resume": "Resumed: the next gesture counts.",
    "panic": "Stopped: everything is released until: neurotouch resume",
}
"""What the person is told of an order that has taken effect."""

_ALREADY: Final = {
    "pause": "Already paused. Go on with: neurotouch resume",
    "resume": "Already running.",
    "panic": "Already stopped by panic. Go on with: neurotouch resume",
}
"""What the person is told of an order that changes nothing."""

_BEGINS: Final[Mapping[State, str]] = {"paused": "pause", "running": "resume", "panic": "panic"}
"""The order that each state of the pipeline comes from: a pause during a panic leaves the panic."""

_WAIT_S: Final = 0.8 * REQUEST_S


class Commands:
    """Answers the questions within ``REQUEST_S``, or ``LOADING_S`` where a profile is to be loaded.

    Args:
        session: the running driver.
        profiles: what loads its profiles.
        facts: what else ``status`` tells, asked again each time.
        broadcast: hands out what the pipeline sees.
        end: ends the driver; a service has none, because systemd ends it.
        people: keeps the settings that people hand over to a service; the driver of one person
            reads that person's files instead.
        is_simulated: no sensor has seen what the pipeline sees.
    """

    def __init__(
        self,
        session: Session,
        profiles: ProfileWatch,
        facts: Mapping[str, Callable[[], str]],
        broadcast: Broadcast | None = None,
        end: Callable[[], object] | None = None,
        people: People | None = None,
        *,
        is_simulated: bool = False,
    ) -> None:
        self._session = session
        self._profiles = profiles
        self._facts = facts
        self._broadcast = broadcast
        self._end = end
        self._people = people
        self._is_simulated = is_simulated

    def answer(self, question: dict[str, Any], uid: int) -> Answer:
        """Returns the answer to a question of a user from the socket."""
        try:
            return {"ok": True, **self._obey(question, uid)}
        except NeuroTouchError as error:
            return {"ok": False, "error": error.message, "hint": error.hint}

    def _obey(self, question: dict[str, Any], uid: int) -> dict[str, Any]:
        match question["command"]:
            case "pause" | "resume" | "panic" as order:
                return self._submit(cast(CommandName, order))
            case "stop":
                return self._stop()
            case "reload" | "settings":
                return self._load(question, uid)
            case "use":
                return self._use(question.get("profile"))
            case "status":
                facts = {name: tell() for name, tell in self._facts.items()}
                return {"version": 1, **self._session.status(), **facts}
            case "record" if self._broadcast is not None:
                self._broadcast.require_place()
                return {
                    "source": self._facts["source"]() if "source" in self._facts else "",
                    "simulated": self._is_simulated,
                    "text": "Packets follow.",
                    STREAM: self._broadcast.serve,
                }
            case unknown:
                raise DriverError(
                    f"There is no command '{make_printable(unknown[:64])}'.",
                    hint=f"Commands: {', '.join(COMMANDS)}.",
                )

    def _submit(self, order: CommandName) -> dict[str, Any]:
        before = self._session.mapping.state
        done = self._session.submit(order).done
        if _is_done(done, _WAIT_S):
            after = done.result()
            said = _ALREADY if after == before else SAID
            return {"done": True, "text": said[_BEGINS[after]]}
        text = (
            f"No data from the source. The pad is released; '{order}' takes effect when "
            "data resumes."
        )
        return {"done": False, "text": text}

    def _stop(self) -> dict[str, Any]:
        if self._end is None:
            raise DriverError(
                "The system's service plays, and only an administrator can end it.",
                hint="Release everything: neurotouch panic. To end it: "
                "sudo systemctl stop neurotouch",
            )
        self._end()
        return {"text": "The driver has ended; the pad is neutral."}

    def _load(self, question: dict[str, Any], uid: int) -> dict[str, Any]:
        if question["command"] == "reload":
            return self._report(self._profiles.reload())
        if self._people is not None:
            self._people.keep(uid, question)
        return self._report(self._profiles.refresh())

    def _use(self, profile: object) -> dict[str, Any]:
        if not isinstance(profile, str):
            raise DriverError("The profile to use is missing.")
        if self._people is not None and not re.fullmatch(NAME_PATTERN, profile):
            # The service reads files that the asker may not, and an error quotes their lines.
            raise DriverError(
                "The service takes profiles by name only.",
                hint="Import it first: neurotouch profile import FILE",
            )
        return self._report(self._profiles.use(profile))

    def _report(self, done: Future[str]) -> dict[str, Any]:
        if not _is_done(done, LOADING_S):
            raise DriverError(
                f"The profile is still being loaded after {LOADING_S:g} s.",
                hint="See later which one is active: neurotouch status",
            )
        name = done.result()
        return {"done": True, "profile": name, "text": f"Profile '{name}' is now active."}


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
