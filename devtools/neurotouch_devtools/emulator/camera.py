"""The emulated camera itself: control requests in, a stream of bytes out."""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from neurotouch_devtools.emulator import registers as reg
from neurotouch_devtools.emulator.descriptors import Identity
from neurotouch_devtools.emulator.faults import Fault, FaultKind, Script, Stage
from neurotouch_devtools.emulator.filters import EventFilter
from neurotouch_devtools.emulator.frames import FrameReader
from neurotouch_devtools.emulator.imu import Imu
from neurotouch_devtools.emulator.readout import Words
from neurotouch_devtools.emulator.registers import Registers
from neurotouch_devtools.emulator.scene import Scene
from neurotouch_devtools.emulator.sight import SHARES, see
from neurotouch_devtools.emulator.words import WordEncoder
from neurotouch_hid.errors import SourceError
from neurotouch_hid.messages import EventPacket

_READY_BYTES = 1 << 16
_LONG_US = 1 << 31
_NEVER_US = 1 << 60
_OVERFLOW_NS = 10_000_000
_SILENCE_NS = 100_000_000


@dataclass(frozen=True, slots=True)
class CameraConfig:
    """Properties of an emulated camera.

    Attributes:
        identity: serial, speed, versions of the USB side.
        orientation: register 1:2 and 2:2, see ``Registers``.
        colour: the colour filter, 0 for none, 1 to 8 as ``sight.FILTERS``.
        shares: share of the light that passes the filters R, G, B and W.
        logic: version and patch of the FPGA.
        chip: the chip's identifier: 4, 5 and 9 are DAVIS346, 0 to 2 the smaller DAVIS240.
        fifo_bytes: size of its buffer for unread data. That of a real camera is unknown.
        lead_us: time from switching the sensors on to the start of the scene.
        await_reset: the scene also waits until the host has reset the clock, as our driver and
            the vendor's do, so that they never miss its beginning.
        unpaced: the scene goes as fast as the host reads, and nothing is lost; otherwise it runs in
            real time, and a slow host loses events, as with a real camera.
        pace: microseconds of the camera's time in one of the host's. Below 1 the camera runs in
            slow motion, for a slow machine.
    """

    identity: Identity = field(default_factory=Identity)
    orientation: int = 4
    colour: int = 0
    shares: dict[str, float] = field(default_factory=lambda: dict(SHARES))
    logic: tuple[int, int] = (18, 1)
    chip: int = reg.DAVIS346B
    fifo_bytes: int = 1 << 20
    lead_us: int = 0
    await_reset: bool = False
    unpaced: bool = False
    pace: float = 1.0


