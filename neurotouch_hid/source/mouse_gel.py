"""A simulated gel that a mouse presses: another process sends commands for the hand."""

import socket
import time
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.driver_state import SourceFacts
from neurotouch_hid.errors import SourceError
from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig
from neurotouch_hid.ipc import HAND, is_own_peer, listen_at
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.hand_model import GuidedHand, HandCommand, read_hand_command
from neurotouch_hid.source.simulator.simulator import Simulator

SLICE_US: Final = 4_000
"""Shorter than a camera's: input waits for half a slice on average, and there is time for it."""

LATE_S: Final = 0.1
"""A pipeline that is later than this skips the past: a delayed answer would feel wrong."""

LONGEST_BYTES: Final = 8 * 1024


class MouseSource(Closing):
    """A source of packets of a simulated gel that follows commands from a Unix socket.

    Every message is one ``HandCommand``; the newest counts. Unlike with a script, a slice is
    computed only when its time has come.

    Args:
        folder: the driver's own; the socket is made there.
        gel: the gel that is simulated.

    Raises:
        SourceError: no socket can be made there.
    """

    is_live = True
    is_simulated = True

    rig: Rig | None = None

    def __init__(self, folder: Path, *, gel: Gel = PAPER_GEL) -> None:
        self.name = "sim:mouse"
        self._path = folder / HAND
        try:
            self._listener = listen_at(self._path)
        except OSError as error:
            raise SourceError(
                f"Cannot open the socket of the mouse gel: {error.strerror} ({self._path})."
            ) from error
        self._peers: list[socket.socket] = []
        self._pending: deque[tuple[int, float]] = deque(maxlen=1000)
        self._late_s = 0.0
        self._lags_ms: deque[float] = deque(maxlen=250)
        hand, config = GuidedHand(self._ask, self._note, gel), SimulatorConfig().show(gel)
        self._simulator = Simulator(hand, config, seed=0, slice_us=SLICE_US)

    def __iter__(self) -> Iterator[EventPacket]:
        packets = iter(self._simulator)
        due_s = time.monotonic()
        while True:
            due_s += 1e-6 * SLICE_US
            wait_s = due_s - time.monotonic()
            self._late_s = max(-wait_s, 0.0)
            if wait_s > 0.0:
                time.sleep(wait_s)
            elif wait_s < -LATE_S:
                due_s = time.monotonic()
            yield next(packets)

    def watch(self, step: Step) -> None:
        """Measures, as a tap, the age of the command that the pad now shows."""
        now_ms = 1e3 * time.time()
        while self._pending and self._pending[0][0] <= step.packet.t_end_us:
            _, at_ms = self._pending.popleft()
            if 0.0 < now_ms - at_ms < 1e3:  # another machine's clock may differ
                self._lags_ms.append(now_ms - at_ms)

    def measure_lag(self) -> list[float] | None:
        """Returns median and 95 % of the time from a command to the pad, in ms.

        None before the first.
        """
        lags = sorted(self._lags_ms)
        if not lags:
            return None
        return [round(lags[len(lags) // 2], 1), round(lags[int(0.95 * len(lags))], 1)]

    def tell_facts(self) -> SourceFacts:
        """Returns its delays, for viewers."""
        return {"hand_ms": self.measure_lag(), "backlog_ms": self.measure_backlog()}

    def measure_backlog(self) -> float:
        """Returns the delay with which the newest slice began, in ms.

        Skipped time does not count.
        """
        return round(1e3 * self._late_s, 1)

    def close(self) -> None:
        """Takes the socket away."""
        for each in (self._listener, *self._peers):
            each.close()
        self._path.unlink(missing_ok=True)

    def _ask(self) -> HandCommand | None:
        """Returns the newest command that has arrived."""
        with suppress(OSError):
            peer, _ = self._listener.accept()
            peer.setblocking(False)
            if is_own_peer(peer):
                self._peers.append(peer)
            else:
                peer.close()
        newest = None
        for peer in self._peers.copy():
            newest = self._hear(peer) or newest
        return newest

    def _hear(self, peer: socket.socket) -> HandCommand | None:
        newest = None
        while True:
            try:
                text = peer.recv(LONGEST_BYTES)
            except BlockingIOError:
                return newest
            except OSError:
                text = b""
            if not text:
                self._peers.remove(peer)
                peer.close()
                return newest
            newest = read_hand_command(text) or newest

    def _note(self, command: HandCommand, t_us: int) -> None:
        self._pending.append((t_us, command.at_ms))
