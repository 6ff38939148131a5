"""One open camera: identifies, configures, starts and stops it."""

import logging
import struct
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.davis import registers as r
from neurotouch_hid.source.davis.chips import FILTERS, KNOWN, NAMES, UPDATE_PAGE, Chip
from neurotouch_hid.source.davis.config import DavisConfig, Roi
from neurotouch_hid.source.davis.enumeration import SUPER_SPEED_MBIT_S, CameraInfo
from neurotouch_hid.source.davis.kernels.decode import AddressLayout
from neurotouch_hid.source.davis.registers import Register
from neurotouch_hid.source.davis.transport import Receive, Transport
from neurotouch_hid.source.davis.usb import Usb

SILENCE_S: Final = 0.1
"""Until a camera that was switched off sends nothing (neuromorphic-drivers, dv-processing)."""
SETTLE_S: Final = 0.2
"""Until the bias generator is stable (libcaer, neuromorphic-drivers)."""
READY_S: Final = 0.05
"""From the stream's start to the first events (libcaer)."""

IDLE_DELAY_US: Final = 1_000
"""How long data may wait for a full packet while nothing happens: what cameras power up with."""

DESCRIBING: Final = (
    *("SYSINFO_LOGIC", "SYSINFO_PATCH", "SYSINFO_CHIP", "SYSINFO_ADC_MHZ", "SYSINFO_USB_MHZ"),
    *("SYSINFO_DEVIATION", "DVS_COLUMNS", "DVS_ROWS", "DVS_ORIENTATION", "APS_ORIENTATION"),
    *("APS_COLOR", "APS_HAS_GLOBAL_SHUTTER", "DVS_HAS_PIXEL_FILTER", "DVS_HAS_ACTIVITY_FILTER"),
    *("DVS_HAS_ROI_FILTER", "DVS_HAS_SKIP_FILTER", "DVS_HAS_POLARITY_FILTER"),
    *("DVS_HAS_STATISTICS", "MUX_HAS_STATISTICS", "EXTINPUT_HAS_GENERATOR"),
)
"""Names of the registers that this driver reads to learn which camera it plays."""

_BOTH_REFUSE: Final = "libcaer and dv-processing refuse it, too."
_BOTH, _LIBCAER = "libcaer and dv-processing play", "libcaer plays"
_OTHERS_PLAY: Final = {3: _LIBCAER, 6: _BOTH, 7: _BOTH, 8: _LIBCAER}
"""Which public drivers play the sensors that this one does not, by their numbers."""

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class CameraVersions:
    """A camera's own description.

    Attributes:
        firmware: version of the firmware in the USB chip.
        logic: version of the FPGA's logic.
        logic_patch: its patch.
        chip_id: number of the sensor.
        chip: its name.
        color: the colour filter, 0 for a monochrome sensor.
    """

    firmware: int
    logic: int
    logic_patch: int
    chip_id: int
    chip: str
    color: int

    @property
    def is_usual(self) -> bool:
        """True for the sensor and the firmware that this driver was made for, in any colour."""
        return self.chip_id == r.CHIP and self.firmware == r.FIRMWARE

    def __str__(self) -> str:
        chip = KNOWN.get(self.chip_id)
        size = "" if chip is None else f", {chip.width_px}×{chip.height_px} pixels"
        colour = FILTERS.get(self.color, f"colour, an unknown filter, number {self.color}")
        return (
            f"{self.chip}{size}, {colour}, firmware {self.firmware}, logic {self.logic} patch "
            f"{self.logic_patch}"
        )


def identify(info: CameraInfo) -> CameraVersions:
    """Returns a camera's own description.

    It is opened for a moment and nothing is changed in it.

    Raises:
        CameraBusyError: another program has it.
        CameraError: it cannot be opened or does not answer.
    """
    transport = Usb().open(info)
    try:
        return Camera(info, transport).identify()
    finally:
        transport.close()


def read_registers(info: CameraInfo) -> dict[str, int]:
    """Returns the values of the registers that a camera describes itself with, by their names.

    They are those that this driver reads before it plays. The camera is opened for a moment and
    nothing is changed in it.

    Raises:
        CameraBusyError: another program has it.
        CameraError: it cannot be opened or does not answer.
    """
    transport = Usb().open(info)
    try:
        camera = Camera(info, transport)
        return {name: camera.read(getattr(r, name)) for name in DESCRIBING}
    finally:
        transport.close()


