"""Types commands as a person at a terminal does; only the standard library, for the guest's Python.

Runs as root. Reads a list of calls on each line, as JSON, and answers with a line: what came of
each, with its output, exit code and seconds. A call is typed by the ordinary user, unless it says
``root``; ``before`` is typed first in the same home.
"""

import json
import os
import pty
import pwd
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
from functools import partial
from pathlib import Path

ROWS, COLUMNS = 24, 80
LOOK_S = 1.5
"""For so long a command without an end is looked at, after its first words."""
SILENT_S = 30.0
"""In which the first words have come."""
LIMIT_S = 240.0
"""In which all others have ended by themselves."""
COMPILE_S = 900.0
"""In which what compiles for them has ended; how fast that is is not asked."""
END_S = 20.0
"""In which a command has ended after Ctrl-C."""
N_AT_ONCE = 4
"""Of two processors: much of the time a command waits."""

PERSON = pwd.getpwnam("newcomer")
CACHE = Path(PERSON.pw_dir) / ".cache"
"""Compiled once for all homes."""
LABELS = (
    "timestamp_us,gesture,intensity_mm,contacts,x1_px,y1_px,x2_px,y2_px,x3_px,y3_px\n"
    "1000000,push,2,1,300,200,,,,\n"
)
MADE = (
    (
        "neurotouch record play.aedat4 --source sim:tour --seconds 2 --plain",
        "neurotouch simulate play --users 1 --minutes 0.1",
        "neurotouch evaluate play/*push.aedat4 --method neurotouch --method paper",
        "neurotouch hello camera --source file:play.aedat4",
    ),
    (
        "neurotouch profile new mine",
        "neurotouch profile set user filter light",
        "neurotouch profile export mine --output friend.yaml --user me.yaml",
        "neurotouch record clip.mkv --source sim:tour,uvc=60 --seconds 2 --plain",
        "neurotouch simulate frames --users 1 --minutes 0.1 --camera uvc --fps 60 "
        "--nuisance rolling=12 --nuisance doubled",
        "neurotouch evaluate frames/*push.mkv",
    ),
)
"""What makes the files that the examples are about; and compiles, once, what many calls need. Two
processors work through the lists side by side."""


def become(person: pwd.struct_passwd) -> None:
    os.setgroups([])
    os.setgid(person.pw_gid)
    os.setuid(person.pw_uid)


def type_call(wanted: dict, home: str, limit_s: float = LIMIT_S) -> dict:
    """Types a call in a terminal of 80 x 24; waits until it ends, or until Ctrl-C ends it."""
    environment = {
        "PATH": "/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin",
        "HOME": home,
        "TERM": "xterm",
        "LANG": "C.UTF-8",
        "XDG_CACHE_HOME": str(CACHE),
        "XDG_RUNTIME_DIR": home,
        **({"NT_ACCESSIBLE": "1"} if wanted.get("accessible") else {}),
    }
    begun = time.monotonic()
    pid, terminal = pty.fork()
    if pid == 0:
        ioctl(0, termios.TIOCSWINSZ, struct.pack("4H", ROWS, COLUMNS, 0, 0))
        if not wanted.get("root"):
            become(PERSON)
        os.chdir(home)
        os.execve("/bin/sh", ["/bin/sh", "-c", f"exec {wanted['call']}"], environment)
    output, interrupted, code = b"", False, None
    deadline = begun + (SILENT_S if wanted.get("endless") else limit_s)
    while code is None:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                said = os.read(terminal, 65536)
            except OSError:  # the other end is closed
                said = b""
                time.sleep(0.02)
            if said and not output and wanted.get("endless"):
                deadline = time.monotonic() + LOOK_S
            output += said
        ended, status = os.waitpid(pid, os.WNOHANG)
        if ended:
            code = os.waitstatus_to_exitcode(status)
        elif time.monotonic() > deadline:
            if interrupted:
                os.kill(pid, signal.SIGKILL)
            else:
                os.write(terminal, b"\x03")
                interrupted, deadline = True, time.monotonic() + END_S
    while select.select([terminal], [], [], 0)[0]:  # what came just before its end
        try:
            said = os.read(terminal, 65536)
        except OSError:
            break
        if not said:
            break
        output += said
    os.close(terminal)
    return {
        **wanted,
        "code": code,
        "interrupted": interrupted,
        "seconds": round(time.monotonic() - begun, 1),
        "output": output.decode("utf-8", "replace"),
    }


def type_one_by_one(calls: tuple[str, ...], home: Path) -> None:
    """Types calls that must work."""
    for call in calls:
        done = type_call({"call": call, "accessible": True}, str(home), COMPILE_S)
        if done["code"] != 0:
            raise SystemExit(f"{call}: {done['output']}")


def prepare(home: Path) -> None:
    """Makes what the examples are about: recordings, profiles of one's own, files of friends."""
    shutil.copytree("/tmp/things", home, dirs_exist_ok=True)
    own(home)
    with ThreadPoolExecutor(len(MADE)) as pool:
        list(pool.map(partial(type_one_by_one, home=home), MADE))
    type_call({"call": "neurotouch doctor"}, str(home))  # compiles more; there is no camera
    for name in ("me.aedat4", "spin.aedat4", "recording.aedat4"):
        shutil.copy(home / "play.aedat4", home / name)
    shutil.copytree(home / "frames", home / "clips")
    shutil.copy(home / "friend.yaml", home / "draft.yaml")
    for name in ("anna", "ben"):
        (home / f"clip.{name}.labels.csv").write_text(LABELS)
    (home / "moves.txt").write_text("push left 5mm 300ms hold 1s; pinch tap\n")
    own(home)


def own(folder: Path) -> None:
    """Gives a folder and all in it to the ordinary user."""
    for path in (folder, *folder.rglob("*")):
        os.chown(path, PERSON.pw_uid, PERSON.pw_gid)


def main() -> None:
    """Types each call in a copy of the same home."""
    template = Path(tempfile.mkdtemp(prefix="home-"))
    prepare(template)

    def type_apart(wanted: dict) -> dict:
        with tempfile.TemporaryDirectory(prefix="run-") as home:
            shutil.copytree(template, home, dirs_exist_ok=True)
            own(Path(home))
            if "before" in wanted:
                type_call({"call": wanted["before"]}, home)
            return type_call(wanted, home)

    with ThreadPoolExecutor(N_AT_ONCE) as pool:
        for line in sys.stdin:
            print(json.dumps(list(pool.map(type_apart, json.loads(line)))), flush=True)


if __name__ == "__main__":
    main()
