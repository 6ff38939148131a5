#!/usr/bin/python3 -I
"""The ``neurotouch`` command of the Debian package: its libraries are in a separate folder."""

import os
import sys

sys.path.insert(0, "/usr/lib/neurotouch-hid")
# Kernels compiled for this processor go into the cache of the user who runs it, never into /usr.
cache = os.environ.get("XDG_CACHE_HOME", "")
if not os.path.isabs(cache):  # noqa: PTH117 -- sooner there; a relative one is to be ignored
    cache = os.path.expanduser("~/.cache")  # noqa: PTH111
os.environ.setdefault("NUMBA_CACHE_DIR", f"{cache}/neurotouch")

from neurotouch_hid.__main__ import main  # noqa: E402

# A process of the evaluation imports this file again, and must not start the program again.
if __name__ == "__main__":
    main()
