"""What can be seen from outside: processes, rights, nodes, and what the pad says."""

import fcntl
import os
import pwd
import shutil
import stat
import struct
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

PAD = "neurotouch/pad"
SERVICE = "neurotouch.service"
PLAYER = "player"
PEOPLE = "/var/lib/neurotouch/people"
"""Where the service keeps its copy of each person's settings."""
PATIENCE_S = 90.0

Control = tuple[int, int]
"""A key or an axis of the pad: its type and its code."""
STICK: Control = (3, 0)
"""What the push to the right moves with the default profile: the left stick, ABS_X."""
GEAR: Control = (1, 0x131)
"""What it presses with racing, to shift up: button B, BTN_EAST."""
D_PAD: Control = (3, 0x10)
"""What it presses besides with platformer: ABS_HAT0X."""

_EVENT = struct.Struct("@llHHi")  # seconds, microseconds, type, code, value
_EVIOCSCLOCKID = 0x400445A0
EV_KEY, EV_ABS = 1, 3


def run(*command: str, timeout_s: float = 900.0) -> dict[str, Any]:
    """Runs a command to its end; what it said, its exit code and how long it took."""
    begun = time.monotonic()
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=timeout_s,
        stdin=subprocess.DEVNULL,
        check=False,
        env={**_plain_environment(), "DEBIAN_FRONTEND": "noninteractive"},
    )
    seconds = round(time.monotonic() - begun, 1)
    if done.returncode:
        said = (done.stdout + done.stderr)[-2000:]
        print(f"{' '.join(command)}: exit code {done.returncode}\n{said}", flush=True)
    return {"code": done.returncode, "out": done.stdout, "err": done.stderr, "seconds": seconds}


def run_as(user: str, *command: str) -> dict[str, Any]:
    """The same as another user, with what a login gives."""
    uid = pwd.getpwnam(user).pw_uid
    login = (f"XDG_RUNTIME_DIR=/run/user/{uid}", f"HOME=/home/{user}")
    return run("runuser", "-u", user, "--", "env", *login, *command)


def wait_for(condition: Callable[[], Any], patience_s: float = PATIENCE_S) -> Any:
    """Waits until the condition is true; what it then gives.

    Raises:
        TimeoutError: it did not become true.
    """
    deadline = time.monotonic() + patience_s
    while not (found := condition()):
        if time.monotonic() > deadline:
            raise TimeoutError(f"{condition} did not become true in {patience_s} s")
        time.sleep(0.05)
    return found


def find_pad(player: int = 1) -> str | None:
    """The event node of a player's pad."""
    for node in Path("/sys/class/input").glob("event*"):
        try:
            if (node / "device/phys").read_text().strip() == f"{PAD}{player - 1}":
                return f"/dev/input/{node.name}"
        except OSError:
            continue
    return None


def show(*properties: str, service: str = SERVICE) -> dict[str, str]:
    """What systemd knows of the service."""
    wanted = ",".join(properties)
    said = run("systemctl", "show", service, f"--property={wanted}")["out"]
    return dict(line.split("=", 1) for line in said.splitlines() if "=" in line)


def read_exposure(service: str) -> float:
    """Of 10, how much of the system a fault of the service would reach, as systemd judges."""
    *_, said = run("systemd-analyze", "security", "--no-pager", service)["out"].splitlines()
    return float(said.split(":")[1].split()[0])


def main_pid() -> int:
    """The service's process, 0 if there is none."""
    return int(show("MainPID").get("MainPID", "0") or 0)


def read_status(pid: int) -> dict[str, str]:
    """``/proc/PID/status``."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return {name: value.strip() for name, _, value in (line.partition(":") for line in lines)}


def describe_node(path: str) -> dict[str, Any]:
    """Owner, mode and access control list of a node."""
    found = Path(path).stat()
    acl = ""
    if shutil.which("getfacl"):
        acl = run("getfacl", "--absolute-names", "--omit-header", path)["out"]
    return {
        "mode": oct(stat.S_IMODE(found.st_mode)),
        "uid": found.st_uid,
        "gid": found.st_gid,
        "acl": [line for line in acl.splitlines() if line],
    }


class Reader:
    """Reads the pad as any program would, each event with the kernel's monotonic time.

    Attributes:
        events: (time in s, type, code, value).
        ended: why it ended, None while it lasts.
    """

    def __init__(self, node: str) -> None:
        self.node = node
        self.events: list[tuple[float, int, int, int]] = []
        self.ended: str | None = None
        self._descriptor = os.open(node, os.O_RDONLY)
        fcntl.ioctl(self._descriptor, _EVIOCSCLOCKID, struct.pack("i", time.CLOCK_MONOTONIC))
        threading.Thread(target=self._read, daemon=True).start()

    def pressed(self) -> dict[Control, int]:
        """Every key and axis that is not at rest, by type and code."""
        values: dict[Control, int] = {}
        for _, kind, code, value in list(self.events):
            if kind in (EV_KEY, EV_ABS):
                values[kind, code] = value
        return {control: value for control, value in values.items() if value}

    def is_pushed(self) -> bool:
        """The push is far out: more than half of the stick's way."""
        return any(abs(value) > 16000 for value in self.pressed().values())

    def is_neutral(self) -> bool:
        """Nothing is pressed or moved."""
        return not self.pressed()

    def neutral_after(self, since_s: float) -> float:
        """When the pad was neutral to stay, in s after a moment.

        Raises:
            TimeoutError: it is not.
        """
        wait_for(self.is_neutral)
        return self.events[-1][0] - since_s

    def first_neutral_after(self, since_s: float) -> float:
        """When nothing was pressed or moved for the first time, in s after a moment.

        Raises:
            TimeoutError: that has not come.
        """
        return float(wait_for(lambda: self._find_neutral(since_s))) - since_s

    def _find_neutral(self, since_s: float) -> float | None:
        pressed: set[Control] = set()
        at_s = since_s
        for time_s, kind, code, value in list(self.events):
            if time_s > since_s and not pressed:
                break
            if kind in (EV_KEY, EV_ABS):
                (pressed.add if value else pressed.discard)((kind, code))
            at_s = max(since_s, time_s)
        return None if pressed else at_s

    def _read(self) -> None:
        try:
            while True:
                data = os.read(self._descriptor, 64 * _EVENT.size)
                for seconds, micros, kind, code, value in _EVENT.iter_unpack(data):
                    self.events.append((seconds + micros / 1e6, kind, code, value))
        except OSError as error:
            self.ended = os.strerror(error.errno)
        finally:
            os.close(self._descriptor)


def _plain_environment() -> dict[str, str]:
    """As of a login: nothing of the checkout."""
    ours = ("PYTHONPATH", "NUMBA_CACHE_DIR", "PYTHONDONTWRITEBYTECODE")
    return {name: value for name, value in os.environ.items() if name not in ours}
