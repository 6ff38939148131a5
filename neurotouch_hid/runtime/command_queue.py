"""Commands for the pipeline: other threads submit them, it applies them between two slices."""

from collections import deque
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Final, Literal

from neurotouch_hid.errors import DriverError
from neurotouch_hid.profile import Profile, UserSettings
from neurotouch_hid.vocabulary import PipelineState

CommandName = Literal[
    "pause", "pause_for_program", "end_program_pause", "resume", "toggle", "panic", "switch"
]
"""``toggle`` pauses, or ends any pause; ``end_program_pause`` ends only one that a program has
begun; only ``resume`` ends a panic."""

CAPACITY: Final = 64
"""Commands that may wait; more come only while the source is silent."""


@dataclass(frozen=True, slots=True, eq=False)
class Command:
    """One command.

    Attributes:
        name: of the command.
        profile: the new profile, for ``switch``.
        user: the person's values from then on, for ``switch``.
        done: gets the state of the mapping once the command has been applied; a command may leave
            the state as it was.
    """

    name: CommandName
    profile: Profile | None = None
    user: UserSettings | None = None
    done: Future[PipelineState] = field(default_factory=Future)


class CommandQueue:
    """Keeps commands until the pipeline takes them; neither side ever waits.

    ``append``, ``popleft`` and ``remove`` of a deque are atomic, so the pipeline needs no lock.
    """

    def __init__(self) -> None:
        self._waiting: deque[Command] = deque()

    def submit(self, command: Command) -> Command:
        """Adds a command. Panic drops the commands before it and always finds room.

        A switch stays: its sender already works with the other profile, and it does not
        end a panic.

        Raises:
            DriverError: too many commands wait.
        """
        if command.name == "panic":
            for earlier in tuple(self._waiting):
                if earlier.name != "switch":
                    with suppress(ValueError):  # the pipeline has taken it just now
                        self._waiting.remove(earlier)
                        earlier.done.set_exception(
                            DriverError(
                                "A panic came in between. Everything is released.",
                                hint="To continue: neurotouch resume",
                            )
                        )
        elif len(self._waiting) >= CAPACITY:
            raise DriverError("No data from the source, and too many commands wait for it.")
        self._waiting.append(command)
        return command

    def take(self) -> Command | None:
        """Returns the oldest command, or None."""
        try:
            return self._waiting.popleft()
        except IndexError:
            return None
