"""Opens a link in the person's browser, quietly."""

import os
import shutil
import subprocess
import webbrowser


def open_link(link: str) -> bool:
    """Opens a link; returns False if no program for it was found, or it failed.

    Where no desktop has a program of its own for that, xdg-open becomes the browser, and this
    returns only when the browser ends.
    """
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    opener = shutil.which("xdg-open")
    if opener is None:
        return webbrowser.open(link)
    done = subprocess.run(  # noqa: S603  # its own complaints say nothing to a person
        [opener, link],
        check=False,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # Ctrl-C ends our page, not the browser
    )
    return done.returncode == 0