class Camera:
    """A DAVIS behind a transport.

    Args:
        info: which one.
        transport: its USB.
        sleep_s: how to wait.

    Attributes:
        info: which one.
        transport: its USB.
        chip: its sensor; set by ``check``, as the next two.
        layout: maps its addresses to the picture.
        is_colour: its pixels have colour filters.
    """

    def __init__(
        self,
        info: CameraInfo,
        transport: Transport,
        sleep_s: Callable[[float], None] = time.sleep,
    ) -> None:
        self.info = info
        self._sleep_s = sleep_s
        self.transport = transport
        self.chip: Chip = KNOWN[r.CHIP]
        self.layout = AddressLayout()
        self.is_colour = False
        self._usb_mhz = 0.0
        self._dropped: dict[Register, int] = {}

    def identify(self) -> CameraVersions:
        """Returns its own description.

        Raises:
            CameraError: it does not answer.
        """
        logic, patch, chip_id = map(self.read, (r.SYSINFO_LOGIC, r.SYSINFO_PATCH, r.SYSINFO_CHIP))
        chip = NAMES.get(chip_id, f"an unknown chip, number {chip_id}")
        color = self.read(r.APS_COLOR)
        return CameraVersions(self.info.firmware, logic, patch, chip_id, chip, color)

    def check(self) -> None:
        """Refuses a camera that this driver was not made for.

        Raises:
            CameraError: names the version found and the version needed.
        """
        found = self.identify()
        if found.firmware < r.FIRMWARE:
            raise self._refuse("firmware", f"version {found.firmware}", f"version {r.FIRMWARE}")
        if found.logic != r.LOGIC:
            raise self._refuse("logic", f"version {found.logic}", f"version {r.LOGIC}")
        if found.logic_patch < r.LOGIC_PATCH:
            raise self._refuse("logic", f"patch {found.logic_patch}", f"patch {r.LOGIC_PATCH}")
        chip = KNOWN.get(found.chip_id)
        if chip is None:
            others = _OTHERS_PLAY.get(found.chip_id, "Neither libcaer nor dv-processing plays")
            raise self._refuse("chip", found.chip, KNOWN[r.CHIP].name, f"{others} this sensor.")
        self.chip, self.is_colour = chip, found.color != 0
        self._warn_of_variant(found)
        self.layout = self._read_layout()
        if self.info.speed_mbit_s < SUPER_SPEED_MBIT_S:
            log.warning(
                "The camera %s runs at the speed of USB 2: it works, but fast motion may lose "
                "events. Use a blue USB 3 socket and a USB 3 cable.",
                self.info.serial,
            )

    def _warn_of_variant(self, found: CameraVersions) -> None:
        """Logs what is unusual about a camera that is played all the same."""
        if found.firmware > r.FIRMWARE:
            log.warning(
                "The camera %s has firmware version %d; this driver was made for version %d. It "
                "is tried, as libcaer does; dv-processing refuses it.",
                self.info.serial,
                found.firmware,
                r.FIRMWARE,
            )
        if found.chip_id != r.CHIP:
            others = "libcaer and dv-processing play it, too"
            if self.chip.name.startswith("DAVIS346"):
                others = "libcaer plays it, too; dv-processing refuses it"
            log.warning(
                "The camera %s has the sensor %s, which this driver has only played in a "
                "simulation; %s.",
                self.info.serial,
                self.chip.name,
                others,
            )

    def silence(self) -> None:
        """Switches everything off: the last program may have left the camera running."""
        self._switch_off()
        self._sleep_s(SILENCE_S)
        with suppress(CameraError):  # a camera may refuse it (dv-processing)
            self.transport.request(r.REQUEST_FLUSH, 0, 0, b"")

    def configure(self, config: DavisConfig) -> None:
        """Writes all settings, in the order of the public drivers."""
        for register, value in self._list_settings(config):
            self.write(register, value)

    def start(self, config: DavisConfig, receive: Receive) -> None:
        """Starts the stream, with its clock at 0 from the timestamp reset in it on.

        Args:
            config: as it was configured with.
            receive: takes the stream.
        """
        self.transport.queue(receive)  # all transfers wait before there is anything to carry
        self.write(r.MUX_RUN_CHIP, 1)
        self._sleep_s(SETTLE_S)
        for register in (r.USB_RUN, r.MUX_TIMESTAMP_RUN, r.MUX_RUN):
            self.write(register, 1)
        self._sleep_s(READY_S)
        flags = {r.DVS_HAS_STATISTICS: r.DVS_DROPPED, r.MUX_HAS_STATISTICS: r.MUX_DROPPED_DVS}
        self._dropped = {n: self.read(n) for flag, n in flags.items() if self.read(flag)}
        self.write(r.DVS_RUN, 1)
        self.write(r.APS_RUN, int(config.frames))
        self._write_together((r.MUX_TIMESTAMP_RESET, 1), (r.MUX_TIMESTAMP_RESET, 0))

    def enter_idle(self, config: DavisConfig) -> None:
        """Makes the camera send fuller packets, and only frames that are requested."""
        delay = round(max(IDLE_DELAY_US, config.early_packet_delay_us) * self._usb_mhz)
        self._write_together((r.APS_RUN, 0), (r.USB_EARLY_PACKET_DELAY, delay))

    def leave_idle(self, config: DavisConfig) -> None:
        """Makes the camera send everything it is configured for, and a frame immediately."""
        delay = round(config.early_packet_delay_us * self._usb_mhz)
        self._write_together((r.APS_RUN, int(config.frames)), (r.USB_EARLY_PACKET_DELAY, delay))

    def request_frame(self) -> None:
        """Requests one frame from an idle camera, which finishes a frame it has begun."""
        self._write_together((r.APS_RUN, 1), (r.APS_RUN, 0))

    def stop(self) -> None:
        """Switches everything off, if the camera is still there."""
        with suppress(CameraError):
            self._switch_off()

    def count_dropped(self) -> int:
        """Returns how many events the camera dropped, for lack of room, since the last call.

        One counter is before and one after its multiplexer; the larger one counts.
        """
        now = {register: self.read(register) for register in self._dropped}
        before, self._dropped = self._dropped, now
        counts = ((n - before[register]) % (1 << 32) for register, n in now.items())
        return max(counts, default=0)

    def read(self, register: Register) -> int:
        """Returns the value of a register.

        Raises:
            CameraError: no answer, or a short one.
        """
        answer = self.transport.request(r.REQUEST_REGISTER, *register, 4)
        if len(answer) != 4:
            raise CameraError(
                f"The camera's answer has {len(answer)} bytes instead of 4 (register "
                f"{register.module}:{register.parameter})."
            )
        return int.from_bytes(answer, "big")

    def write(self, register: Register, value: int) -> None:
        """Sets a register.

        Raises:
            CameraError: the camera refuses, or is gone.
        """
        self.transport.request(r.REQUEST_REGISTER, *register, value.to_bytes(4, "big"))

    def _read_layout(self) -> AddressLayout:
        columns, rows = self.read(r.DVS_COLUMNS), self.read(r.DVS_ROWS)
        events, frames = self.read(r.DVS_ORIENTATION), self.read(r.APS_ORIENTATION)
        swap = bool(events & r.ORIENTATION_SWAP)
        size = (rows, columns) if swap else (columns, rows)
        chip = self.chip
        if size != (chip.width_px, chip.height_px):
            wanted = f"{chip.width_px}×{chip.height_px} pixels for a {chip.name}"
            others = "libcaer and dv-processing take the size that a camera reports."
            raise self._refuse("sensor", f"{size[0]}×{size[1]} pixels", wanted, others)
        return AddressLayout(
            columns,
            rows,
            swap_events=swap,
            swap_frames=bool(frames & r.ORIENTATION_SWAP),
            flip_columns=bool(frames & r.ORIENTATION_FLIP_COLUMNS),
            flip_rows=bool(frames & r.ORIENTATION_FLIP_ROWS),
            width_px=chip.width_px,
            height_px=chip.height_px,
            sample_shift=chip.sample_shift,
        )

    def _write_together(self, *values: tuple[Register, int]) -> None:
        """Sets registers in order, with no time between them."""
        data = b"".join(struct.pack(">BBI", *register, value) for register, value in values)
        self.transport.request(r.REQUEST_REGISTERS, len(values), 0, data)

    def _switch_off(self) -> None:
        for register in (r.DVS_RUN, r.APS_RUN, *r.IMU_RUNS, r.EXTINPUT_RUN):
            self.write(register, 0)
        if self.read(r.EXTINPUT_HAS_GENERATOR):
            self.write(r.EXTINPUT_RUN_GENERATOR, 0)
        for register in (r.MUX_RUN, r.MUX_TIMESTAMP_RUN, r.USB_RUN, r.MUX_RUN_CHIP):
            self.write(register, 0)

    def _list_settings(self, c: DavisConfig) -> Iterable[tuple[Register, int]]:
        yield from self.chip.fixed.items()
        for name, value in {**self.chip.fixed_currents, **c.biases._asdict()}.items():
            current = self.chip.currents[name]
            yield Register(5, current.address), current.word(value)
        yield from ((r.MUX_DROP_EXTINPUT, 1), (r.MUX_DROP_DVS, 1))
        yield from ((r.DVS_WAIT, 0), (r.DVS_EXTERNAL_AER, 0))
        yield from self._list_filters(c)
        shutter = self.read(r.APS_HAS_GLOBAL_SHUTTER)
        yield r.APS_WAIT, 1
        yield from ((r.CHIP_GLOBAL_SHUTTER, shutter), (r.APS_GLOBAL_SHUTTER, shutter))
        yield from zip(r.APS_ROI, self._limit(c.frames_roi), strict=True)
        adc_mhz = self._read_clock(r.SYSINFO_ADC_MHZ)
        self._usb_mhz = self._read_clock(r.SYSINFO_USB_MHZ)
        yield r.APS_EXPOSURE, round(c.exposure_us * adc_mhz)
        yield r.APS_FRAME_INTERVAL, round(c.frame_interval_us * adc_mhz)
        yield r.USB_EARLY_PACKET_DELAY, round(c.early_packet_delay_us * self._usb_mhz)

    def _list_filters(self, c: DavisConfig) -> Iterable[tuple[Register, int]]:
        """Filters that this camera's logic has."""
        if self.read(r.DVS_HAS_PIXEL_FILTER):
            nowhere = (self.chip.width_px, self.chip.height_px)
            pixels = c.hot_pixels + (nowhere,) * (r.N_FILTERED_PIXELS - len(c.hot_pixels))
            for k, (x, y) in enumerate(pixels):
                row, column = r.pixel_filter(k)
                yield from ((row, y), (column, x))
        if self.read(r.DVS_HAS_ACTIVITY_FILTER):
            for run, time_, time_us in (
                (r.DVS_ACTIVITY_FILTER, r.DVS_ACTIVITY_TIME, c.activity_filter_us),
                (r.DVS_REFRACTORY_FILTER, r.DVS_REFRACTORY_TIME, c.refractory_us),
            ):
                yield from ((time_, -(-time_us // r.FILTER_UNIT_US)), (run, int(time_us > 0)))
        if self.read(r.DVS_HAS_ROI_FILTER):
            yield from zip(r.DVS_ROI, self._limit(c.events_roi), strict=True)
        if self.read(r.DVS_HAS_SKIP_FILTER):
            yield r.DVS_SKIP_FILTER, 0
        if self.read(r.DVS_HAS_POLARITY_FILTER):
            yield from ((r.DVS_POLARITY_FLATTEN, 0), (r.DVS_POLARITY_SUPPRESS, 0))

    def _limit(self, roi: Roi) -> tuple[int, int, int, int]:
        """Returns the limits of a region in this sensor's picture: columns and rows, begin, end."""
        last_x, last_y = self.chip.width_px - 1, self.chip.height_px - 1
        x_begin, y_begin, x_end, y_end = roi
        return min(x_begin, last_x), min(y_begin, last_y), min(x_end, last_x), min(y_end, last_y)

    def _read_clock(self, register: Register) -> float:
        """Returns the true frequency of a clock, in MHz."""
        return self.read(register) * self.read(r.SYSINFO_DEVIATION) / 1000

    def _refuse(
        self, part: str, found: str, wanted: str, others: str = _BOTH_REFUSE
    ) -> CameraError:
        return CameraError(
            f"The camera {self.info.serial} has {part} {found}; this driver needs {wanted}.",
            hint=f"{others} The maker's page about versions: {UPDATE_PAGE} This program does not "
            "flash cameras.",
        )
