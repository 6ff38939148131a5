"""Plugs emulated cameras into the kernel and reads them through three drivers.

Ours, the vendor's, and neuromorphic-drivers as the source ``events:`` plays it.
"""

import multiprocessing
import signal
import subprocess
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera, Identity, UsbIp

from neurotouch_hid.source.events.source import EventCameraSource
from tests.emulator import drivers
from tests.emulator.host import make_scene

SCENE = {"seed": 7, "n_events": 5000, "length_us": 200_000, "n_frames": 3}
LEAD_US = 4_000_000
"""For a driver that does not reset the clock: it switches events on some time before frames."""
SERIAL = "00000346"
PATIENCE_S = 240.0


def watch(results: Path) -> dict[str, Any]:
    """What Linux and each driver see of the cameras."""
    ours, theirs = multiprocessing.Pipe()
    process = multiprocessing.get_context("fork").Process(target=serve, args=(theirs,))
    process.start()
    theirs.close()
    saw: dict[str, Any] = {}
    try:
        for driver in ("events", "dv", "own"):
            plug(ours, SERIAL, resets=driver != "events")
            columns, frames = drivers.read(driver, 5000, 3, PATIENCE_S)
            np.savez(
                results / f"camera-{driver}.npz",
                events=np.array(columns),
                times=np.array([frame[:2] for frame in frames]),
                pixels=np.array([frame[2] for frame in frames]),
            )
            saw["super"] = describe()
            unplug(ours)
        plug(ours, SERIAL)
        saw["unplugged"] = unplug_while_read(ours)
        plug(ours, SERIAL, resets=False)
        saw["unplugged_events"] = unplug_while_played(ours)
        plug(ours, "00000002")
        saw["two"] = beside(results / "tour.aedat4")
        unplug(ours)
    finally:
        process.kill()
        process.join()
    saw["left"] = describe()
    return saw


def serve(orders: Connection) -> None:
    """Holds the other end of the cables: a driver that holds the interpreter must not stop it."""
    cables: list[UsbIp] = []
    while True:
        order = orders.recv()
        if order is None:
            cables.pop().close()
        else:
            serial, resets = order
            config = CameraConfig(
                Identity(serial),
                lead_us=LEAD_US * (not resets),
                await_reset=resets,
                unpaced=True,
            )
            cables.append(UsbIp(EmulatedCamera(make_scene(**SCENE), config)))
        orders.send("done")


def plug(orders: Connection, serial: str, *, resets: bool = True) -> None:
    give(orders, (serial, resets))
    deadline = time.monotonic() + 60.0
    while not describe() and time.monotonic() < deadline:
        time.sleep(0.1)


def give(orders: Connection, order: tuple[str, bool] | None) -> None:
    """Have a camera plugged in, or the last one pulled out."""
    orders.send(order)
    if not orders.poll(PATIENCE_S):
        raise TimeoutError(f"the cameras' process does not answer to {order}")
    orders.recv()


def unplug(orders: Connection) -> None:
    n_before = len(describe())
    give(orders, None)
    deadline = time.monotonic() + 60.0
    while len(describe()) == n_before > 0 and time.monotonic() < deadline:
        time.sleep(0.1)


def beside(recording: Path) -> dict[str, Any]:
    """What Linux says while the command plugs in another camera, and how the command ends."""
    program = [sys.executable, "-m", "neurotouch_hid", "emulate", "--source", f"file:{recording}"]
    command = subprocess.Popen(
        [*program, "--serial", "00000001", "--usb2"], stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + PATIENCE_S
    while len(describe()) < 2 and time.monotonic() < deadline:
        time.sleep(0.1)
    both = describe()
    command.send_signal(signal.SIGINT)
    _, said = command.communicate(timeout=PATIENCE_S)
    return {"both": both, "said": said, "code": command.returncode}


def describe() -> list[dict[str, str]]:
    """What Linux says of the cameras."""
    found = []
    for folder in Path("/sys/bus/usb/devices").iterdir():
        try:
            if (folder / "idVendor").read_text() == "152a\n":
                names = ("idProduct", "bcdDevice", "speed", "serial", "product", "manufacturer")
                found.append({name: (folder / name).read_text().strip() for name in names})
        except OSError:  # a hub, an interface, or gone
            continue
    return sorted(found, key=lambda camera: camera["serial"])


def unplug_while_read(orders: Connection) -> bool:
    """Whether the vendor's driver notices that its camera goes in the middle of its stream."""
    deadline = time.monotonic() + PATIENCE_S
    told = False
    for events, _ in drivers.dv():  # ends when the driver says that it does not run any more
        if events and not told:
            give(orders, None)
            told = True
        if time.monotonic() > deadline:
            return False
    return told


def unplug_while_played(orders: Connection) -> dict[str, Any]:
    """How a program ends whose source ``events:`` is unplugged in the middle of its stream.

    The library aborts a program that closes such a camera too early.
    """
    begun, told = multiprocessing.Pipe()
    player = multiprocessing.get_context("fork").Process(target=play_events, args=(told,))
    player.start()
    saw: dict[str, Any] = {"plays": begun.poll(PATIENCE_S) and begun.recv()}
    pulled_s = time.monotonic()
    give(orders, None)
    if begun.poll(PATIENCE_S):
        trouble, noticed_s = begun.recv()
        saw |= {"trouble": trouble, "seconds": round(noticed_s - pulled_s, 3)}
    player.join(PATIENCE_S)
    return saw | {"code": player.exitcode}


def play_events(told: Connection) -> None:
    """Says when the first slice comes, and when and why no more do."""
    with EventCameraSource() as source:
        for packet in source.poll():
            if packet is not None:
                told.send(True)
                break
        while not source.trouble:
            time.sleep(0.001)
        told.send((source.trouble, time.monotonic()))
