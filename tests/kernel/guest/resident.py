"""The second player's ``neurotouch service``, before its camera is there, and who plays along."""

import os
import signal
import socket
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from neurotouch_hid.client import Reply, ask
from neurotouch_hid.device import Copilot
from neurotouch_hid.errors import DriverError
from tests.kernel.guest.copilot import NAME, HelperPad, rumble, watched
from tests.kernel.guest.opening import as_nobody
from tests.kernel.guest.reader import Reader, find_node

DRIVER = f"version: 1\ncopilot: {{device: {NAME}}}\n"
PATIENCE_S = 200.0


def play_along(results: Path) -> dict[str, Any]:
    """The helper comes after the service, is unplugged while it holds a button, and comes back."""
    seen: dict[str, Any] = {}
    with started(results) as (service, told):
        seen["told"] = hear_ready(told)
        seen["profile"] = ask_patiently()["profile"]
        device = find_node("neurotouch/pad1")
        reader = Reader(device)
        seen["before"] = copilot()
        helper = HelperPad()
        seen["there"] = wait_for_copilot(playing=True)
        seen["without_right"] = as_nobody(describe_as_somebody_else)
        with watched(reader) as seen["helper"]:
            helper.move(BTN_SOUTH=1, ABS_X=-32768)
        seen["rumble"] = rumble(device, helper)
        with watched(reader) as seen["unplugged"]:
            helper.unplug()
        seen["away"] = wait_for_copilot(playing=False)
        helper = HelperPad()
        wait_for_copilot(playing=True)
        with watched(reader) as seen["back"]:
            helper.move(BTN_EAST=1)
        os.kill(service, signal.SIGTERM)
        reader.wait_for_end(PATIENCE_S)
        seen["exit_code"] = os.waitstatus_to_exitcode(os.waitpid(service, 0)[1])
        seen["last"] = [event for event in reader.events if event[0] == 1][-1]
        helper.unplug()
    return seen


@contextmanager
def started(results: Path) -> Iterator[tuple[int, socket.socket]]:
    """The service's process, and the socket on which it speaks to its manager."""
    folder = results / "service"
    own = folder / "neurotouch/player-2"
    own.mkdir(parents=True)
    (own / "driver.yaml").write_text(DRIVER)
    (own / "service.yaml").write_text("profile: racing\n")
    runtime = Path("/run/neurotouch-2")  # as systemd makes it
    runtime.mkdir(0o755, exist_ok=True)
    told = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    told.bind("\0neurotouch")  # a name without a file: the folder is not the guest's own
    service = os.fork()
    if not service:
        os.environ |= {"XDG_CONFIG_HOME": str(folder), "RUNTIME_DIRECTORY": str(runtime)}
        os.environ |= {"NEUROTOUCH_PLAYER": "2", "NOTIFY_SOCKET": "@neurotouch"}
        serve()
    try:
        yield service, told
    finally:
        with suppress(ProcessLookupError):
            os.kill(service, signal.SIGKILL)
        told.close()


def serve() -> None:
    """Runs the command and never returns."""
    from neurotouch_hid.cli.service import command

    try:
        command.main([], standalone_mode=False)
    except BaseException:  # the console is where one looks then
        traceback.print_exc()
        os._exit(1)
    os._exit(0)


def hear_ready(told: socket.socket) -> list[str]:
    """What the service tells its manager until it is ready."""
    told.settimeout(PATIENCE_S)
    heard: list[str] = []
    while "READY=1" not in heard:
        heard.append(told.recv(1000).decode())
    return heard


def copilot() -> str:
    """What the service says of who plays along."""
    return str(ask_patiently()["copilot"])


def ask_patiently() -> Reply:
    """The service's status; on a slow machine that is emulated, the first answer comes late."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        try:
            return ask("status", player=2)
        except DriverError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.1)


def wait_for_copilot(*, playing: bool) -> str:
    """What it says once the helper plays, or no longer does."""
    deadline = time.monotonic() + PATIENCE_S
    while (said := copilot()).startswith(f"{NAME} (") is not playing:
        if time.monotonic() > deadline:
            raise TimeoutError(said)
        time.sleep(0.1)
    return said


def describe_as_somebody_else() -> str:
    """What a service without the right to read input devices says of the helper it wants."""
    with_nothing = Copilot(NAME, wait=True)
    said = with_nothing.describe()
    with_nothing.close()
    return said
