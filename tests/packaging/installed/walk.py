"""Runs commands as a person at a terminal does; only the standard library, for the guest's Python.

Reads a list of calls as JSON, writes what came of each: output, exit code, seconds.
"""

import json
import os
import pty
import select
import shutil
import signal
import struct
import sys
import tempfile
import termios
import time
from concurrent.futures import ThreadPoolExecutor
from fcntl import ioctl
from pathlib import Path

ROWS, COLUMNS = 24, 80
LOOK_S = 7.0
"""For so long a command may run before Ctrl-C."""
END_S = 20.0
"""In which it has ended after Ctrl-C."""
N_AT_ONCE = 2


def run(call: str, home: str, *, accessible: bool, look_s: float = LOOK_S) -> dict:
    """Runs a call in a terminal of 80 x 24 until it ends, or until Ctrl-C ends it."""
    environment = {
        "PATH": "/usr/bin:/bin",
        "HOME": home,
        "TERM": "xterm",
        "LANG": "C.UTF-8",
        "XDG_CACHE_HOME": os.environ["HOME"] + "/.cache",  # compiled once
        "XDG_RUNTIME_DIR": home,
        **({"NT_ACCESSIBLE": "1"} if accessible else {}),
    }
    begun = time.monotonic()
    pid, terminal = pty.fork()
    if pid == 0:
        ioctl(0, termios.TIOCSWINSZ, struct.pack("4H", ROWS, COLUMNS, 0, 0))
        os.chdir(home)
        os.execve("/bin/sh", ["/bin/sh", "-c", f"exec {call}"], environment)
    output, interrupted, code = b"", False, None
    deadline = begun + look_s
    while code is None:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                output += os.read(terminal, 65536)
            except OSError:  # the other end is closed
                time.sleep(0.05)
        ended, status = os.waitpid(pid, os.WNOHANG)
        if ended:
            code = os.waitstatus_to_exitcode(status)
        elif time.monotonic() > deadline:
            if interrupted:
                os.kill(pid, signal.SIGKILL)
            else:
                os.write(terminal, b"\x03")
                interrupted, deadline = True, time.monotonic() + END_S
    os.close(terminal)
    return {
        "call": call,
        "accessible": accessible,
        "code": code,
        "interrupted": interrupted,
        "seconds": round(time.monotonic() - begun, 1),
        "output": output.decode("utf-8", "replace"),
    }


def prepare(home: Path) -> None:
    """Makes what the examples are about: recordings, profiles of one's own, files of friends."""
    for call in (
        "neurotouch record play.aedat4 --source sim:tour --seconds 2 --plain",
        "neurotouch profile new mine",
        "neurotouch profile set user filter light",
        "neurotouch profile export mine --output friend.yaml --user me.yaml",
    ):
        done = run(call, str(home), accessible=True, look_s=240.0)
        if done["code"] != 0:
            raise SystemExit(f"{call}: {done['output']}")
    for name in ("me.aedat4", "spin.aedat4", "recording.aedat4"):
        shutil.copy(home / "play.aedat4", home / name)
    shutil.copy(home / "friend.yaml", home / "mine.yaml")
    shutil.copy(home / "friend.yaml", home / "draft.yaml")
    (home / "moves.txt").write_text("push left 5mm 300ms hold 1s; pinch tap\n")


def main() -> None:
    """Runs each call in a copy of the same home."""
    calls = json.load(sys.stdin)
    template = Path(tempfile.mkdtemp(prefix="home-"))
    prepare(template)

    def run_apart(wanted: dict) -> dict:
        with tempfile.TemporaryDirectory(prefix="run-") as home:
            shutil.copytree(template, home, dirs_exist_ok=True)
            return run(wanted["call"], home, accessible=wanted["accessible"])

    with ThreadPoolExecutor(N_AT_ONCE) as pool:
        json.dump(list(pool.map(run_apart, calls)), sys.stdout)


if __name__ == "__main__":
    main()
