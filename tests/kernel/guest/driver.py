"""Runs the driver itself, ``neurotouch run``, on the simulated gel."""

import contextlib
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from evdev.ecodes import BTN_SOUTH, EV_KEY

from neurotouch_hid.device.gamepad import PHYS
from tests.kernel.guest.companions import PLACES
from tests.kernel.guest.opening import run
from tests.kernel.guest.reader import Reader, find_node, list_nodes
from tests.kernel.guest.sdl import look, open_games

KEYS = Path(__file__).with_name("keys.yaml")
PATIENCE_S = 300.0
"""The start alone takes half a minute in the guest."""


def play_tour(results: Path) -> dict[str, Any]:
    """Play the recorded tour to its end while two games and a reader look on."""
    source, trace = results / "tour.aedat4", results / "tour.jsonl"
    seen: dict[str, dict[str, list[int]]] = {"sdl2": {}, "sdl3": {}}
    with started("spacecraft", f"file:{source}", "--trace", str(trace)) as (process, reader):
        process.send_signal(signal.SIGSTOP)  # until the games are there
        run("udevadm", "settle", "--timeout=60")
        nodes = list_nodes()
        with open_games() as games:
            process.send_signal(signal.SIGCONT)
            while process.poll() is None:
                for name, game in games.items():
                    for control, value in look(game).items():
                        low, high = seen[name].get(control, (0, 0))
                        seen[name][control] = [min(low, value), max(high, value)]
                time.sleep(0.02)
    return {**reader.report(), "exit_code": process.returncode, "nodes": nodes, **seen}


def terminate(results: Path) -> dict[str, Any]:
    """Ask the driver to end, twice, while a push holds a key and the stick."""
    with started(str(KEYS), "sim:tour") as (process, reader):
        reader.wait_for(lambda events: (EV_KEY, BTN_SOUTH, 1) in events, PATIENCE_S)
        process.terminate()
        process.terminate()
    return {**reader.report(), "exit_code": process.returncode}


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
    return {**reader.report(), "exit_code": process.returncode, **seen}


@contextlib.contextmanager
def started(
    profile: str, source: str, *options: str
) -> Iterator[tuple[subprocess.Popen[bytes], Reader]]:
    """Start the driver, read its pad, and afterwards wait for both to end."""
    command = ["run", "--profile", profile, "--source", source, "--device", "uinput"]
    quick = ["--speed", "max", "--show", "nothing"]
    process = subprocess.Popen([sys.executable, "-m", "neurotouch_hid", *command, *quick, *options])
    try:
        reader = Reader(find_node(PHYS, PATIENCE_S))
        yield process, reader
        process.wait(PATIENCE_S)
        reader.wait_for_end()
    finally:
        process.kill()
