"""Checks the page and the terminal."""

import os
import shutil
import socket
import stat
import sys

from neurotouch_hid.doctor.finding import Finding, approve, fail, warn
from neurotouch_hid.page.address import find_address_file, read_address
from neurotouch_hid.page.server import PORT


def check_page() -> Finding:
    """Checks whether the page's port is free, and its secret readable by its owner only."""
    file = find_address_file()
    if file.exists() and stat.S_IMODE(file.stat().st_mode) & 0o077:
        return fail(
            f"Other users can read {file}, which contains the secret of the live view.",
            "Make it readable for yourself only, and start 'neurotouch view' again.",
            f"chmod 600 {file}",
        )
    serving = read_address()
    if serving is not None:
        return approve(f"The live view is served at {serving.url} (PID {serving.pid}).")
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", PORT))
        except OSError as error:
            return warn(
                f"Port {PORT} for the live view is not free: {error.strerror}.",
                "'neurotouch view' uses another one automatically; or choose one with --port.",
            )
    return approve(f"Port {PORT} for the live view is free.")


def check_terminal() -> Finding:
    """Checks how the program writes on this terminal."""
    name, width = os.environ.get("TERM", "none"), shutil.get_terminal_size().columns
    plain = os.environ.get("NT_ACCESSIBLE", "0") not in ("", "0") or name == "dumb"
    if not sys.stdout.isatty():
        return approve("No terminal: one fact on each line, no colour.")
    colour = "without" if plain or os.environ.get("NO_COLOR") else "with"
    how = "one fact on each line, for screen readers" if plain else f"{width} columns"
    sentence = f"Terminal {name}: {how}, {colour} colour."
    if not plain and width < 60:
        return warn(sentence, "Make the window wider, or use --plain.")
    return approve(sentence)
