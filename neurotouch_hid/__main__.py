"""``python -m neurotouch_hid`` is the same as the ``neurotouch`` command: it starts here."""

import gc
import os
import signal
import sys

_EXIT_INTERRUPTED = 130


def main() -> None:
    """Runs the command line and ends the process with the documented exit code.

    The orders one gives in need take a way of their own, which imports next to nothing.
    """
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:  # as in the background
        signal.signal(signal.SIGINT, _leave)
    if sys.argv[1:] in (["pause"], ["resume"], ["panic"]):
        from neurotouch_hid.cli.order import give_order

        sys.exit(give_order(sys.argv[1]))
    # While a program is loaded hardly anything becomes garbage, yet looking for it took 0.2 s.
    gc.set_threshold(100_000)
    # numba loads SciPy's linear algebra where it is installed, which takes 0.2 s of every start.
    # No kernel needs any, and nothing else here needs SciPy: None is "there is no such module".
    sys.modules.setdefault("scipy", None)  # type: ignore[arg-type]
    from neurotouch_hid.cli.main import main as run_command_line

    run_command_line()


def _leave(*_: object) -> None:
    """Ctrl-C before the command line itself can handle it: nothing is open yet, so just end."""
    os._exit(_EXIT_INTERRUPTED)


if __name__ == "__main__":
    main()
