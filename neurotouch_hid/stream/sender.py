"""The base class of all ways to send states."""

from abc import abstractmethod

from neurotouch_hid.closing import Closing
from neurotouch_hid.stream.reading import Reading


class Sender(Closing):
    """Sends states to other programs and never waits for them; a context manager."""

    name: str
    """Where the states go, for people."""

    @abstractmethod
    def send(self, reading: Reading) -> None:
        """Sends a state; where there is no room for it, it is lost."""
