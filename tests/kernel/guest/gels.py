"""Two gels at once: two cameras in the guest's USB, and a driver of its own for each player."""

import multiprocessing
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera, Identity, UsbIp

from neurotouch_hid.client import ask
from neurotouch_hid.errors import DriverError
from neurotouch_hid.events import shift_packet
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source import open_source
from neurotouch_hid.source.davis import find_cameras
from tests.kernel.guest.reader import Reader, find_node

SERIALS = ("00000001", "00000002")
PROFILES = {"one": "a", "two": "b"}
"""Which button a push presses, by the profile of each player."""

PACES = (0.02, 0.01)
"""The guest must keep pace with two lines: what it cannot play at one it gets at the next."""
CAMERA = "version: 1\nearly_packet_delay_us: 8000\n"
"""Few packets: each costs a slow guest more than what is in it."""

REST_US, PUSH_US = 300_000, 1_200_000
"""Until when no hand is there in the tour, and when the first push is over again."""

PATIENCE_S = 150.0
EV_KEY = 1


def play_both(results: Path) -> dict[str, Any]:
    """Each gel moves its player's pad; one is unplugged while it is pressed."""
    from neurotouch_hid.gesture import GestureConfig
    from neurotouch_hid.profile import load_profile
    from neurotouch_hid.runtime import Pipeline, warm_up

    subprocess.run(["modprobe", "vhci-hcd"], check=True)
    profiles = [write_profile(results, name) for name in PROFILES]
    for own in ("neurotouch", "neurotouch/player-2"):
        folder = results / "config" / own
        folder.mkdir(parents=True)
        (folder / "camera.yaml").write_text(CAMERA)
    warm_up(Pipeline.build(load_profile(profiles[0]), GestureConfig()))  # once for both
    packets = load_push(results / "tour.aedat4")
    for pace in PACES[:-1]:
        try:
            return play_at(pace, packets, profiles)
        except TimeoutError as error:
            print(f"at a pace of {pace}: {error}", flush=True)
            wait_for(lambda: not find_cameras())
    return play_at(PACES[-1], packets, profiles)


def play_at(pace: float, packets: list[EventPacket], profiles: list[Path]) -> dict[str, Any]:
    """The same with cameras in slow motion."""
    ours, theirs = multiprocessing.Pipe()
    cameras = multiprocessing.get_context("fork").Process(
        target=serve, args=(theirs, packets, pace)
    )
    cameras.start()
    drivers: list[int] = []
    try:
        ours.recv()
        wait_for(lambda: len(find_cameras()) == len(SERIALS))
        drivers = [start_driver(n, profile) for n, profile in enumerate(profiles)]
        nodes = [find_node(f"neurotouch/pad{n}", PATIENCE_S) for n in range(2)]
        seen: dict[str, Any] = {"names": [node.name for node in nodes]}
        readers = [Reader(node) for node in nodes]
        wait_for(lambda: all(count_markers(n) > 170 for n in range(2)))
        seen["status"] = [
            {key: ask("status", player=n + 1)[key] for key in ("profile", "source")}
            for n in range(2)
        ]
        seen["at_rest"] = [keys(reader) for reader in readers]
        ours.send(("press", 0))
        readers[0].wait_for(is_pressed, PATIENCE_S)
        seen["first_presses"] = [keys(reader) for reader in readers]
        ours.send(("unplug", 0))
        wait_for(lambda: [info.serial for info in find_cameras()] == [SERIALS[1]])
        readers[0].wait_until_quiet(3.0, PATIENCE_S)  # what was on its way has come
        seen["unplugged"] = [keys(reader) for reader in readers]
        ours.send(("press", 1))
        readers[1].wait_for(is_pressed, PATIENCE_S)
        seen["second_presses"] = [keys(reader) for reader in readers]
        for driver in drivers:
            os.kill(driver, signal.SIGTERM)
        seen["exit_codes"] = [os.waitstatus_to_exitcode(os.waitpid(d, 0)[1]) for d in drivers]
        drivers.clear()
        for reader in readers:
            reader.wait_for_end()
        seen["at_the_end"] = [keys(reader) for reader in readers]
    finally:
        for driver in drivers:
            os.kill(driver, signal.SIGKILL)
        cameras.kill()
    return seen


def write_profile(results: Path, name: str) -> Path:
    """A profile of one binding."""
    path = results / f"{name}.yaml"
    binding = f"{{when: push, do: {{button: {PROFILES[name]}}}}}"
    path.write_text(f"version: 1\nname: {name}\nbindings:\n  - {binding}\n")
    return path


def start_driver(number: int, profile: Path) -> int:
    """``neurotouch run`` for a player, in a process that has loaded the kernels already."""
    from neurotouch_hid.cli.run import command

    driver = os.fork()
    if driver:
        return driver
    options = ["--player", str(number + 1), "--source", f"davis:{SERIALS[number]}"]
    os.environ["XDG_CONFIG_HOME"] = str(profile.parent / "config")
    options += ["--device", ("uinput", "hid")[number], "--profile", str(profile)]
    try:
        command.main([*options, "--rate", "25", "--show", "nothing"], standalone_mode=False)
    except BaseException:
        import traceback

        traceback.print_exc()
        os._exit(1)
    os._exit(0)


def load_push(recording: Path) -> list[EventPacket]:
    """The begin of the tour: rest and a push; frames at rest only, where the gel is looked for."""
    packets = []
    with open_source(f"file:{recording}", speed="max") as source:
        for packet in source:
            if packet.t_end_us > PUSH_US:
                break
            packets.append(packet if packet.t_end_us <= REST_US else replace(packet, frames=()))
    return packets


def see(packets: list[EventPacket], pressed: Callable[[], bool]) -> Iterator[EventPacket]:
    """What a camera sees: rest until it is pressed, then a push again and again."""
    rest = [packet for packet in packets if packet.t_end_us <= REST_US]
    now_us = 0
    while True:
        for packet in packets if pressed() else rest:
            yield shift_packet(packet, now_us - packet.t_begin_us)
            now_us += packet.t_end_us - packet.t_begin_us


def serve(orders: Connection, packets: list[EventPacket], pace: float) -> None:
    """Holds the other end of the cables."""
    pressed = [False, False]
    cables = []
    for number, serial in enumerate(SERIALS):
        scene = see(packets, lambda number=number: pressed[number])
        config = CameraConfig(identity=Identity(serial=serial), pace=pace, await_reset=True)
        cables.append(UsbIp(EmulatedCamera(scene, config)))
    orders.send("plugged in")
    while True:
        order, number = orders.recv()
        if order == "press":
            pressed[number] = True
        else:
            cables[number].close()


def count_markers(number: int) -> int:
    """How many markers a player's driver sees."""
    try:
        return int(ask("status", player=number + 1)["markers_tracked"])
    except DriverError:  # it is still starting
        return 0


def keys(reader: Reader) -> list[list[int]]:
    """What has been pressed and let go of so far."""
    return [[code, value] for kind, code, value in list(reader.events) if kind == EV_KEY]


def is_pressed(events: list[tuple[int, int, int]]) -> bool:
    """Whether the last key was pressed."""
    last = [value for kind, _, value in list(events) if kind == EV_KEY][-1:]
    return last == [1]


def wait_for(condition: Callable[[], bool]) -> None:
    """Wait until it holds.

    Raises:
        TimeoutError: it does not.
    """
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError([count_markers(n) for n in range(2)])
        time.sleep(0.1)
