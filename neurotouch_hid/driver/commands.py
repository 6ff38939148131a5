"""What the questions on the control socket mean to a running line."""

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import Any, Final, cast

from neurotouch_hid.client import LOADING_S, REQUEST_S, Answer
from neurotouch_hid.driver.broadcast import Broadcast
from neurotouch_hid.driver.control import STREAM
from neurotouch_hid.driver.reload import ProfileWatch
from neurotouch_hid.errors import DriverError, NeuroTouchError
from neurotouch_hid.profile.faults import make_printable
from neurotouch_hid.profile.mapping import State
from neurotouch_hid.runtime.command_queue import CommandName
from neurotouch_hid.runtime.session import Session

COMMANDS: Final = ("pause", "resume", "panic", "reload", "status", "use", "record")

SAID: Final = {
    "pause": "Paused: everything is released. Go on with: neurotouch resume",
    "resume": "Resumed: the next gesture counts.",
    "panic": "Stopped: everything is released until: neurotouch resume",
}
"""What the person is told of an order that has taken effect."""

_BEGINS: Final[Mapping[State, str]] = {"paused": "pause", "running": "resume", "panic": "panic"}
"""The order that each state of the line comes from: a pause during a panic leaves the panic."""

_WAIT_S: Final = 0.8 * REQUEST_S


class Commands:
    """Answers the questions within ``REQUEST_S``, or ``LOADING_S`` where a profile is to be loaded.

    Args:
        session: the running line.
        profiles: what loads its profiles.
        facts: what else ``status`` tells, asked again each time.
        broadcast: hands out what the line sees.
    """

    def __init__(
        self,
        session: Session,
        profiles: ProfileWatch,
        facts: Mapping[str, Callable[[], str]],
        broadcast: Broadcast | None = None,
    ) -> None:
        self._session = session
        self._profiles = profiles
        self._facts = facts
        self._broadcast = broadcast

    def answer(self, question: dict[str, Any]) -> Answer:
        """The answer to a question from the socket."""
        try:
            return {"ok": True, **self._obey(question)}
        except NeuroTouchError as error:
            return {"ok": False, "error": error.message, "hint": error.hint}

    def _obey(self, question: dict[str, Any]) -> dict[str, Any]:
        match question["command"]:
            case "pause" | "resume" | "panic" as order:
                done = self._session.submit(cast(CommandName, order)).done
                if _is_done(done, _WAIT_S):
                    return {"done": True, "text": SAID[_BEGINS[done.result()]]}
                text = (
                    f"No data from the source. The pad is released; '{order}' takes effect when "
                    "data resumes."
                )
                return {"done": False, "text": text}
            case "reload":
                return self._report(self._profiles.reload())
            case "use" if isinstance(question.get("profile"), str):
                return self._report(self._profiles.use(question["profile"]))
            case "use":
                raise DriverError("The profile to use is missing.")
            case "status":
                facts = {name: tell() for name, tell in self._facts.items()}
                return {"version": 1, **self._session.status(), **facts}
            case "record" if self._broadcast is not None:
                self._broadcast.require_place()
                return {
                    "source": self._facts["source"]() if "source" in self._facts else "",
                    "text": "Packets follow.",
                    STREAM: self._broadcast.serve,
                }
            case unknown:
                raise DriverError(
                    f"There is no command '{make_printable(unknown[:64])}'.",
                    hint=f"Commands: {', '.join(COMMANDS)}.",
                )

    def _report(self, done: Future[str]) -> dict[str, Any]:
        if not _is_done(done, LOADING_S):
            raise DriverError(
                f"The profile is still being loaded after {LOADING_S:g} s.",
                hint="See later which one is active: neurotouch status",
            )
        return {"done": True, "text": f"Profile '{done.result()}' is now active."}


def _is_done(done: Future[Any], wait_s: float) -> bool:
    """True once it is done, false if that takes longer.

    Raises:
        NeuroTouchError: it has failed.
    """
    try:
        done.result(wait_s)
    except FutureTimeoutError:
        return False
    return True
