"""A strobed camera as a source: its dips become frames."""

from collections.abc import Iterator

from neurotouch_hid.closing import Closing
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source.protocol import Source
from neurotouch_hid.source.strobe.config import StrobeConfig
from neurotouch_hid.source.strobe.decoder import Strobe


class StrobedSource(Closing):
    """A source whose LED ring goes off at regular times.

    Args:
        source: its events.
        config: how the ring is switched.
    """

    def __init__(self, source: Source, config: StrobeConfig) -> None:
        self._source, self._config = source, config
        self.name, self.rig = source.name, source.rig
        self.is_live, self.is_simulated = source.is_live, source.is_simulated

    def __iter__(self) -> Iterator[EventPacket]:
        return map(Strobe(self._config).take, self._source)

    def close(self) -> None:
        """Closes the source."""
        self._source.close()
