"""``neurotouch pause``, ``resume`` and ``panic``: one word to the running driver, at once.

Nothing but the standard library is imported on the way here, not even the command line's own.
"""

import sys

from neurotouch_hid.driver import ask
from neurotouch_hid.errors import DriverError

ORDERS = ("pause", "resume", "panic")


def give_order(order: str) -> int:
    """Tells the driver, prints what it answers, and returns the exit code."""
    try:
        print(ask(order)["text"])
    except DriverError as error:
        print(f"Error: {error.message}", file=sys.stderr)
        if error.hint:
            print(f"Fix: {error.hint}", file=sys.stderr)
        return error.exit_code
    return 0
