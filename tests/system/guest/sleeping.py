"""Installs the package, then sleeps in the middle of gestures, the camera plugged in.

    python -m tests.system.guest.sleeping RESULTS

The shared folders do not survive sleep. So what sleeps runs from the disk and tells what it saw at
the console, in a line that begins with ``SAW``.
"""

import json
import sys
import time
import traceback
from pathlib import Path
from typing import Any

from tests.system.guest.installing import choose_processor, find, lay_kernels
from tests.system.guest.observation import Reader, find_pad, main_pid, run, wait_for

ASLEEP_S = 5
SAW = "SAW "
_HERE = Path("/opt/tests/system")
_ALARM = Path("/sys/class/rtc/rtc0/wakealarm")


def install(results: Path) -> None:
    """Installs the package; starts what sleeps, and says that the camera may be plugged in."""
    choose_processor()
    lay_kernels(results)
    done = run("apt-get", "install", "--yes", find(results))
    _HERE.mkdir(parents=True)
    run("cp", "-r", str(Path(__file__).parent), str(_HERE))
    run("systemd-run", "--working-directory=/opt", "python3", "-m", __spec__.name)
    (results / "installed.json").write_text(json.dumps(done))
    time.sleep(10_000.0)


def sleep() -> dict[str, Any]:
    """Sleeps three times, each time in a gesture."""
    reader, nights = Reader(wait_for(find_pad)), list[dict[str, float]]()
    wait_for(reader.is_pushed)
    before = _identify()
    for _ in range(3):
        wait_for(reader.is_pushed)
        _ALARM.write_text("0")
        _ALARM.write_text(f"+{ASLEEP_S}")
        slept_s = _measure_sleep()
        Path("/sys/power/state").write_text("mem")
        awake_s = time.monotonic()
        night = {
            "slept_s": _measure_sleep() - slept_s,
            "neutral_after_s": reader.first_neutral_after(awake_s),
        }
        wait_for(reader.is_neutral)
        wait_for(reader.is_pushed)
        nights.append({**night, "plays_after_s": time.monotonic() - awake_s})
    return {
        "nights": nights,
        "same": before == _identify(),
        "status": json.loads(run("neurotouch", "status", "--json")["out"]),
    }


def _identify() -> tuple[str | None, int]:
    """The pad's node and the service's process: neither may change."""
    return find_pad(), main_pid()


def _measure_sleep() -> float:
    """Seconds that the machine has slept since it was switched on."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) - time.monotonic()


def main() -> None:
    if sys.argv[1:]:
        install(Path(sys.argv[1]))
        return
    try:
        answer = {"saw": sleep()}
    except Exception:
        look = ("journalctl", "--no-pager", "--lines=40", "--boot", "--output=cat")
        answer = {"failed": traceback.format_exc() + run(*look)["out"]}
    with Path("/dev/ttyS0").open("w") as console:
        console.write(f"\n{SAW}{json.dumps(answer)}\n")


if __name__ == "__main__":
    main()
