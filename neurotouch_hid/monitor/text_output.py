"""Text that is written during a game, and must not end it."""

from collections.abc import Callable
from typing import Protocol, TextIO

from neurotouch_hid.process.dead_output import silence


class Writable(Protocol):
    """Place to which a monitor writes."""

    def write(self, text: str, /) -> object:
        """Writes a text."""

    def flush(self) -> object:
        """Hands over what was written."""


class TextOutput:
    """A stream whose first failure is told; what comes later is dropped.

    Args:
        stream: a file, a pipe or a terminal.
        name: what the sentence calls it.
        announce: is told one sentence; from the thread that writes.

    Attributes:
        has_failed: whether something was dropped.
    """

    def __init__(self, stream: TextIO, name: str, announce: Callable[[str], object]) -> None:
        self.has_failed = False
        self._stream = stream
        self._name = name
        self._announce = announce

    def write(self, text: str, /) -> None:
        """Writes a text, or drops it."""
        try:
            self._stream.write(text)
        except OSError as error:
            self._fail(error)

    def flush(self) -> None:
        """Hands over what was written, or drops it."""
        try:
            self._stream.flush()
        except OSError as error:
            self._fail(error)

    def _fail(self, error: OSError) -> None:
        silence(self._stream)
        if not self.has_failed:
            self.has_failed = True
            self._announce(
                f"Warning: {self._name} cannot be written: {error.strerror}. "
                "The game goes on without it."
            )
