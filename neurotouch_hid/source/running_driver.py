"""Source of the packets that the running driver receives; the driver itself goes on unchanged."""

from collections.abc import Iterator

from neurotouch_hid.client import open_stream
from neurotouch_hid.closing import Closing
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording.wire import receive_packets
from neurotouch_hid.vocabulary import RUNNING_DRIVER


class RunningDriver(Closing):
    """Receives the driver's packets until it ends.

    Attributes:
        name: ``driver:``, and the driver's own source.
        rig: unknown.
        is_live: True.
        is_simulated: whether the driver's own source is.
        seed: seed of the driver's simulator; None if it has none.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """

    rig: Rig | None = None
    is_live = True

    def __init__(self) -> None:
        answer, self._line = open_stream("record")
        self.name = f"{RUNNING_DRIVER} {answer.get('source', '')}".strip()
        self.is_simulated = answer.get("simulated") is True
        seed = answer.get("seed")
        self.seed = seed if isinstance(seed, int) else None

    def __iter__(self) -> Iterator[EventPacket]:
        return receive_packets(self._line)

    def close(self) -> None:
        """Ends the connection."""
        self._line.close()
