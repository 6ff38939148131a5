"""The camera's registers, requests and biases by name.

Sources: libcaer 3.3 (``davis.h``, ``davis.c``, ``usb_utils.h``), neuromorphic-drivers
0.16 (``inivation_davis346.rs``) and the published FPGA logic (VHDL). Names are the vendor's.
"""

from dataclasses import dataclass
from typing import Final, NamedTuple

VENDOR_ID: Final = 0x152A
PRODUCT_ID: Final = 0x841A  # all DAVIS with this USB chip; SYSINFO says which one it is
FIRMWARE: Final = 6  # low byte of bcdDevice, at least
LOGIC: Final = 18
LOGIC_PATCH: Final = 1  # at least
CHIP: Final = 5  # the usual sensor, see ``chips``

INTERFACE: Final = 0
ENDPOINT: Final = 0x82  # bulk IN
REQUEST_IN: Final = 0xC0  # vendor, device
REQUEST_OUT: Final = 0x40
REQUEST_REGISTER: Final = 0xBF
REQUEST_REGISTERS: Final = 0xC2  # many writes in one
REQUEST_FLUSH: Final = 0xC6  # throws stale stream data away; a camera may refuse it


class Register(NamedTuple):
    """The address of a value of 32 bits. One that does not exist reads as 0 and ignores writing."""

    module: int
    parameter: int


MUX_RUN: Final = Register(0, 0)
MUX_TIMESTAMP_RUN: Final = Register(0, 1)
MUX_TIMESTAMP_RESET: Final = Register(0, 2)
MUX_RUN_CHIP: Final = Register(0, 3)
MUX_DROP_EXTINPUT: Final = Register(0, 4)
MUX_DROP_DVS: Final = Register(0, 5)
MUX_HAS_STATISTICS: Final = Register(0, 80)
MUX_DROPPED_DVS: Final = Register(0, 84)  # the low word; 83 is the high one

DVS_COLUMNS: Final = Register(1, 0)
DVS_ROWS: Final = Register(1, 1)
DVS_ORIENTATION: Final = Register(1, 2)
DVS_RUN: Final = Register(1, 3)
DVS_WAIT: Final = Register(1, 4)
DVS_EXTERNAL_AER: Final = Register(1, 5)
DVS_HAS_PIXEL_FILTER: Final = Register(1, 10)
DVS_HAS_ACTIVITY_FILTER: Final = Register(1, 30)
DVS_ACTIVITY_FILTER: Final = Register(1, 31)
DVS_ACTIVITY_TIME: Final = Register(1, 32)
DVS_REFRACTORY_FILTER: Final = Register(1, 33)
DVS_REFRACTORY_TIME: Final = Register(1, 34)
DVS_HAS_ROI_FILTER: Final = Register(1, 40)
DVS_ROI: Final = tuple(Register(1, 41 + k) for k in range(4))  # columns and rows, begin then end
DVS_HAS_SKIP_FILTER: Final = Register(1, 50)
DVS_SKIP_FILTER: Final = Register(1, 51)
DVS_HAS_POLARITY_FILTER: Final = Register(1, 60)
DVS_POLARITY_FLATTEN: Final = Register(1, 61)
DVS_POLARITY_SUPPRESS: Final = Register(1, 62)
DVS_HAS_STATISTICS: Final = Register(1, 80)
DVS_DROPPED: Final = Register(1, 86)

APS_COLUMNS: Final = Register(2, 0)
APS_ROWS: Final = Register(2, 1)
APS_ORIENTATION: Final = Register(2, 2)
APS_COLOR: Final = Register(2, 3)
APS_RUN: Final = Register(2, 4)
APS_WAIT: Final = Register(2, 5)
APS_HAS_GLOBAL_SHUTTER: Final = Register(2, 6)
APS_GLOBAL_SHUTTER: Final = Register(2, 7)
APS_ROI: Final = tuple(Register(2, 8 + k) for k in range(4))
APS_EXPOSURE: Final = Register(2, 12)  # cycles of the ADC clock, as the next one
APS_FRAME_INTERVAL: Final = Register(2, 13)

