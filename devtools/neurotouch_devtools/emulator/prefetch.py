"""Reads a slow source ahead of time, in a thread, so that the camera never waits for it."""

import threading
from collections import deque
from collections.abc import Iterable, Iterator

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.messages import EventPacket

N_AHEAD = 200
"""Packets: 2 s in slices of 10 ms."""


class Prefetch(Closing):
    """An iterator over packets that yields None whenever the next one is not there yet.

    Args:
        packets: the source's; used by the thread only.
    """

    def __init__(self, packets: Iterable[EventPacket]) -> None:
        self._packets = packets
        self._ahead: deque[EventPacket] = deque()
        self._error: NeuroTouchError | None = None
        self._change = threading.Condition()
        self._closing = False
        self._thread = threading.Thread(target=self._pull, name="prefetch", daemon=True)
        self._thread.start()

    def __iter__(self) -> Iterator[EventPacket | None]:
        """Yields the packets.

        Raises:
            NeuroTouchError: the source has failed; its earlier packets come first.
        """
        while True:
            with self._change:
                packet = self._ahead.popleft() if self._ahead else None
                self._change.notify()
            if packet is None and not self._thread.is_alive() and not self._ahead:
                if self._error is not None:
                    raise self._error
                return
            yield packet

    def close(self) -> None:
        """Stops reading."""
        with self._change:
            self._closing = True
            self._change.notify()
        self._thread.join()

    def _pull(self) -> None:
        try:
            for packet in self._packets:
                with self._change:
                    self._change.wait_for(lambda: self._closing or len(self._ahead) < N_AHEAD)
                    if self._closing:
                        return
                    self._ahead.append(packet)
        except NeuroTouchError as error:
            self._error = error
