"""``python -m neurotouch_hid`` is the same as the ``neurotouch`` command: it starts here."""

import os
import signal
import sys

_EXIT_INTERRUPTED = 130


def main() -> None:
    """Runs the command line and ends the process with the documented exit code.

    The emergency commands skip the rest of this program, so that they import next to nothing.
    """
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:  # as in the background
        signal.signal(signal.SIGINT, _leave)
    signal.signal(signal.SIGTERM, _leave)
    _replace_closed()
    command, *options = sys.argv[1:] or [""]
    from_menu = options == ["--notify"] and command != "stop"
    if command in ("pause", "resume", "panic", "stop") and (from_menu or not options):
        from neurotouch_hid.cli.shared.send_without_click import send_command

        sys.exit(send_command(command, on_desktop=from_menu))
    from neurotouch_hid.process.startup import (
        collect_rarely,
        hasten_pydantic,
        leave_out_asyncio,
        leave_out_colours,
        leave_out_pydantic_plugins,
        leave_out_scipy,
    )

    collect_rarely()
    leave_out_scipy()
    leave_out_asyncio()
    leave_out_colours()
    leave_out_pydantic_plugins()
    hasten_pydantic()
    from neurotouch_hid.cli.main import main as run_command_line

    run_command_line()


def _replace_closed() -> None:
    """Puts /dev/null where the input or an output is closed, as after ``neurotouch >&-``.

    Python has None there, and the next file that is opened would become the output.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            descriptor = os.open(os.devnull, os.O_RDWR)  # gets the lowest free number: that one
            os.set_inheritable(descriptor, True)
            setattr(sys, name, os.fdopen(descriptor, mode))


def _leave(*_: object) -> None:
    """Ends on Ctrl-C or SIGTERM before the command line can handle it: nothing is open yet."""
    try:  # noqa: SIM105  # contextlib would be one import more before Ctrl-C is handled
        os.write(2, b"Stopped.\n")
    except OSError:  # the terminal is gone
        pass
    os._exit(_EXIT_INTERRUPTED)


if __name__ == "__main__":
    main()