class EmulatedCamera:
    """An emulated DAVIS-346: answers requests and produces the stream, for any transport.

    Args:
        packets: its scene. Time passes there only while the camera streams.
        config: its properties.
        faults: the faults to inject.
        clock_ns: host time.

    Raises:
        SourceError: one of the faults cannot happen to such a camera.

    Attributes:
        registers: the register file.
        script: counts the host's requests and transfers, and injects faults.
        n_dropped: events lost because the host did not read.
    """

    def __init__(
        self,
        packets: Iterable[EventPacket | None],
        config: CameraConfig | None = None,
        faults: Sequence[Fault] = (),
        *,
        clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        for fault in faults:
            if fault.stage is Stage.PICTURE:
                raise SourceError(f"The fault {fault.kind} happens to UVC cameras only.")
        self.config = config or CameraConfig()
        self.registers = Registers(
            orientation=self.config.orientation,
            colour=self.config.colour,
            logic=self.config.logic,
            chip=self.config.chip,
        )
        self.script = Script(faults)
        self.n_dropped = 0
        self._filter = EventFilter(self.registers)
        self._frames = FrameReader(self.registers)
        self._imu = Imu(self.registers)
        chip, colour = self.config.chip, self.config.colour
        self._scene = Scene(see(packets, reg.find_size(chip), colour, self.config.shares))
        self._encoder = WordEncoder(swap=bool(self.config.orientation & 0b100))
        pace = self.config.pace
        self._clock_ns = clock_ns if pace == 1 else lambda: int(pace * clock_ns())
        self._last_ns = self._clock_ns()
        self._t_ns = 0  # camera time
        # The scene has been seen up to _scene_us; that moment is the camera time _resume_us.
        self._scene_us: int | None = None
        self._resume_us = 0
        self._fifo = bytearray()
        self._waiting_since_ns = 0
        self._watching = False
        self._streaming = False
        self._full_until_ns = 0  # camera time
        self._silent_until_ns = self._last_ns

    def write(self, address: tuple[int, int], value: int) -> None:
        """Writes a register and applies it."""
        self.advance()
        before = self.registers[address]
        self.registers[address] = value
        if address == reg.TIMESTAMP_RESET and value and not before:
            self._reset_time()
        if address == reg.APS_RUN and value and not before:
            self._frames.wanted = True
        self._note_switches()

    def flush(self) -> None:
        """Empties the FIFO."""
        self.advance()
        self._fifo.clear()

    @property
    def super_speed(self) -> bool:
        """True if it is plugged into a port of USB 3."""
        return self.config.identity.super_speed

    @property
    def streaming(self) -> bool:
        """True if data passes to USB."""
        return self._streaming

    def put_back(self, data: bytes) -> None:
        """Puts back data that was read but did not reach the host."""
        self._fifo[:0] = data

    def disturb(self, kind: FaultKind) -> None:
        """Makes the camera's data faulty from now on."""
        if kind is FaultKind.RESET:
            self._reset_time()
        elif kind is FaultKind.WRAP:
            self._jump(_LONG_US)
        elif kind is FaultKind.OVERFLOW:
            self._full_until_ns = self._t_ns + _OVERFLOW_NS
        elif kind is FaultKind.SILENCE:
            self._silent_until_ns = self._clock_ns() + _SILENCE_NS
        elif kind is FaultKind.SUSPEND:
            self.registers.power_up()
            self._fifo.clear()
            self._note_switches()
        else:
            self.say(self._encoder.garble(kind))

    def say(self, words: Words) -> None:
        """Puts words into the stream as they are, also invalid ones."""
        if not len(words):
            return
        if not self._fifo:
            self._waiting_since_ns = self._clock_ns()
        self._fifo += words.astype("<u2", copy=False).tobytes()

    @property
    def ended(self) -> bool:
        """True if the scene is over and all of it has been read; the camera continues."""
        return self._scene.ended and not self._frames.readouts and not self._fifo

    @property
    def patience_us(self) -> float:
        """Time after which a transport must ask for data again."""
        return max(self.registers.early_packet_delay_us, 125.0) / self.config.pace

    def read(self, n_bytes: int) -> bytes | None:
        """Returns the answer to a bulk transfer of ``n_bytes``, or None as long as there is none.

        A transfer ends when it is full, or short when its data has waited for the early packet
        delay.
        """
        self.advance()
        if not self._fifo or not self._streaming:
            return None
        waited_us = (self._clock_ns() - self._waiting_since_ns) / 1000
        if len(self._fifo) < n_bytes and waited_us < self.registers.early_packet_delay_us:
            return None
        data = bytes(self._fifo[:n_bytes])
        del self._fifo[:n_bytes]
        self._waiting_since_ns = self._clock_ns()
        return data

    def advance(self) -> None:
        """Advances the camera's clock to the present."""
        now_ns = self._clock_ns()
        elapsed_ns, self._last_ns = now_ns - self._last_ns, now_ns
        if not self.registers[reg.TIMESTAMP_RUN]:
            return
        if now_ns < self._silent_until_ns:
            self._last_ns -= elapsed_ns % 1000
            self._jump(elapsed_ns // 1000)
            return
        began = self._watching and self._t_ns >= 1000 * self._resume_us
        if self.config.unpaced and began and not self._scene.ended:
            self._provide_data()
            return
        self._produce(elapsed_ns)

    def _provide_data(self) -> None:
        """Makes sure that data can be read, at any time of the clock."""
        while len(self._fifo) < _READY_BYTES and not self._scene.ended:
            self._produce(1_000_000)

    def _note_switches(self) -> None:
        registers = self.registers
        if registers.streams and not self._streaming and self.script.has(FaultKind.STALE):
            self.say(self._encoder.garble(FaultKind.STALE))
        self._streaming = registers.streams
        runs = self._streaming and bool(registers[reg.TIMESTAMP_RUN])
        watching = runs and bool(registers[reg.DVS_RUN] or registers[reg.APS_RUN])
        if watching and not self._watching:
            begin_us = _NEVER_US if self.config.await_reset else self._t_ns // 1000
            self._resume_us = begin_us + self.config.lead_us
        elif not watching:
            self._frames.readouts.clear()
            self._frames.wanted = False
        self._watching = watching

    def _reset_time(self) -> None:
        t_us = self._t_ns // 1000
        self._t_ns %= 1000
        self._full_until_ns -= 1000 * t_us
        awaited = self._watching and self._resume_us >= _NEVER_US
        self._resume_us = self.config.lead_us if awaited else self._resume_us - t_us
        words = self._encoder.reset()
        if self._streaming:
            self.say(words)

    def _jump(self, by_us: int) -> None:
        """Advances the clock, but not the scene."""
        self._t_ns += 1000 * by_us
        self._resume_us += by_us

    def _produce(self, elapsed_ns: int) -> None:
        """Advances camera time, and sends the data of that time."""
        overflows = self._t_ns < self._full_until_ns  # at its beginning, however long it was
        self._t_ns += elapsed_ns
        if not self._streaming:
            return
        t_us = self._t_ns // 1000
        full = len(self._fifo) >= self.config.fifo_bytes or overflows
        held = full and not self.registers[reg.DROP_DVS_ON_STALL]
        if self._watching and not held and t_us > self._resume_us:
            self._show(t_us, full=full)
        if not full:
            self.say(self._encoder.wrap(t_us))
            self.say(self._encoder.encode_dated(self._imu.sample(t_us), t_us))

    def _show(self, t_us: int, *, full: bool) -> None:
        """Advances the scene to the camera time ``t_us``."""
        scene = self._scene
        if self._scene_us is None:
            self._scene_us = scene.begin()
            if self._scene_us is None:
                self._resume_us = t_us  # it is still before it has begun, too
                return
        shift_us = self._resume_us - self._scene_us
        until_us = t_us - shift_us
        until_us = max(scene.look_ahead(until_us), self._scene_us)
        self._frames.begin(scene.frames, self._scene_us, until_us)
        events = scene.take(until_us)
        events = self._filter.keep(events) if self.registers[reg.DVS_RUN] else events[:0]
        if full:  # frames are held back, events are lost
            self._frames.hold(until_us - self._scene_us)
            self._count_dropped(len(events))
        else:
            self.say(
                self._encoder.encode(
                    events, self._frames.readouts, until_us=until_us, shift_us=shift_us
                )
            )
        self._scene_us, self._resume_us = until_us, t_us

    def _count_dropped(self, n_events: int) -> None:
        self.n_dropped += n_events
        self.registers.count(reg.DVS_DROPPED, n_events)
        self.registers.count(reg.MUX_DVS_DROPPED, n_events)
