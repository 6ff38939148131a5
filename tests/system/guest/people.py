"""Two people at one machine: each one's settings apply while that person sits there."""

from pathlib import Path
from typing import Any

from tests.system.guest.desk import Desk
from tests.system.guest.observation import (
    D_PAD,
    GEAR,
    PLAYER,
    SERVICE,
    STICK,
    run,
    run_as,
    wait_for,
)

OTHER = "visitor"
_LOGIN = """\
[Service]
ExecStart=
ExecStart=-/sbin/agetty --autologin {user} --noclear %I linux
"""


def share(desk: Desk) -> dict[str, Any]:
    """The player saves a choice, a visitor too; then the seat goes back and forth."""
    reader = desk.play_until_pushed()
    saw: dict[str, Any] = {"player": _use(PLAYER, "racing")}
    wait_for(lambda: GEAR in reader.pressed())
    node = desk.identity()
    _log_in(OTHER)
    wait_for(lambda: _find_session(OTHER))
    run("loginctl", "activate", _find_session(PLAYER))
    wait_for(lambda: _is_active(PLAYER))
    saw["refused"] = _use(OTHER, "platformer")
    wait_for(reader.is_neutral)
    wait_for(lambda: GEAR in reader.pressed())
    saw["not_theirs"] = D_PAD not in reader.pressed()

    # What was saved meanwhile is handed over by the program of the visitor's session.
    run("loginctl", "activate", _find_session(OTHER))
    wait_for(lambda: D_PAD in reader.pressed())
    saw["visitor"] = sorted(reader.pressed())
    saw["status"] = run_as(OTHER, "neurotouch", "status")["out"]

    run("loginctl", "activate", _find_session(PLAYER))
    wait_for(lambda: GEAR in reader.pressed())
    wait_for(lambda: D_PAD not in reader.pressed())
    saw["same"] = node == desk.identity() and reader.ended is None

    saw["undone"] = run_as(PLAYER, "neurotouch", "profile", "undo", "user")
    run("systemctl", "restart", SERVICE)
    reader = desk.play_until_pushed()
    saw["in_the_end"] = STICK in reader.pressed()
    desk.forget_choice()
    _forget(OTHER)
    return saw


def _use(user: str, profile: str) -> dict[str, Any]:
    return run_as(user, "neurotouch", "profile", "use", profile)


def _log_in(user: str) -> None:
    """Gives the machine a second person, logged in at its second console."""
    run("useradd", "--create-home", "--shell", "/bin/bash", user)
    run("passwd", "--delete", user)
    folder = Path("/run/systemd/system/getty@tty2.service.d")
    folder.mkdir(parents=True)
    (folder / "autologin.conf").write_text(_LOGIN.format(user=user))
    run("systemctl", "daemon-reload")
    run("systemctl", "start", "getty@tty2.service")


def _forget(user: str) -> None:
    run("systemctl", "stop", "getty@tty2.service")
    run("loginctl", "terminate-user", user)
    wait_for(lambda: run("userdel", "--remove", user)["code"] == 0)  # once nothing of theirs runs


def _find_session(user: str) -> str:
    """The number of a person's session at a console; empty if there is none."""
    for line in run("loginctl", "list-sessions", "--no-legend")["out"].splitlines():
        words = line.split()
        if words[2:4] == [user, "seat0"]:
            return words[0]
    return ""


def _is_active(user: str) -> bool:
    return "State=active" in run("loginctl", "show-session", _find_session(user))["out"]
