"""Orders to the line: other threads post them, the line takes them between two slices."""

from collections import deque
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Final, Literal

from neurotouch_hid.errors import DriverError
from neurotouch_hid.profile import Profile, UserSettings
from neurotouch_hid.profile.mapping import State

CommandName = Literal["pause", "resume", "toggle", "panic", "switch"]
"""``toggle`` pauses, or resumes from a pause; only ``resume`` ends a panic."""

CAPACITY: Final = 64
"""Letters that may wait; more come only while the line stands still."""


@dataclass(frozen=True, slots=True, eq=False)
class Command:
    """One order.

    Attributes:
        order: what to do.
        profile: what to go on with, for ``switch``.
        user: whose values hold then.
        done: whether gestures act, once it has been done; an order may leave that as it was.
    """

    order: CommandName
    profile: Profile | None = None
    user: UserSettings | None = None
    done: Future[State] = field(default_factory=Future)


class CommandQueue:
    """Holds letters until the line has time; neither side ever waits.

    ``append``, ``popleft`` and ``remove`` of a deque are atomic, so the line takes no lock.
    """

    def __init__(self) -> None:
        self._letters: deque[Command] = deque()

    def post(self, command: Command) -> Command:
        """Leaves a command. Panic throws away what waits before it, and always finds room.

        A switch stays: whoever posted it goes by the other profile already, and it ends no panic.

        Raises:
            DriverError: too many letters wait.
        """
        if command.order == "panic":
            for waiting in tuple(self._letters):
                if waiting.order != "switch":
                    with suppress(ValueError):  # the line has taken it just now
                        self._letters.remove(waiting)
                        waiting.done.set_exception(DriverError("A panic came in between."))
        elif len(self._letters) >= CAPACITY:
            raise DriverError("The source is silent and too many orders wait for its return.")
        self._letters.append(command)
        return command

    def take(self) -> Command | None:
        """The oldest command, or None."""
        try:
            return self._letters.popleft()
        except IndexError:
            return None
