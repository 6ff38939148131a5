"""A source of 30 lines: any other source, seen in a mirror.

Install it with ``pip install .``; then ``neurotouch run --source mirrored:sim:push --device
memory``
(``memory`` needs no right to make a gamepad).
"""

from dataclasses import replace

from neurotouch_hid.messages import SENSOR_WIDTH_PX
from neurotouch_hid.source import open_source


class MirroredGel:
    """Mirrors the packets of another source: left and right are exchanged."""

    def __init__(self, rest, *, slice_us, seed):
        self._source = open_source(rest, slice_us=slice_us, seed=seed, speed="max")
        self.name = f"mirrored:{self._source.name}"
        self.rig = None  # the gel is found in the mirrored frames
        self.is_live = self._source.is_live
        self.is_simulated = self._source.is_simulated

    def __iter__(self):
        """Yields one packet after the other."""
        for packet in self._source:
            events = packet.events.copy()
            events["x"] = SENSOR_WIDTH_PX - 1 - events["x"]
            frames = tuple(replace(each, pixels=each.pixels[:, ::-1]) for each in packet.frames)
            yield replace(packet, events=events, frames=frames)

    def close(self):
        """Closes the other source."""
        self._source.close()
