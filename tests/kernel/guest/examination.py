"""The doctor and the list of devices in a real kernel, with pads that are made."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from neurotouch_hid.device import open_device
from neurotouch_hid.doctor import pad, rights
from neurotouch_hid.doctor.finding import Finding
from neurotouch_hid.doctor.inventory import find_pads
from tests.kernel.guest.opening import as_nobody


def look_at_pads(results: Path) -> dict[str, Any]:
    """The rows of the doctor's table that need a kernel with uinput and a running udevd."""
    seen = {
        "module": say(rights.check_module()),
        "right": say(rights.check_pad_right()),
        "right_of_nobody": as_nobody(lambda: say(rights.check_pad_right())),
        "rule": say(rights.check_rule()),
        "loop_back": say(pad.check_loopback()),
        "recognised": say(pad.check_recognition()),
    }
    os.environ["SDL_GAMECONTROLLER_IGNORE_DEVICES"] = "0x045e/0x028e"
    seen["hidden"] = say(pad.check_recognition())
    del os.environ["SDL_GAMECONTROLLER_IGNORE_DEVICES"]
    with open_device("uinput"):
        listed = subprocess.run(
            [sys.executable, "-m", "neurotouch_hid", "devices", "--json"],
            capture_output=True,
            text=True,
            check=True,
        )
        seen["devices"] = json.loads(listed.stdout)
    seen["after"] = len(find_pads())
    return seen


def say(finding: Finding) -> dict[str, Any]:
    """A finding as a test reads it."""
    return {
        "status": str(finding.status),
        "sentence": finding.sentence,
        "fix": finding.fix,
        "commands": list(finding.commands),
    }
