"""Decides which frames are read out, and when."""

from collections import deque

from neurotouch_devtools.emulator import registers as reg
from neurotouch_devtools.emulator.readout import Readout, Region, read_out, readout_us
from neurotouch_devtools.emulator.registers import Registers
from neurotouch_hid.messages import Frame

_LEAST_INTERVAL = 0.75
"""The scene sets the times of its frames; a frame is left out if it comes much earlier than the
register of the frame interval permits."""
_NEVER_US = -(1 << 62)


class FrameReader:
    """Takes frames from the scene and makes readouts of them, one after the other.

    Args:
        registers: of the camera.

    Attributes:
        readouts: those on their way, oldest first.
        wanted: the next frame is read out also if they have been switched off again.
    """

    def __init__(self, registers: Registers) -> None:
        self._registers = registers
        self._last_us = _NEVER_US
        self._busy_until_us = _NEVER_US
        self.readouts: deque[Readout] = deque()
        self.wanted = False

    def hold(self, by_us: int) -> None:
        """Stops reading for this time: there is no room for the data."""
        for readout in self.readouts:
            readout.t_us[readout.next :] += by_us
        self._busy_until_us += by_us

    def begin(self, frames: deque[Frame], now_us: int, until_us: int) -> None:
        """Takes the frames whose readout begins before a moment.

        Args:
            frames: of the scene, oldest first; those that are taken are removed.
            now_us: scene time up to which everything has been sent.
            until_us: the moment, scene time.
        """
        registers = self._registers
        region = Region(*(registers[address] for address in reg.APS_REGION))
        columns_us = readout_us(region, registers[reg.APS_ORIENTATION])
        while frames and frames[0].exposure_begin_us - columns_us < until_us:
            frame = frames.popleft()
            exposed_us = frame.exposure_begin_us
            begin_us = max(exposed_us - columns_us, self._busy_until_us, now_us)
            least_us = _LEAST_INTERVAL * registers.frame_interval_us
            too_soon = begin_us > exposed_us or exposed_us - self._last_us < least_us
            if too_soon or not (registers[reg.APS_RUN] or self.wanted):
                continue
            self.wanted = False
            self._last_us = exposed_us
            self._busy_until_us = frame.exposure_end_us + columns_us + 1
            self.readouts.append(
                read_out(
                    frame,
                    region,
                    orientation=registers[reg.APS_ORIENTATION],
                    exposure_cycles=registers.adc_cycles(frame.exposure_end_us - exposed_us),
                    begin_us=begin_us,
                    global_shutter=bool(registers[reg.GLOBAL_SHUTTER]),
                    halved=registers[reg.CHIP_ID] in reg.HALVED,
                )
            )
