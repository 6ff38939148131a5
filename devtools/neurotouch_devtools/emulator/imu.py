"""The words of the motion sensor of a camera that lies still; drivers switch it on by default."""

from neurotouch_devtools.emulator import registers as reg
from neurotouch_devtools.emulator.registers import Registers

START, END = 5, 7
BYTE_CODE, SETUP_CODE = 0x5000, 0x5300

_SAMPLE_US = 1000
"""The sensor's own rate, which register 3:5 divides."""
_ONE_G = 0x4000
"""At the finest scale; each step halves it."""
_25_DEGREES = (25 - 35) * 340


class Imu:
    """Makes the words of each sample that is due.

    Args:
        registers: of the camera.
    """

    def __init__(self, registers: Registers) -> None:
        self._registers = registers
        self._next_us = 0

    def sample(self, t_us: int) -> list[int]:
        """Returns the words of the sample that is due at a camera time, or none."""
        accel, gyro, temperature = (bool(self._registers[reg.Module.IMU, p]) for p in (2, 3, 4))
        if not (accel or gyro or temperature):
            return []
        period_us = _SAMPLE_US * (1 + self._registers[reg.Module.IMU, 5])
        if self._next_us - period_us <= t_us < self._next_us:
            return []
        self._next_us = t_us - t_us % period_us + period_us
        accel_scale, gyro_scale = (self._registers[reg.Module.IMU, p] & 3 for p in (7, 10))
        setup = accel << 7 | gyro << 6 | temperature << 5 | accel_scale << 2 | gyro_scale
        values = [0, 0, _ONE_G >> accel_scale] if accel else []
        values += [_25_DEGREES] if temperature else []
        values += [0, 0, 0] if gyro else []
        data = b"".join((value & 0xFFFF).to_bytes(2, "big") for value in values)
        return [START, SETUP_CODE | setup, *(BYTE_CODE | byte for byte in data), END]
