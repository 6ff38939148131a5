"""Finds Chromium: the same browser, without its windows, takes half of the processor's time."""

import shutil

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser")
MISSING = "no Chromium here (Debian: apt install chromium-headless-shell)"


def find_program() -> str | None:
    """The path of the first one that is installed."""
    return next(filter(None, map(shutil.which, NAMES)), None)
