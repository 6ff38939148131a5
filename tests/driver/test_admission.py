"""Who sits at the machine. A whole Debian with somebody at it is in tests/system."""

import pwd
import shutil
import subprocess

from neurotouch_hid.driver.admission import find_seated_users


def ask_logind(*question: str) -> list[str]:
    """What loginctl says, in lines; nothing where there is no logind."""
    if not shutil.which("loginctl"):
        return []
    said = subprocess.run(["loginctl", *question], capture_output=True, text=True, check=False)
    return said.stdout.split()


def test_they_are_the_users_that_loginctl_shows_at_a_seat():
    users = set()
    for seat in ask_logind("list-seats", "--no-legend"):
        for session in ask_logind("show-seat", seat, "--property=ActiveSession", "--value"):
            names = ask_logind("show-session", session, "--property=Name", "--value")
            users |= {pwd.getpwnam(name).pw_uid for name in names}
    assert set(find_seated_users()) == users
