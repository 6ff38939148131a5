"""Measures the latency through a real event node; in the slow guest only its form says anything."""

import io
import json
import platform
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from neurotouch_devtools.cli.latency import command


def measure(results: Path) -> dict[str, Any]:
    """What ``bench latency`` says of each kind of pad."""
    tour = ["--source", f"file:{results / 'tour.aedat4'}", "--seconds", "3"]
    seen: dict[str, Any] = {"kernel": platform.release()}
    for kind in ("uinput", "hid"):
        with redirect_stdout(io.StringIO()) as said:
            command.main([*tour, "--device", kind, "--json"], standalone_mode=False)
        seen[kind] = json.loads(said.getvalue())
    return seen
