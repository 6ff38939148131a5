"""The emulated camera in the guest: a process that plugs it in and pulls it as it is told.

    python -m tests.system.guest.camera RECORDING

reads ``plug SERIAL PACE`` and ``pull`` from its input and answers with the time. What the camera
sees is the recording, over and over, in slow motion. With ``rehearse`` it only compiles what it
needs; no kernel takes part.
"""

import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera, Identity
from neurotouch_devtools.emulator.registers import (
    APS_RUN,
    CHIP_RUN,
    DVS_RUN,
    MUX_RUN,
    TIMESTAMP_RESET,
    TIMESTAMP_RUN,
    USB_RUN,
)
from neurotouch_devtools.emulator.usbip import UsbIp

from neurotouch_hid.messages import EventPacket, Frame
from neurotouch_hid.source.replay import Replay

PACE = 0.2
"""The guest is many times slower than a player's machine, so its camera is slower, too. A slice
of 4 ms takes 20 ms in there, a quarter of the silence at which the pad goes neutral."""

SERIAL = "00000001"


def repeat(packets: Sequence[EventPacket]) -> Iterator[EventPacket]:
    """The packets without end, time going on."""
    length_us = packets[-1].t_end_us - packets[0].t_begin_us
    shift_us = -packets[0].t_begin_us
    while True:
        for packet in packets:
            events = packet.events.copy()
            events["t"] += shift_us
            frames = tuple(_shift(frame, shift_us) for frame in packet.frames)
            begin_us, end_us = packet.t_begin_us + shift_us, packet.t_end_us + shift_us
            yield replace(
                packet, t_begin_us=begin_us, t_end_us=end_us, events=events, frames=frames
            )
        shift_us += length_us


def _shift(frame: Frame, shift_us: int) -> Frame:
    return replace(
        frame,
        exposure_begin_us=frame.exposure_begin_us + shift_us,
        exposure_end_us=frame.exposure_end_us + shift_us,
    )


class Camera:
    """The process, seen from the outside.

    Args:
        recording: what the camera sees.
    """

    def __init__(self, recording: Path) -> None:
        command = [sys.executable, "-m", "tests.system.guest.camera", str(recording)]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self._process.stdout is not None
        self._process.stdout.readline()  # everything is loaded

    def plug(self, serial: str = SERIAL, pace: float = PACE) -> None:
        """Plugs a camera in, in place of one that is; returns when the kernel has the cable."""
        self._tell(f"plug {serial} {pace}")

    def pull(self) -> float:
        """Pulls the cable; returns when that began, ``time.monotonic``."""
        return float(self._tell("pull"))

    def _tell(self, order: str) -> str:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(f"{order}\n")
        self._process.stdin.flush()
        said = self._process.stdout.readline().strip()
        if not said:
            raise RuntimeError("the emulated camera has ended")
        return said


def rehearse(packets: Iterator[EventPacket]) -> None:
    """Reads the camera as a host would, as far as its first frames."""
    camera = EmulatedCamera(packets, CameraConfig(unpaced=True))
    switches = (CHIP_RUN, USB_RUN, TIMESTAMP_RUN, MUX_RUN, DVS_RUN, APS_RUN, TIMESTAMP_RESET)
    for switch in switches:
        camera.write(switch, 1)
    for _ in range(200):
        camera.read(8192)


def main() -> None:
    """Does what it is told until nobody tells it anything."""
    recording, cable = Path(sys.argv[1]), None
    with Replay(recording) as source:
        packets = repeat(list(source))
    if sys.argv[2:] == ["rehearse"]:
        rehearse(packets)
        return
    first = next(packets)  # the recording is read
    print(first.t_begin_us, flush=True)
    for line in sys.stdin:
        order, *which = line.split()
        at_s = time.monotonic()
        if cable is not None:
            cable.close()
            cable = None
        if order == "plug":
            serial, pace = which
            config = CameraConfig(identity=Identity(serial=serial), pace=float(pace))
            cable = UsbIp(EmulatedCamera(packets, config))
        print(at_s, flush=True)


if __name__ == "__main__":
    main()
