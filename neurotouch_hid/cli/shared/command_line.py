"""The command line of this process, as results name it."""

import re
import shlex
import sys


def make_command_line() -> str:
    """Returns the command line without folders: a file that is passed on names no person's home."""
    return shlex.join(["neurotouch", *map(strip_folders, sys.argv[1:])])


def strip_folders(word: str) -> str:
    """Returns the word with the last part of a path only; a kind or option before it stays."""
    return re.sub(r"[^=:]*/(?=.)", "", word.rstrip("/"))
