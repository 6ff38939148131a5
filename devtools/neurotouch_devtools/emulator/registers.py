"""The camera's register file, with its values after power-up.

Names and values are those of the published FPGA sources and of libcaer's ``devices/davis.h``.
"""

from enum import IntEnum

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX


class Module(IntEnum):
    """Groups of registers; the first half of an address."""

    MUX = 0
    DVS = 1
    APS = 2
    IMU = 3
    EXTERNAL_INPUT = 4
    BIAS = 5
    SYSTEM = 6
    USB = 9


MUX_RUN = (Module.MUX, 0)
TIMESTAMP_RUN = (Module.MUX, 1)
TIMESTAMP_RESET = (Module.MUX, 2)
CHIP_RUN = (Module.MUX, 3)
DROP_DVS_ON_STALL = (Module.MUX, 5)
MUX_DVS_DROPPED = (Module.MUX, 83)
DVS_ORIENTATION = (Module.DVS, 2)
DVS_RUN = (Module.DVS, 3)
DVS_REGION = tuple((Module.DVS, parameter) for parameter in (41, 42, 43, 44))
"""The same as APS_REGION."""
DVS_DROPPED = (Module.DVS, 85)
DVS_FILTERED_PIXELS = (Module.DVS, 87)
APS_ORIENTATION = (Module.APS, 2)
APS_RUN = (Module.APS, 4)
GLOBAL_SHUTTER = (Module.APS, 7)
APS_REGION = tuple((Module.APS, parameter) for parameter in (8, 9, 10, 11))
"""First column, first row, last column, last row."""
EXPOSURE = (Module.APS, 12)
FRAME_INTERVAL = (Module.APS, 13)
LOGIC_VERSION = (Module.SYSTEM, 0)
CHIP_ID = (Module.SYSTEM, 1)
ADC_CLOCK = (Module.SYSTEM, 4)
USB_CLOCK = (Module.SYSTEM, 5)
CLOCK_DEVIATION = (Module.SYSTEM, 6)
LOGIC_PATCH = (Module.SYSTEM, 7)
USB_RUN = (Module.USB, 0)
EARLY_PACKET_DELAY = (Module.USB, 1)

N_PIXEL_FILTERS = 8
DAVIS346B = 5

_SIZES = dict.fromkeys((0, 1, 2), (240, 180))
"""Width and height of the sensors that are not as large as a DAVIS-346, by their numbers."""

HALVED = frozenset(_SIZES)
"""Sensors whose ADC uses half of its range."""

_MHZ = {"logic": 120, "adc": 30, "usb": 80}
_DEVIATION = 1008  # thousandths; the clocks that all drivers accept, a real unit's are not known


def find_size(chip: int) -> tuple[int, int]:
    """Returns width and height of a sensor's picture, by its number."""
    return _SIZES.get(chip, (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX))


class Registers:
    """32-bit values by module and parameter.

    A missing register reads as 0 and ignores writes; a read-only one keeps its value.

    Args:
        orientation: of events and frames: bit 2 swaps the axes, bits 1 and 0 flip the column and
            the row counter of frames (the FPGA has already flipped the events).
        colour: the colour filter, 0 for none.
        logic: version and patch of the FPGA's logic.
        chip: the chip's identifier.

    Attributes:
        full_region: first column, first row, last column, last row of its picture.
        no_pixel: column and row of a pixel filter that is off.
    """

    def __init__(
        self,
        *,
        orientation: int = 4,
        colour: int = 0,
        logic: tuple[int, int] = (18, 1),
        chip: int = DAVIS346B,
    ) -> None:
        size = width, height = find_size(chip)
        self.full_region = [0, 0, width - 1, height - 1]
        self.no_pixel = size
        # The chip counts turned by 90 degrees if bit 2 is set.
        columns, rows = size[::-1] if orientation & 0b100 else size
        dvs, aps = Module.DVS, Module.APS
        self._fixed: dict[tuple[int, int], int] = {
            (Module.MUX, 80): 1,
            (dvs, 0): columns,
            (dvs, 1): rows,
            DVS_ORIENTATION: orientation,
            **{(dvs, parameter): 1 for parameter in (10, 30, 40, 50, 60, 80)},
            (aps, 0): columns,
            (aps, 1): rows,
            APS_ORIENTATION: orientation,
            (aps, 3): colour,
            (aps, 6): 1,
            (Module.IMU, 0): 1,
            (Module.IMU, 1): 6,
            (Module.EXTERNAL_INPUT, 10): 1,
            LOGIC_VERSION: logic[0],
            CHIP_ID: chip,
            (Module.SYSTEM, 2): 1,
            (Module.SYSTEM, 3): _MHZ["logic"],
            ADC_CLOCK: _MHZ["adc"],
            USB_CLOCK: _MHZ["usb"],
            CLOCK_DEVIATION: _DEVIATION,
            LOGIC_PATCH: logic[1],
        }
        # Counters of 64 bits, high word first; the camera writes them, not the host.
        for module, first in (
            (Module.MUX, 81),
            (Module.MUX, 83),
            *((dvs, p) for p in range(81, 93, 2)),
        ):
            self._fixed[module, first] = self._fixed[module, first + 1] = 0
        self._values: dict[tuple[int, int], int] = {}
        self.power_up()

    def power_up(self) -> None:
        """Resets all registers to their values after power-up."""
        self._values = {
            **dict(zip(DVS_REGION, self.full_region, strict=True)),
            **dict(zip(APS_REGION, self.full_region, strict=True)),
            **{(Module.DVS, 12 + 2 * k): self.no_pixel[0] for k in range(N_PIXEL_FILTERS)},
            **{(Module.DVS, 11 + 2 * k): self.no_pixel[1] for k in range(N_PIXEL_FILTERS)},
            (Module.APS, 5): 1,
            GLOBAL_SHUTTER: 1,
            EXPOSURE: self.adc_cycles(4000),
            FRAME_INTERVAL: self.adc_cycles(50_000),
            USB_RUN: 1,
            EARLY_PACKET_DELAY: round(1000 * self._mhz(USB_CLOCK)),
        }

    def __getitem__(self, address: tuple[int, int]) -> int:
        if address in self._fixed:
            return self._fixed[address]
        return self._values.get(address, 0)

    def __setitem__(self, address: tuple[int, int], value: int) -> None:
        if address not in self._fixed:
            self._values[address] = value & 0xFFFFFFFF

    def count(self, address: tuple[int, int], n: int) -> None:
        """Adds to a counter, given by the address of its high word."""
        module, parameter = address
        low = (module, parameter + 1)
        total = (self._fixed[address] << 32 | self._fixed[low]) + n
        self._fixed[address], self._fixed[low] = total >> 32, total & 0xFFFFFFFF

    def adc_cycles(self, time_us: int) -> int:
        """Returns a time in cycles of the ADC's clock, the unit of exposure and frame interval."""
        return round(time_us * self._mhz(ADC_CLOCK))

    @property
    def early_packet_delay_us(self) -> float:
        """Time for which data may wait for a full packet."""
        return self[EARLY_PACKET_DELAY] / self._mhz(USB_CLOCK)

    @property
    def frame_interval_us(self) -> float:
        """The least time from one frame's start to the next."""
        return self[FRAME_INTERVAL] / self._mhz(ADC_CLOCK)

    @property
    def streams(self) -> bool:
        """True if data passes to USB."""
        return bool(self[MUX_RUN] and self[USB_RUN] and self[CHIP_RUN])

    def _mhz(self, clock: tuple[int, int]) -> float:
        return self._fixed[clock] * self._fixed[CLOCK_DEVIATION] / 1000
