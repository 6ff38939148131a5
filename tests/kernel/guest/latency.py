"""Measures the latency through a real event node; in the slow guest only its form says anything."""

import json
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any


def measure(results: Path) -> dict[str, Any]:
    """What ``bench latency`` says of each kind of pad."""
    command = [sys.executable, "-m", "neurotouch_hid", "bench", "latency", "--json"]
    tour = ["--source", f"file:{results / 'tour.aedat4'}", "--seconds", "3"]
    seen: dict[str, Any] = {"kernel": platform.release()}
    for kind in ("uinput", "hid"):
        done = subprocess.run(
            [*command, *tour, "--device", kind], check=True, stdout=subprocess.PIPE, text=True
        )
        seen[kind] = json.loads(done.stdout)
    return seen
