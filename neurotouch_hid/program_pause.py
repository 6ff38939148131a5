"""A pause of the running driver that belongs to this process, as to ``neurotouch calibrate``."""

import socket
from contextlib import suppress

from neurotouch_hid.client import PATIENCE_S, Reply, get_text, open_stream, read_answer
from neurotouch_hid.errors import DriverError


class ProgramPause:
    """A pause of the nearest running driver, which ends with this process at the latest.

    Attributes:
        state: the driver's state now: ``panic`` if a panic came before; None while it has no data.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """

    def __init__(self) -> None:
        _, self._connection = open_stream("pause_while_connected")
        self._connection.settimeout(PATIENCE_S)
        try:
            self.state = self._read().get("state")
        except DriverError:
            self._connection.close()
            raise

    def end(self) -> str:
        """Ends it, and returns what the driver says of its state then; a second call must not be.

        Raises:
            DriverError: the driver has ended, or it does not answer.
        """
        with self._connection:
            with suppress(OSError):  # the driver has ended
                self._connection.shutdown(socket.SHUT_WR)
            return get_text(self._read())

    def _read(self) -> Reply:
        try:
            return read_answer(self._connection)
        except (OSError, ValueError):
            raise DriverError("The driver does not answer.") from None
