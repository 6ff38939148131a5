"""The driver alone at 5 million events/s and 25 frames/s: processor, delay, loss; both libraries.

    python -m tests.benchmarks.camera [SECONDS] [MILLION_EVENTS_PER_S] [rest]

With ``rest`` the line says that nothing happens, and the camera sends what it sends then.
The stream and all answers are the emulated camera's. Between it and the real Python bindings lies
``camera.c`` instead of libusb and Linux, so their part of the work is not in the figures; nor is
its own, which is told apart. It needs gcc and libusb's header (Debian: libusb-1.0-0-dev). Each
library plays in a process of its own. The *delay* is from the last transfer of a slice to the
slice, the *age* from the slice's end in the sensor.
"""

import ctypes
import gc
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera
from neurotouch_devtools.emulator import registers as reg
from neurotouch_devtools.emulator.requests import ControlEndpoint
from neurotouch_devtools.emulator.transfers import DataEndpoint
from neurotouch_devtools.emulator.usb import Setup

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.source.camera_source import PatientWatch
from neurotouch_hid.source.davis import CameraInfo, DavisConfig, DavisSource
from neurotouch_hid.source.davis.camera import IDLE_DELAY_US
from neurotouch_hid.source.davis.libusb import TRANSFER_BYTES, LibusbTransport
from neurotouch_hid.source.davis.pyusb import TRANSFER_BYTES as PYUSB_BYTES
from neurotouch_hid.source.davis.pyusb import PyusbTransport
from neurotouch_hid.source.davis.stream import IDLE_FRAME_S

INFO = CameraInfo(1, 2, "1-1", "00000001", "DAVIS 346", 5000, 6)
SLICE_US = 4_000
STEP_US = 125
PACKET_BYTES = 1024

SWITCHES = (reg.CHIP_RUN, reg.USB_RUN, reg.TIMESTAMP_RUN, reg.MUX_RUN, reg.DVS_RUN, reg.APS_RUN)
ANSWER = ctypes.CFUNCTYPE(
    ctypes.c_int, *(ctypes.c_uint8,) * 2, *(ctypes.c_uint16,) * 2, ctypes.c_void_p, ctypes.c_uint16
)


@dataclass(frozen=True, slots=True)
class Pace:
    """How often the camera sends frames, and how long data waits for a full packet."""

    frame_us: int
    early_us: int


PLAY = Pace(DavisConfig().frame_interval_us, DavisConfig().early_packet_delay_us)
REST = Pace(round(1e6 * IDLE_FRAME_S), IDLE_DELAY_US)


def see(seconds: float, rate: float, pace: Pace) -> Iterator[EventPacket]:
    """Events all over the sensor, of one rate, and frames."""
    rng = np.random.default_rng(0)
    events = np.zeros(round(rate * SLICE_US), EVENT_DTYPE)
    pixels = rng.integers(256, size=(260, 346)).astype(np.uint8)
    for begin_us in range(0, round(1e6 * seconds), SLICE_US):
        events["t"] = begin_us + np.arange(len(events)) * SLICE_US // len(events)
        events["x"], events["y"] = (
            rng.integers(346, size=len(events)),
            rng.integers(260, size=len(events)),
        )
        events["p"] = rng.integers(2, size=len(events))
        frames = (
            (Frame(pixels, begin_us, begin_us + 4_000),)
            if begin_us % pace.frame_us < SLICE_US
            else ()
        )
        yield EventPacket(begin_us, begin_us + SLICE_US, events.copy(), frames)


