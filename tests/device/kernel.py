"""Pipes in the place of /dev/uinput: what was asked of each node, and what was written to it."""

import errno
import os
import struct

from neurotouch_hid.device.outputs.uinput import UI_DEV_SETUP

EVENT_BYTES = 24


class FakeNode:
    """One opened descriptor: a pipe, and the ioctls that were made on it."""

    def __init__(self):
        self.reading, self.writing = os.pipe()
        os.set_blocking(self.reading, False)
        self.calls: list[tuple[int, int | bytes]] = []
        self.stamps: list[tuple[int, int]] = []  # of what was taken last: seconds, microseconds

    @property
    def name(self) -> str:
        """What the node was called when it was set up."""
        setups = [argument for request, argument in self.calls if request == UI_DEV_SETUP]
        return setups[0][8:88].rstrip(b"\0").decode()

    def take(self) -> str:
        """What was written since the last look, in hexadecimal, with all stamps 0."""
        try:
            data = os.read(self.reading, 2048 * EVENT_BYTES)
        except BlockingIOError:
            return ""
        self.stamps = [
            struct.unpack_from("@ll", data, at) for at in range(0, len(data), EVENT_BYTES)
        ]
        places = range(0, len(data), EVENT_BYTES)
        return "".join("00" * 16 + data[at + 16 : at + EVENT_BYTES].hex() for at in places)

    def vanish(self) -> None:
        """Refuse every write from now on, as a node does that the kernel has removed."""
        os.close(self.reading)
        self.reading = os.open(os.devnull, os.O_RDONLY)

    @property
    def is_closed(self) -> bool:
        try:
            os.fstat(self.writing)
        except OSError:
            return True
        return False


class Kernel:
    """Gives descriptors, takes ioctls.

    Attributes:
        nodes: the nodes in the order in which they were opened.
        refused: the number of a node, from 1, and the ioctl that fails on it.
    """

    def __init__(self):
        self.nodes: list[FakeNode] = []
        self.refused: tuple[int, int] | None = None

    def open(self) -> int:
        self.nodes.append(FakeNode())
        return self.nodes[-1].writing

    def ioctl(self, descriptor: int, request: int, argument: int | bytes) -> None:
        node = next(node for node in reversed(self.nodes) if node.writing == descriptor)
        if self.refused == (len(self.nodes), request):
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        node.calls.append((request, argument))

    def close(self) -> None:
        for node in self.nodes:
            os.close(node.reading)
