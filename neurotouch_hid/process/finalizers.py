"""Keeps objects of a library from being finalized at the end of the program."""

import weakref


def skip_finalizers(module: str) -> None:
    """Leaves the living objects of a module as they are when the program ends.

    usb1 waits at the end of the program, without limit, for every transfer that it has cancelled.
    One that Linux has lost would keep the program for ever. The list of finalizers is private:
    Python has no public way to reach those of another library's objects.

    Args:
        module: its name, as in ``usb1``.
    """
    for finalizer in list(weakref.finalize._registry):  # type: ignore[attr-defined]
        alive = finalizer.peek()
        if alive and type(alive[0]).__module__ == module:
            finalizer.atexit = False
