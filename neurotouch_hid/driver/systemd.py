"""The service manager that started the process, if one did: systemd's notify protocol."""

import os
import socket
import time
from collections.abc import Callable, MutableMapping
from contextlib import suppress
from typing import Final

_FIRST_DESCRIPTOR: Final = 3
"""The first descriptor that systemd hands over, sd_listen_fds(3)."""


class ServiceManager:
    """Reports the state of the service to systemd and takes its descriptors, if systemd is there.

    Args:
        environment: of the process; systemd's variables are taken out, so that no child process
            reports in our name.
        clock_s: host time.
    """

    def __init__(
        self,
        environment: MutableMapping[str, str] = os.environ,
        clock_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self._address = environment.pop("NOTIFY_SOCKET", "")
        self._clock_s = clock_s
        watched = environment.pop("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
        limit_us = environment.pop("WATCHDOG_USEC", "0")
        self._interval_s = int(limit_us) / 1e6 / 4 if watched else 0.0
        self._fed_s = -float("inf")
        self._descriptors = _take_descriptors(environment)

    def take_descriptor(self, name: str) -> int | None:
        """Returns a descriptor that was handed over under this name, each only once.

        None if none is left.

        The caller closes it.
        """
        for descriptor, given in self._descriptors.items():
            if given == name:
                del self._descriptors[descriptor]
                return descriptor
        return None

    def report_ready(self) -> None:
        """Reports that the pad is there."""
        self._tell("READY=1")

    def report_status(self, sentence: str) -> None:
        """Reports one line for ``systemctl status``."""
        self._tell(f"STATUS={sentence}")

    def report_alive(self) -> None:
        """Reports that the loop runs, at most four times in the watchdog's limit.

        Only the loop that does the work may call this: the watchdog is for hangs.
        """
        now_s = self._clock_s()
        if self._interval_s and now_s - self._fed_s >= self._interval_s:
            self._fed_s = now_s
            with suppress(OSError):  # systemd starts over, or is slow: the loop does not wait
                self._tell("WATCHDOG=1", socket.MSG_DONTWAIT)

    def report_stopping(self) -> None:
        """Reports that the service is about to end."""
        self._tell("STOPPING=1")

    def _tell(self, state: str, flags: int = 0) -> None:
        if not self._address:
            return
        # An address with @ is in the abstract namespace, whose names begin with a NUL.
        address = self._address.replace("@", "\0", 1)
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as connection:
            connection.sendto(state.encode(), flags, address)


def _take_descriptors(environment: MutableMapping[str, str]) -> dict[int, str]:
    """Returns the handed over descriptors with their names, closed in any child, in order."""
    pid = environment.pop("LISTEN_PID", "")
    count = environment.pop("LISTEN_FDS", "0")
    names = environment.pop("LISTEN_FDNAMES", "").split(":")
    if pid != str(os.getpid()):
        return {}
    descriptors = range(_FIRST_DESCRIPTOR, _FIRST_DESCRIPTOR + int(count))
    for descriptor in descriptors:
        os.set_inheritable(descriptor, False)
    return dict(zip(descriptors, names, strict=True))
