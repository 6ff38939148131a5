"""The event filters of the camera's logic that a driver may rely on: region and single pixels."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_devtools.emulator import registers as reg
from neurotouch_devtools.emulator.registers import Registers


class EventFilter:
    """Removes the events that the camera does not send, in the order of its logic.

    Args:
        registers: contain the limits, in image pixels, and the counters of lost events.
    """

    def __init__(self, registers: Registers) -> None:
        self._registers = registers

    def keep(self, events: NDArray[np.void]) -> NDArray[np.void]:
        """Returns the events that pass: (n,) EVENT_DTYPE."""
        registers = self._registers
        x, y = events["x"], events["y"]
        limits = [registers[address] for address in reg.DVS_REGION]
        if limits != registers.full_region:
            left, top, right, bottom = limits
            events = events[(x >= left) & (x <= right) & (y >= top) & (y <= bottom)]
        silenced = [
            (registers[reg.Module.DVS, 12 + 2 * k], registers[reg.Module.DVS, 11 + 2 * k])
            for k in range(reg.N_PIXEL_FILTERS)
        ]
        for column, row in set(silenced) - {registers.no_pixel}:
            passes = (events["x"] != column) | (events["y"] != row)
            registers.count(reg.DVS_FILTERED_PIXELS, int(len(events) - passes.sum()))
            events = events[passes]
        return events
