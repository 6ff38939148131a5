"""Checks the system's service, if it is installed."""

import shutil
import subprocess
from typing import Final

from neurotouch_hid.doctor.finding import Finding, approve, fail, skip, warn
from neurotouch_hid.players import SERVICE_UNIT

_UNIT: Final = "neurotouch.service"
_PATIENCE_S: Final = 5.0


def check_service() -> Finding:
    """Checks whether the service is installed and runs."""
    said = _ask_systemd() if shutil.which("systemctl") else {}
    if said.get("LoadState", "not-found") == "not-found":
        reason = "is not installed here"
        if SERVICE_UNIT.exists():
            reason = "does not run here, because systemd does not run"
        return skip(f"The service {reason}; 'neurotouch run' does the same.")
    if said["LoadState"] == "masked":
        return warn(
            "The service is masked: plugging in a camera starts nothing.",
            "If you did not intend that, unmask it.",
            f"sudo systemctl unmask {_UNIT}",
        )
    state = said.get("ActiveState", "unknown")
    restarts = int(said.get("NRestarts", "0") or 0)
    if state == "active":
        words = f", after {restarts} restarts" if restarts else ""
        return approve(f"The service runs (PID {said.get('MainPID', 'unknown')}{words}).")
    if state == "activating" and not restarts:
        return approve("The service is starting.")
    if state == "inactive":
        return approve("The service is installed, and starts when a camera is plugged in.")
    return fail(
        f"The service does not run: {state}, {said.get('Result', 'unknown')}, after {restarts} "
        "restarts.",
        "Its journal says why.",
        f"journalctl --unit {_UNIT} --lines 30 --no-pager",
    )


def _ask_systemd() -> dict[str, str]:
    """Returns the unit's properties; empty where systemd does not run."""
    names = ("LoadState", "ActiveState", "Result", "MainPID", "NRestarts")
    try:
        done = subprocess.run(  # noqa: S603
            ["systemctl", "show", _UNIT, f"--property={','.join(names)}"],  # noqa: S607
            capture_output=True,
            text=True,
            check=False,
            timeout=_PATIENCE_S,
        )
    except subprocess.TimeoutExpired:
        return {}
    return dict(line.split("=", 1) for line in done.stdout.splitlines() if "=" in line)