IMU_RUNS: Final = (Register(3, 2), Register(3, 3), Register(3, 4))
EXTINPUT_RUN: Final = Register(4, 0)
EXTINPUT_HAS_GENERATOR: Final = Register(4, 10)
EXTINPUT_RUN_GENERATOR: Final = Register(4, 11)

CHIP_GLOBAL_SHUTTER: Final = Register(5, 142)

SYSINFO_LOGIC: Final = Register(6, 0)
SYSINFO_CHIP: Final = Register(6, 1)
SYSINFO_ADC_MHZ: Final = Register(6, 4)
SYSINFO_USB_MHZ: Final = Register(6, 5)
SYSINFO_DEVIATION: Final = Register(6, 6)  # what clocks really are: register × this / 1000
SYSINFO_PATCH: Final = Register(6, 7)

USB_RUN: Final = Register(9, 0)
USB_EARLY_PACKET_DELAY: Final = Register(9, 1)  # cycles of the USB clock

ORIENTATION_SWAP: Final = 4  # bits of the orientation registers
ORIENTATION_FLIP_COLUMNS: Final = 2
ORIENTATION_FLIP_ROWS: Final = 1

FILTER_UNIT_US: Final = 250
FILTER_TIME_MAX: Final = 0xFFF
N_FILTERED_PIXELS: Final = 8


def pixel_filter(k: int) -> tuple[Register, Register]:
    """Returns row and column of the hot pixel number ``k`` that the camera silences, 0 to 7."""
    return Register(1, 11 + 2 * k), Register(1, 12 + 2 * k)


class Vdac(NamedTuple):
    """A bias that is a voltage (0-63) with a drive current (0-7)."""

    voltage: int
    current: int

    @property
    def word(self) -> int:
        """The value of its register."""
        return self.current << 6 | self.voltage


class CoarseFine(NamedTuple):
    """A bias that is a current: about COARSE_PA[coarse] × fine / 255, coarse 0-7, fine 0-255."""

    coarse: int
    fine: int


COARSE_PA: Final = (11, 94, 756, 6_054, 48_437, 387_500, 3_100_000, 24_800_000)


@dataclass(frozen=True, slots=True)
class Current:
    """The address of a current bias, and the low bits that select what it drives."""

    address: int
    kind: int

    def word(self, value: CoarseFine) -> int:
        """Returns the value of its register."""
        return value.coarse << 12 | value.fine << 4 | self.kind


_N, _P, _N_OFF = 0xF, 0xD, 0xE  # enabled bit, sex, type, current level

CURRENTS: Final = {
    "LocalBufBn": Current(8, _N),
    "PadFollBn": Current(9, _N_OFF),
    "DiffBn": Current(10, _N),
    "OnBn": Current(11, _N),
    "OffBn": Current(12, _N),
    "PixInvBn": Current(13, _N),
    "PrBp": Current(14, _P),
    "PrSFBp": Current(15, _P),
    "RefrBp": Current(16, _P),
    "ReadoutBufBp": Current(17, _P),
    "ApsROSFBn": Current(18, _N),
    "AdcCompBp": Current(19, _P),
    "ColSelLowBn": Current(20, _N),
    "DACBufBp": Current(21, _P),
    "LcolTimeoutBn": Current(22, _N),
    "AEPdBn": Current(23, _N),
    "AEPuXBp": Current(24, _P),
    "AEPuYBp": Current(25, _P),
    "IFRefrBn": Current(26, _N),
    "IFThrBn": Current(27, _N),
    "BiasBuffer": Current(34, _N),
}
"""The biases that are currents, by the vendor's names."""

FIXED_CURRENTS: Final = {
    "LocalBufBn": CoarseFine(5, 164),
    "PadFollBn": CoarseFine(7, 215),
    "PixInvBn": CoarseFine(6, 144),
    "ReadoutBufBp": CoarseFine(6, 20),
    "ApsROSFBn": CoarseFine(6, 219),
    "AdcCompBp": CoarseFine(5, 20),
    "ColSelLowBn": CoarseFine(0, 1),
    "DACBufBp": CoarseFine(6, 60),
    "LcolTimeoutBn": CoarseFine(5, 49),
    "AEPdBn": CoarseFine(6, 91),
    "AEPuXBp": CoarseFine(4, 80),
    "AEPuYBp": CoarseFine(7, 152),
    "IFRefrBn": CoarseFine(5, 255),
    "IFThrBn": CoarseFine(5, 255),
    "BiasBuffer": CoarseFine(5, 254),
}
"""Never tuned to the light: buffers, readout and the unused calibration neuron."""

