"""Plugs emulated cameras into the guest's USB and lets our driver play them, with every fault."""

import fcntl
import logging
import os
import select
import signal
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

from neurotouch_devtools.emulator import EmulatedCamera, UsbIp

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.davis import DavisSource, find_cameras, identify
from neurotouch_hid.source.davis.pyusb import PyusbTransport
from neurotouch_hid.source.davis.usb import Usb
from tests.kernel.davis import compare, emulate, flicker, make_scene

PATIENCE_S = 120.0
N_PLUGS = 4
N_COUNTS = 20
"""In one of them the driver is not just reading a file to see whether a camera is back."""
QUIET_SLICES = 30
SCENE = make_scene()
CLAIM = 0x8004550F
"""``USBDEVFS_CLAIMINTERFACE`` of linux/usbdevice_fs.h."""
FAULTS = [
    *("unplug@open+3", "unplug@configure+30", "unplug+9", "unplug@stop+1", "timeout@configure+9"),
    *("stall+9", "babble+9", "timeout+5x64", "suspend+9"),
]
"""Those at which the kernel has a part; the others need none (tests/source/davis)."""
LOSING = ("unplug+9", "stall+9", "babble+9", "suspend+9")
"""Those that lose a part of the stream."""


class Plugged:
    """A camera in the guest's USB; closing it pulls the cable."""

    def __init__(self, camera: EmulatedCamera) -> None:
        before = {info.address for info in find_cameras()}
        self.camera, self.cable = camera, UsbIp(camera)
        wait_for(lambda: {info.address for info in find_cameras()} - before)

    def __enter__(self) -> "Plugged":
        return self

    def __exit__(self, *_: object) -> None:
        self.cable.close()


def wait_for(condition: Any) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError
        time.sleep(0.05)


def open_source(serial: str = "", **options: Any) -> DavisSource:
    return DavisSource(serial, max_delay_us=60_000_000, **options)


def play(source: DavisSource, is_over: Any, packets: list[Any] | None = None) -> list[Any]:
    """The packets until the scene is over and nothing of it is still on its way.

    Args:
        source: the camera.
        is_over: says whether the scene is over.
        packets: they are appended to this list, which the caller may read meanwhile.
    """
    packets = [] if packets is None else packets
    n_quiet = 0
    deadline = time.monotonic() + PATIENCE_S
    for packet in source.poll():
        over = is_over()
        if packet is not None:
            packets.append(packet)
            n_quiet = n_quiet + 1 if over and not len(packet.events) else 0
        if time.monotonic() > deadline:
            raise TimeoutError(f"{source.stats()}")
        if QUIET_SLICES <= n_quiet < len(packets):
            return packets
    return packets


def take(source: DavisSource, n: int) -> list[Any]:
    """The first packets."""
    packets: list[Any] = []
    deadline = time.monotonic() + PATIENCE_S
    for packet in source.poll():
        packets += [packet] if packet is not None else []
        if len(packets) == n:
            break
        if time.monotonic() > deadline:
            raise TimeoutError(f"{source.stats()}")
    return packets


def describe(packets: list[Any], source: DavisSource) -> dict[str, Any]:
    """What the tests judge: time, gaps, events, and the source's own words."""
    stats = source.stats()
    times = [int(t) for packet in packets for t in packet.events["t"]]
    return {
        "ordered": times == sorted(times),
        "sound": all(
            b.t_begin_us >= a.t_end_us and (b.gap > 0 or b.t_begin_us == a.t_end_us)
            for a, b in pairwise(packets)
        ),
        "gap": sum(packet.gap for packet in packets),
        "n_packets": len(packets),
        "n_connects": stats.n_connects,
        "n_faults": stats.n_faults,
        **compare(packets, SCENE),
        "end": compare_end(packets),
    }


def compare_end(packets: list[Any]) -> bool:
    """The last slices of the scene are there."""
    found = [tuple(event)[1:] for packet in packets for event in packet.events.tolist()]
    given = [tuple(event)[1:] for packet in SCENE[-5:] for event in packet.events.tolist()]
    return found[-len(given) :] == given


