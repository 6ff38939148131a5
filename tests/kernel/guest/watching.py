"""Reads our HID pad back with our own command, as a person would."""

import json
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

from neurotouch_hid.device import open_device
from neurotouch_hid.device.inputs.hid_pad_reader import find_hid_pads, read_reports
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Axis, Button, GamepadState
from tests.kernel.guest.opening import as_nobody, run

COMMAND = [sys.executable, "-m", "neurotouch_hid", "devices", "--watch", "--json"]
PATIENCE_S = 200.0
"""The command takes 10 s to start in the guest, if nothing else keeps the host busy."""
STATES = [
    GamepadState(0, frozenset({Button.A, Button.LB})),
    GamepadState(0, axes={Axis.LEFT_X: -1.0, Axis.RIGHT_TRIGGER: 1.0, Axis.DPAD_Y: 1.0}),
    GamepadState(0),
]


def watch(results: Path) -> dict[str, Any]:
    """What ``devices --watch`` prints of a pad, and what it says without one and without rights."""
    without = subprocess.run(COMMAND[:-1], check=False, capture_output=True, text=True)
    with open_device("hid") as pad:
        run("udevadm", "settle", "--timeout=60")
        denied = as_nobody(try_to_read)
        watcher = subprocess.Popen(
            COMMAND, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        limit = threading.Timer(PATIENCE_S, watcher.kill)  # it must not keep the others waiting
        limit.start()
        title = watcher.stderr.readline()
        for state in STATES:
            pad.write(state)
        lines = [json.loads(watcher.stdout.readline()) for _ in STATES]
    rest, said = watcher.communicate(timeout=PATIENCE_S)
    limit.cancel()
    return {
        "without": [without.returncode, without.stderr],
        "denied": denied,
        "title": title,
        "lines": lines,
        "rest": rest,
        "said": said,
        "exit_code": watcher.returncode,
    }


def try_to_read() -> dict[str, str | None]:
    """What a user without rights is told."""
    try:
        read_reports(find_hid_pads()[0])
    except DeviceError as error:
        return {"message": error.message, "hint": error.hint}
    return {"message": "read", "hint": None}
