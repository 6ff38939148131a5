"""Shows a message on the desktop to a person who has started a program without a terminal."""

import shutil
import subprocess
import sys
from contextlib import suppress
from typing import Final

_SERVICE: Final = "org.freedesktop.Notifications"
_PATIENCE_S: Final = 5.0


def notify(title: str, text: str) -> None:
    """Shows a message where nobody reads our output; it stays until the person closes it.

    It goes to the session's notification service (Desktop Notifications Specification), through
    systemd's ``busctl``. Without a session, a service or systemd, nothing is shown.

    Args:
        title: a few words.
        text: plain sentences.
    """
    busctl = shutil.which("busctl")
    if sys.stderr.isatty() or busctl is None:
        return
    call = [busctl, "--user", "call", _SERVICE, f"/{_SERVICE.replace('.', '/')}", _SERVICE]
    for character, name in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;")):
        text = text.replace(character, name)  # some services read the text as markup
    icon, no_actions, no_hints, never_expires = "input-gaming", "0", "0", "0"
    message = ["NeuroTouch", "0", icon, title, text, no_actions, no_hints, never_expires]
    with suppress(OSError, subprocess.TimeoutExpired):
        subprocess.run(  # noqa: S603 -- a program of the system, with words of our own
            [*call, "Notify", "susssasa{sv}i", *message],
            check=False,
            capture_output=True,
            timeout=_PATIENCE_S,
        )