def stream(results: Path) -> dict[str, Any]:
    """Play a healthy camera with both libraries; look at it, and at what is left behind."""
    seen: dict[str, Any] = {}
    with Log() as log, Plugged(emulate(SCENE)) as plugged:
        (info,) = find_cameras()
        seen["info"] = [info.serial, info.speed_mbit_s, info.firmware, info.reason]
        seen["versions"] = repr(identify(info))
        camera = plugged.camera
        with open_source() as source:
            seen["libusb1"] = describe(play(source, lambda: camera.ended), source)
        seen["stopped"] = not camera.streaming
    with Plugged(emulate(SCENE)) as plugged:
        camera = plugged.camera
        with open_source(cameras=WithPyusb()) as source:
            seen["pyusb"] = describe(play(source, lambda: camera.ended), source)
    return {**seen, "log": log}


class WithPyusb(Usb):
    """The fallback."""

    def open(self, info: Any) -> Any:
        return PyusbTransport(info.bus, info.address)


class Log(logging.Handler):
    """What the driver says."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.lines.append(record.getMessage())

    def __enter__(self) -> list[str]:
        logging.getLogger("neurotouch_hid").addHandler(self)
        return self.lines

    def __exit__(self, *_: object) -> None:
        logging.getLogger("neurotouch_hid").removeHandler(self)


def suffer(results: Path) -> dict[str, Any]:
    """Play a camera with each fault; one that unplugs itself is replaced."""
    return {fault: suffer_one(fault) for fault in FAULTS}


def suffer_one(fault: str) -> dict[str, Any]:
    begun = time.monotonic()
    packets: list[Any] = []

    def make_interrupted() -> Iterator[Any]:
        """The end of the scene waits until the driver, however slow, has noticed the loss."""
        yield from SCENE[:-5]
        while fault in LOSING and not any(packet.gap for packet in packets):
            yield None
        yield from SCENE[-5:]

    plugged = [Plugged(emulate(make_interrupted(), fault))]
    with Log() as log, open_source(wait=True) as source:

        def is_over() -> bool:
            if plugged[-1].cable.wait(0) and not plugged[-1].camera.ended:
                plugged.append(Plugged(emulate(SCENE)))
            return plugged[-1].camera.ended and source.stats().connected

        play(source, is_over, packets)
        said = describe(packets, source)
    for each in plugged:
        each.cable.close()
    wait_for(lambda: not find_cameras())
    return {
        **said,
        "n_cables": len(plugged),
        "log": log,
        "seconds": round(time.monotonic() - begun),
    }


def choose(results: Path) -> dict[str, Any]:
    """Two cameras, one of them on USB 2 and held by somebody else at first."""
    with (
        beside(claim_second) as holder,
        Plugged(emulate(SCENE, serial="00000001")),
        Plugged(emulate(SCENE, serial="00000002", super_speed=False)) as second,
    ):
        holder.wait()
        one, two = sorted(find_cameras(), key=lambda info: info.serial)
        refused, reason = refuse(two.serial)
        unknown, _ = refuse("7")
        listed = [info.reason for info in find_cameras() if info.serial == two.serial]
        holder.kill()
        with Log() as log, open_source("2") as source:
            played = describe(play(source, lambda: second.camera.ended), source)
            name = source.name
    return {
        "serials": [one.serial, two.serial],
        "speeds": [one.speed_mbit_s, two.speed_mbit_s],
        "holder": holder.pid,
        "refused": refused,
        "exit_code": reason,
        "listed": listed,
        "unknown": unknown,
        "name": name,
        "log": log,
        **played,
    }


def refuse(serial: str) -> tuple[str, int]:
    try:
        open_source(serial).close()
    except CameraError as error:
        return error.message, error.exit_code
    return "", 0


def replug(results: Path) -> dict[str, Any]:
    """One source, many plugs, and one camera that Linux switches off and on; what is left over."""
    counts = []
    with open_source(wait=True) as source:
        turns = source.poll()

        def wait_for_start(n_connects: int) -> None:
            wait_for(lambda: (next(turns), source.stats().n_connects >= n_connects)[1])
            wait_for(lambda: next(turns) is not None)

        for k in range(N_PLUGS):
            with Plugged(emulate([])):
                wait_for_start(k + 1)
            wait_for(lambda: (next(turns), not find_cameras())[1])
            counts.append(min(count_open() for _ in zip(range(N_COUNTS), turns, strict=False)))
        with Plugged(emulate([])):
            wait_for_start(N_PLUGS + 1)
            switch = Path(f"/sys/bus/usb/devices/{find_cameras()[0].port_path}/authorized")
            switch.write_text("0")
            wait_for(lambda: (next(turns), not source.stats().connected)[1])
            switch.write_text("1")
            wait_for_start(N_PLUGS + 2)
        n_connects = source.stats().n_connects
    return {"counts": counts, "n_connects": n_connects}


def count_open() -> tuple[int, int]:
    """Open descriptors and threads of this process."""
    return sum(1 for _ in Path("/proc/self/fd").iterdir()), threading.active_count()


def claim_second() -> Iterator[None]:
    """Claim the second camera, as somebody else's program does."""
    wait_for(lambda: len(find_cameras()) == 2)
    (node,) = (info.node for info in find_cameras() if info.serial == "00000002")
    fcntl.ioctl(os.open(node, os.O_RDWR), CLAIM, bytearray(4))
    yield
    signal.pause()


