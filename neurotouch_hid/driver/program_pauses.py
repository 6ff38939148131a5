"""Pauses that belong to programs, as to ``neurotouch calibrate``: each ends with its connection."""

import json
import socket
import threading
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import Final

from neurotouch_hid.client import REQUEST_S
from neurotouch_hid.errors import DriverError
from neurotouch_hid.runtime.command_queue import CommandName
from neurotouch_hid.runtime.pipeline_control import PipelineControl
from neurotouch_hid.vocabulary import PipelineState

MAX_PAUSES: Final = 4

_WAIT_S: Final = 0.8 * REQUEST_S

_SENTENCES: Final = {
    "running": "Resumed. The next gesture counts.",
    "paused": "Still paused. Go on with: neurotouch resume",
    "panic": "Stopped by panic. Go on with: neurotouch resume",
}
"""The sentences about the driver after a program's pause."""


class ProgramPauses:
    """Pauses the driver while at least one program wants it, and its connection is open.

    So the pause also ends with a program that was killed. A person's pause or panic meanwhile stays
    afterwards, and a person's ``resume`` ends it before.

    Args:
        control: takes the commands for the pipeline.
    """

    def __init__(self, control: PipelineControl) -> None:
        self._control = control
        self._lock = threading.Lock()
        self._count = 0

    def require_place(self) -> None:
        """Checks that one more program may pause the driver.

        Raises:
            DriverError: there are enough.
        """
        if self._count >= MAX_PAUSES:
            raise DriverError(f"Too many programs have paused the driver: {MAX_PAUSES}.")

    def serve(self, connection: socket.socket) -> None:
        """Pauses until the other end closes, or ends what it sends; in a thread of its own.

        A line with the state of the pipeline follows the start of the pause and its end.
        """
        try:
            _send(connection, self._change(1))
            connection.settimeout(None)
            while connection.recv(4096):
                pass
        finally:
            state = self._change(-1)
        _send(connection, state, self._describe(state))

    def _change(self, by: int) -> PipelineState | None:
        """Counts a program, and returns the state afterwards; None while no data comes."""
        with self._lock:
            self._count += by
            name: CommandName = "pause_for_program" if by > 0 else "end_program_pause"
            if by < 0 and self._count:
                return self._control.mapping.state
            try:
                done = self._control.submit(name).done
            except DriverError:  # too many wait: a pause stays then
                return None
        try:
            return done.result(_WAIT_S)
        except FutureTimeoutError:
            return None
        except DriverError:  # a panic came in between
            return "panic"

    def _describe(self, state: PipelineState | None) -> str:
        if state == "paused" and self._count:
            return "Still paused, until another program has ended too."
        if state is None:
            return "No data from the source. This pause ends when data resumes."
        return _SENTENCES[state]


def _send(connection: socket.socket, state: PipelineState | None, text: str = "") -> None:
    connection.sendall(json.dumps({"ok": True, "state": state, "text": text}).encode() + b"\n")
