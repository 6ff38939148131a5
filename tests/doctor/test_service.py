"""The service, as systemd tells of it: a script in its place says what systemd 252 says."""

import pytest

from neurotouch_hid.doctor import service
from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.doctor.service import check_service

SAID = {
    "absent": ("not-found", "inactive", "success", 0, 0),
    "starts": ("loaded", "activating", "success", 811, 0),
    "runs": ("loaded", "active", "success", 812, 2),
    "waits": ("loaded", "inactive", "success", 0, 0),
    "masked": ("masked", "inactive", "success", 0, 0),
    "failed": ("loaded", "failed", "exit-code", 0, 7),
    "restarting": ("loaded", "activating", "watchdog", 0, 9),
}
NAMES = ("LoadState", "ActiveState", "Result", "MainPID", "NRestarts")


@pytest.mark.parametrize(
    ("state", "status", "words"),
    [
        ("absent", CheckStatus.SKIPPED, "not installed"),
        ("starts", CheckStatus.OK, "is starting"),
        ("runs", CheckStatus.OK, "PID 812, after 2 restarts"),
        ("waits", CheckStatus.OK, "starts when a camera"),
        ("masked", CheckStatus.WARNING, "masked"),
        ("failed", CheckStatus.FAILED, "failed, exit-code, after 7"),
        ("restarting", CheckStatus.FAILED, "activating, watchdog, after 9"),
    ],
)
def test_what_systemd_says(tmp_path, monkeypatch, state, status, words):
    program = tmp_path / "systemctl"
    said = "\n".join(f"{name}={value}" for name, value in zip(NAMES, SAID[state], strict=True))
    program.write_text(f"#!/bin/sh\n/bin/cat <<END\n{said}\nEND\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    finding = check_service()
    assert finding.status is status
    assert words in finding.sentence


def test_without_systemd(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert check_service().status is CheckStatus.SKIPPED
    (tmp_path / "systemctl").write_text("#!/bin/sh\nexit 1\n")  # there, but not PID 1
    (tmp_path / "systemctl").chmod(0o755)
    assert check_service().status is CheckStatus.SKIPPED


def test_a_service_that_is_installed_without_systemd_is_not_called_absent(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(service, "SERVICE_UNIT", tmp_path / "neurotouch.service")
    (tmp_path / "neurotouch.service").touch()
    assert check_service().sentence == (
        "The service does not run here, because systemd does not run; 'neurotouch run' does the "
        "same."
    )