@dataclass(frozen=True, slots=True)
class Stream:
    """What the emulated camera sends.

    Attributes:
        data: all of it.
        offsets: (steps + 1,) uint64, how much has come after each STEP_US.
        ends: where its short packets end.
    """

    data: bytes
    offsets: np.ndarray
    ends: np.ndarray

    def due_us(self, ends_us: np.ndarray, transfer_bytes: int) -> np.ndarray:
        """When the transfers have come that hold the first words after these times.

        A packet may begin with words from before, so a transfer may be counted that is one too
        early: no delay is told too short.
        """
        begins = np.concatenate(([0], self.ends))
        lengths = np.diff(np.append(begins, len(self.data) + transfer_bytes))
        bounds = [
            np.minimum(
                begin + np.arange(transfer_bytes, length + transfer_bytes, transfer_bytes),
                begin + length,
            )
            for begin, length in zip(begins, lengths, strict=True)
        ]
        bound = np.concatenate(bounds)
        whole = bound[np.searchsorted(bound, self.offsets[ends_us // STEP_US], side="right")]
        step = np.searchsorted(self.offsets, whole)
        before = self.offsets[step - 1].astype(float)
        part = (whole - before) / (self.offsets[step] - before)
        return STEP_US * (step - 1 + part)


def record(packets: Iterable[EventPacket], seconds: float, pace: Pace) -> Stream:
    """The emulated camera's stream of what it sees, set up as the driver does it."""
    now_us = 0
    config = CameraConfig(fifo_bytes=1 << 40)
    camera = EmulatedCamera(packets, config, clock_ns=lambda: 1000 * now_us)
    cycles_per_us = (
        camera.registers[reg.EARLY_PACKET_DELAY] / camera.registers.early_packet_delay_us
    )
    camera.write(reg.EARLY_PACKET_DELAY, round(pace.early_us * cycles_per_us))
    for switch in SWITCHES:
        camera.write(switch, 1)
    camera.write(reg.TIMESTAMP_RESET, 1)
    parts, offsets, ends, n_bytes = [], [0], [], 0
    while now_us < 1e6 * seconds:
        now_us += STEP_US
        while packet := camera.read(PACKET_BYTES):
            parts.append(packet)
            n_bytes += len(packet)
            if len(packet) < PACKET_BYTES:
                ends.append(n_bytes)
        offsets.append(n_bytes)
    return Stream(b"".join(parts), np.array(offsets, np.uint64), np.array(ends, np.uint64))


def build_standin(folder: str) -> str:
    """Returns the path of the compiled stand-in for libusb."""
    standin = str(Path(folder) / "libusb-standin.so")
    source = Path(__file__).with_suffix(".c")
    build = ["gcc", "-O2", "-shared", "-fPIC", "-o", standin, str(source)]
    build += ["-Wl,--no-as-needed", "-lusb-1.0"]  # for all that is not in there
    subprocess.run(build, check=True)
    return standin


class Bench:
    """Where the driver finds its camera: behind the stand-in, through either library."""

    def __init__(self, library: str, standin: str, stream: Stream) -> None:
        self._library, self._path = library, standin
        self.standin = ctypes.CDLL(standin)
        for name in ("begin", "lost", "longest", "used", "transfers"):
            getattr(self.standin, f"standin_{name}").restype = ctypes.c_uint64
        camera = EmulatedCamera(())
        self._control = ControlEndpoint(camera, DataEndpoint(camera))
        ends = np.append(stream.ends, np.uint64(1 << 62))
        self._kept = ANSWER(self._answer), stream, ends
        self.standin.standin_prepare(
            self._kept[0],
            ctypes.c_char_p(stream.data),
            stream.offsets.ctypes.data_as(ctypes.c_void_p),
            ctypes.c_uint64(len(stream.offsets) - 1),
            ctypes.c_uint64(1000 * STEP_US),
            ends.ctypes.data_as(ctypes.c_void_p),
        )
        self.begun_ns = 0

    def choose(self, serial: str) -> CameraInfo:
        return INFO

    def open(self, info: CameraInfo) -> LibusbTransport | PyusbTransport:
        if self._library == "libusb1":
            import usb1

            usb1.loadLibrary(self.standin)
            return LibusbTransport(info.bus, info.address)
        from usb.backend import libusb1

        libusb1.get_backend(find_library=lambda _: self._path)
        return PyusbTransport(info.bus, info.address)

    def watch(self) -> PatientWatch:
        return PatientWatch()

    def _answer(self, kind: int, request: int, value: int, index: int, data: int, n: int) -> int:
        is_in = kind & 0x80
        given = b"" if is_in else ctypes.string_at(data, n)
        answer = self._control.answer(Setup(kind, request, value, index, n), given)
        if given == bytes([0, 2, 0, 0, 0, 1, 0, 2, 0, 0, 0, 0]):  # the clock is reset
            self.begun_ns = self.standin.standin_begin()
        ctypes.memmove(data, answer, len(answer))
        return len(answer) if is_in else n


def play(library: str, standin: str, seconds: float, rate: float, pace: Pace) -> dict[str, float]:
    """What one library makes of it."""
    stream = record(see(seconds, rate, pace), seconds, pace)
    bench = Bench(library, standin, stream)
    gc.collect()
    gc.freeze()  # as ``run`` does it
    time.sleep(1.0)  # or Linux makes a real-time thread that has just computed for long stand still
    taken, n_events, n_frames, gap = [], 0, 0, 0
    last_us = round(1e6 * seconds) - 100_000  # the rest does not fill a transfer
    with DavisSource(cameras=bench, slice_us=SLICE_US) as source:
        begun_s = used_s = 0.0
        begun_ns = 0
        for packet in source:
            now_s = time.monotonic()
            if not taken:
                begun_s, used_s = now_s, time.process_time()
                begun_ns = bench.standin.standin_used()
            if pace is REST:
                source.set_activity(is_idle=True, wants_frames=False)
            taken.append((packet.t_end_us, now_s))
            n_events, n_frames = n_events + len(packet.events), n_frames + len(packet.frames)
            gap += packet.gap
            if packet.t_end_us >= last_us:
                break
        lasted_s = now_s - begun_s
        used_s = time.process_time() - used_s
        standin_s = 1e-9 * (bench.standin.standin_used() - begun_ns)
    ends_us, at_s = map(np.array, zip(*taken, strict=True))
    at_us = 1e6 * at_s - 1e-3 * bench.begun_ns
    size = TRANSFER_BYTES if library == "libusb1" else PYUSB_BYTES
    delay_ms = 1e-3 * (at_us - stream.due_us(ends_us, size))
    age_ms = 1e-3 * (at_us - ends_us)
    return {
        "million_events_per_s": round(1e-6 * n_events / (1e-6 * ends_us[-1]), 2),
        "frames_per_s": round(n_frames / (1e-6 * ends_us[-1]), 1),
        "megabytes_per_s": round(1e-6 * len(stream.data) / seconds, 1),
        "core_percent": round(100 * (used_s - standin_s) / lasted_s, 1),
        "standin_percent": round(100 * standin_s / lasted_s, 1),
        "delay_ms_median": round(float(np.median(delay_ms)), 2),
        "delay_ms_p99": round(float(np.percentile(delay_ms, 99)), 2),
        "age_ms_median": round(float(np.median(age_ms)), 2),
        "age_ms_p99": round(float(np.percentile(age_ms, 99)), 2),
        "lost_bytes": int(bench.standin.standin_lost()),
        "slices_dropped": gap,
        "longest_wait_kib": int(bench.standin.standin_longest()) >> 10,
    }


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    rate = float(sys.argv[2]) if len(sys.argv) > 2 else 5.0
    pace = REST if "rest" in sys.argv[3:] else PLAY
    if len(sys.argv) > 4:
        print(json.dumps(play(sys.argv[4], sys.argv[5], seconds, rate, pace)))
        return
    with tempfile.TemporaryDirectory() as folder:
        standin = build_standin(folder)
        for library in ("libusb1", "pyusb"):
            command = [sys.executable, "-m", "tests.benchmarks.camera"]
            command += [
                str(seconds),
                str(rate),
                "rest" if pace is REST else "play",
                library,
                standin,
            ]
            said = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
            print(library, said.strip())


if __name__ == "__main__":
    main()
