"""Runs the driver itself, ``neurotouch run``, on the simulated gel."""

import contextlib
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Iterator
from multiprocessing.context import ForkProcess
from pathlib import Path
from typing import Any

from evdev.ecodes import BTN_SOUTH, EV_KEY

from neurotouch_hid.cli.main import main
from neurotouch_hid.device.outputs.gamepad import PHYS
from neurotouch_hid.driver import Driver, DriverOptions
from tests.kernel.guest.extra_devices import PLACES
from tests.kernel.guest.opening import run
from tests.kernel.guest.reader import Reader, find_node, list_nodes
from tests.kernel.guest.sdl import look, open_games

KEYS = Path(__file__).with_name("keys.yaml")
PROCESSOR = Path("/sys/devices/system/cpu/cpu1/online")
PATIENCE_S = 300.0


def load_kernels() -> None:
    """Load once what every driver needs: for each of them it would take a minute here."""
    with Driver(DriverOptions(source="sim:tour", speed="max", device="memory")):
        pass  # it is ready to play


def play_tour(results: Path) -> dict[str, Any]:
    """Play the recorded tour to its end while two games and a reader look on."""
    source, trace = results / "tour.aedat4", results / "tour.jsonl"
    seen: dict[str, dict[str, list[int]]] = {"sdl2": {}, "sdl3": {}}
    with started("spacecraft", f"file:{source}", "--trace", str(trace)) as (process, reader):
        os.kill(process.pid, signal.SIGSTOP)  # until the games are there
        run("udevadm", "settle", "--timeout=60")
        nodes = list_nodes()
        with open_games() as games:
            os.kill(process.pid, signal.SIGCONT)
            while process.is_alive():
                for name, game in games.items():
                    for control, value in look(game).items():
                        low, high = seen[name].get(control, (0, 0))
                        seen[name][control] = [min(low, value), max(high, value)]
                time.sleep(0.02)
    return {**reader.report(), "exit_code": process.exitcode, "nodes": nodes, **seen}


def lose_processor(results: Path) -> dict[str, Any]:
    """Play the tour; the processor that the driver runs on is taken away again and again."""
    source, trace = results / "tour.aedat4", results / "processor.jsonl"
    ran_on = []
    with started("spacecraft", f"file:{source}", "--trace", str(trace)) as (process, reader):
        while process.is_alive():
            with contextlib.suppress(ProcessLookupError, FileNotFoundError):
                for thread in Path(f"/proc/{process.pid}/task").iterdir():
                    os.sched_setaffinity(int(thread.name), {1})
                time.sleep(0.3)
                ran_on.append(find_processor(process.pid))
                PROCESSOR.write_text("0")
                time.sleep(0.3)
                ran_on.append(find_processor(process.pid))
            PROCESSOR.write_text("1")
    return {**reader.report(), "exit_code": process.exitcode, "ran_on": ran_on}


def find_processor(pid: int) -> int:
    """On which processor a process runs, or ran last."""
    after_name = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(after_name[36])


def terminate(results: Path) -> dict[str, Any]:
    """Ask the driver to end, twice, while a push holds a key and the stick."""
    with started(str(KEYS), "sim:tour") as (process, reader):
        reader.wait_for(lambda events: (EV_KEY, BTN_SOUTH, 1) in events, PATIENCE_S)
        process.terminate()
        process.terminate()
    return {**reader.report(), "exit_code": process.exitcode}


def kill(results: Path) -> dict[str, Any]:
    """Kill the driver while a push holds a button, the stick, a chord and a mouse button."""
    with started(str(KEYS), "sim:tour") as (process, reader):
        others = {name: Reader(find_node(phys)) for name, phys in PLACES.items()}
        for each in (reader, *others.values()):
            each.wait_for(
                lambda events: any(event[::2] == (EV_KEY, 1) for event in events), PATIENCE_S
            )
        process.kill()
    for other in others.values():
        other.wait_for_end()
    seen = {name: other.report() for name, other in others.items()}
    return {**reader.report(), "exit_code": process.exitcode, **seen}


@contextlib.contextmanager
def started(profile: str, source: str, *options: str) -> Iterator[tuple[ForkProcess, Reader]]:
    """Start the driver, read its pad, and afterwards wait for both to end."""
    command = ["run", "--profile", profile, "--source", source, "--device", "uinput"]
    quick = ["--speed", "max", "--show", "nothing"]
    arguments = [*command, *quick, *options]
    process = multiprocessing.get_context("fork").Process(target=drive, args=(arguments,))
    process.start()
    try:
        reader = Reader(find_node(PHYS, PATIENCE_S))
        yield process, reader
        process.join(PATIENCE_S)
        reader.wait_for_end()
    finally:
        process.kill()


def drive(arguments: list[str]) -> None:
    """The command line as a process of its own has it."""
    sys.argv = ["neurotouch", *arguments]
    main()