def play_on() -> Iterator[None]:
    """Play the first camera that comes."""
    with open_source(wait=True) as source:
        for packet in source:
            if len(packet.events):
                yield


def take_over(results: Path) -> dict[str, Any]:
    """Kill a driver in mid-stream; the next one finds a camera that runs."""
    with beside(play_on) as holder, Plugged(emulate(flicker())) as plugged:
        holder.wait()
        refused, exit_code = refuse("")
        holder.kill()
        still_runs = plugged.camera.streaming
        with open_source() as source:
            packets = take(source, 30)
            stats = source.stats()
    return {
        "refused": refused,
        "exit_code": exit_code,
        "holder": holder.pid,
        "still_runs": still_runs,
        "begins_us": [packet.t_begin_us for packet in packets],
        "n_connects": stats.n_connects,
    }


@contextmanager
def beside(act: Callable[[], Iterator[None]]) -> Iterator["Beside"]:
    """A process that does something of its own until it is killed, at the latest in the end."""
    process = Beside(act)
    try:
        yield process
    finally:
        process.kill()


class Beside:
    """Forked before there are threads: a new interpreter would take half a minute to start.

    Args:
        act: what it does; it yields when that has come about, and then goes on.
    """

    def __init__(self, act: Callable[[], Iterator[None]]) -> None:
        self._said, tell = os.pipe()
        self.pid = os.fork()
        if not self.pid:
            try:
                for _ in act():
                    os.write(tell, b".")
            except BaseException:
                os.write(tell, traceback.format_exc().encode())
            finally:
                os._exit(1)
        os.close(tell)
        self._killed = False

    def wait(self) -> None:
        """Wait until it has come about.

        Raises:
            TimeoutError: it has not.
            ChildProcessError: it has ended, and why.
        """
        if not select.select([self._said], [], [], PATIENCE_S)[0]:
            status = Path(f"/proc/{self.pid}/wchan").read_text()
            raise TimeoutError(f"the other process is silent, in {status}; {find_cameras()}")
        said = os.read(self._said, 1 << 16)
        if not said.startswith(b"."):
            raise ChildProcessError(said.decode() or "the other process has ended")

    def kill(self) -> None:
        """Kill it, in the middle of whatever it does."""
        if not self._killed:
            self._killed = True
            os.kill(self.pid, signal.SIGKILL)
            os.waitpid(self.pid, 0)
            os.close(self._said)