CHIP_SETTINGS: Final = {
    **{Register(5, 128 + k): 0 for k in range(8)},  # digital, analog and bias multiplexers
    Register(5, 136): 1,  # ResetCalibNeuron
    Register(5, 137): 0,  # TypeNCalibNeuron
    Register(5, 138): 1,  # ResetTestPixel
    Register(5, 140): 0,  # AERnArow
    Register(5, 141): 0,  # UseAOut
}
"""Settings of every chip, with the values that all public drivers write."""

_SHIFTED_SOURCE: Final = 33 << 10 | 1 << 4  # regulator 33, reference 1

FIXED_CHIP: Final = {
    Register(5, 0): Vdac(27, 6).word,  # ApsOverflowLevel
    Register(5, 1): Vdac(21, 6).word,  # ApsCas
    Register(5, 2): Vdac(32, 7).word,  # AdcRefHigh
    Register(5, 3): Vdac(1, 7).word,  # AdcRefLow
    Register(5, 4): Vdac(21, 7).word,  # AdcTestVoltage
    Register(5, 35): _SHIFTED_SOURCE,  # SSP
    Register(5, 36): _SHIFTED_SOURCE,  # SSN
    Register(5, 143): 1,  # SelectGrayCounter
    Register(5, 144): 0,  # TestADC
}
"""Voltages and settings of the DAVIS346 with the values that all public drivers write."""

_N_CASCODE: Final = 0xB

CURRENTS_240: Final = {
    "DiffBn": Current(0, _N),
    "OnBn": Current(1, _N),
    "OffBn": Current(2, _N),
    "ApsCasEpc": Current(3, _N_CASCODE),
    "DiffCasBnc": Current(4, _N_CASCODE),
    "ApsROSFBn": Current(5, _N),
    "LocalBufBn": Current(6, _N),
    "PixInvBn": Current(7, _N),
    "PrBp": Current(8, _P),
    "PrSFBp": Current(9, _P),
    "RefrBp": Current(10, _P),
    "AEPdBn": Current(11, _N),
    "LcolTimeoutBn": Current(12, _N),
    "AEPuXBp": Current(13, _P),
    "AEPuYBp": Current(14, _P),
    "IFThrBn": Current(15, _N),
    "IFRefrBn": Current(16, _N),
    "PadFollBn": Current(17, _N),
    "ApsOverflowLevelBn": Current(18, _N),
    "BiasBuffer": Current(19, _N),
}
"""The same of the DAVIS240, whose bias generator is an older one [libcaer ``davis.h``]."""

FIXED_CURRENTS_240: Final = {
    "ApsCasEpc": CoarseFine(5, 185),
    "DiffCasBnc": CoarseFine(5, 115),
    "ApsROSFBn": CoarseFine(6, 219),
    "LocalBufBn": CoarseFine(5, 164),
    "PixInvBn": CoarseFine(6, 144),
    "AEPdBn": CoarseFine(6, 91),
    "LcolTimeoutBn": CoarseFine(5, 49),
    "AEPuXBp": CoarseFine(4, 80),
    "AEPuYBp": CoarseFine(7, 152),
    "IFThrBn": CoarseFine(5, 255),
    "IFRefrBn": CoarseFine(5, 255),
    "PadFollBn": CoarseFine(7, 215),
    "ApsOverflowLevelBn": CoarseFine(6, 253),
    "BiasBuffer": CoarseFine(5, 254),
}

FIXED_CHIP_240: Final = {
    Register(5, 20): _SHIFTED_SOURCE,  # SSP
    Register(5, 21): _SHIFTED_SOURCE,  # SSN
    Register(5, 139): 0,  # SpecialPixelControl
}
"""Voltages and settings of the DAVIS240 [libcaer ``davis_common.h``]."""
