"""The ``neurotouch`` command itself: finds a sub-command, prints errors, sets the exit code.

Only ``click`` is imported before a sub-command is chosen, so that ``neurotouch --help`` is instant.
"""

import errno
import os
import sys
from typing import Any

import click

from neurotouch_hid import __version__
from neurotouch_hid.cli.ui.group import LazyGroup
from neurotouch_hid.errors import EndOfInputError, NeuroTouchError, PluginError
from neurotouch_hid.printable import make_lines_printable
from neurotouch_hid.process.dead_output import print_error
from neurotouch_hid.process.interrupts import (
    EXIT_INTERRUPTED,
    end_at_next_interrupt,
    handle_interrupts,
)

_OUTPUT_FAULTS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)

_SUMMARIES = {
    "run": "Drive the virtual gamepad from a camera, a recording or the simulator.",
    "demo": "Try it without a camera: a simulated gel drives the pad.",
    "view": "Show the driver live, as a page on this machine.",
    "monitor": "Show the driver live, in the terminal.",
    "stream": "Send gestures to other programs: OSC, WebSocket, LSL, ROS 2.",
    "game": "Fly the spacecraft with the gel, in your browser.",
    "pause": "Release everything and stop acting until you resume.",
    "resume": "Continue after a pause or a panic.",
    "panic": "Release everything and stay released until you resume.",
    "stop": "End the running driver; everything is released first.",
    "reload": "Make the running driver load its profile again.",
    "status": "Show the state of the running driver.",
    "profile": "List profiles, change them, try them, share them.",
    "calibrate": "Measure your own range of each movement, without a time limit.",
    "hello": "Meet a camera for the first time: guided minutes, and one file of what it showed.",
    "gel": "Make a gel of your own: plan, printable files, check.",
    "explain": "Explain the code of a fault.",
    "schema": "Print the JSON Schema of profiles, for editors.",
    "emulate": "Plug in an emulated camera, for people who have none.",
    "label": "Label a recording by hand, at a page: proposals to confirm and correct.",
    "simulate": "Write a simulated data set, recordings with labels.",
    "evaluate": "Measure the recognition on labelled recordings, as the paper does.",
    "bench": "Measure the speed of every stage; how well a person points.",
    "setup": "Install the system's rules for a camera and a pad, if you use pip.",
    "service": "Drive the pad as a service of the system; systemd runs this.",
    "session": "Connect the system's service with this session; systemd runs this.",
    "record": "Record events and frames to an AEDAT4 file, alone or while playing.",
    "devices": "List the cameras and the game controllers of this machine.",
    "doctor": "Check this machine and say how to fix its faults.",
    "diagnostics": "Write one report about this machine for a bug report, without personal data.",
    "completion": "Print the tab completion for bash, zsh or fish.",
}

_CONTROL = ("pause", "resume", "panic", "stop", "reload")


def _find_place(name: str) -> tuple[str, str]:
    """Returns the module of a command, and its name there."""
    if name in _CONTROL:
        return "neurotouch_hid.cli.control", name
    if name == "emulate":
        return "neurotouch_devtools.cli.emulate", "command"
    return f"neurotouch_hid.cli.{name}", "command"


@click.group(
    cls=LazyGroup,
    invoke_without_command=True,
    places={name: _find_place(name) for name in _SUMMARIES},
    summaries=_SUMMARIES,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="\b\nExamples:\n"
    "  neurotouch demo                                  see it work, no camera needed\n"
    "  neurotouch run --profile spacecraft --source file:play.aedat4\n"
    "  neurotouch doctor                                checks this machine",
)
@click.version_option(__version__, prog_name="neurotouch")
@click.pass_context
def cli(ctx: click.Context) -> None:
    """A soft gel that every program sees as a standard game controller.

    Without a command: the present state, the next step and, on a desktop, the page.

    For screen readers: set NT_ACCESSIBLE=1. Then every command prints plain lines without pictures.

    Exit codes: 0 done, 1 other failure, 2 wrong usage, 3 source, 4 recording or labels, 5 no gel in
    the picture, 6 profile, 7 virtual gamepad, 8 no driver runs, or it refuses or does not
    end, 75 another driver runs or another program has the camera, 130 interrupted.
    """
    if ctx.invoked_subcommand is None:
        from neurotouch_hid.cli.ui.welcome import has_desktop, welcome

        welcome()
        if has_desktop():
            from neurotouch_hid.cli.view import command as view

            click.echo("The page opens in your browser. Ctrl-C ends it.")
            ctx.invoke(view, edit=True, open_browser=True)


def main() -> None:
    """Runs the command line and ends the process with the documented exit code."""
    try:
        handle_interrupts()
        code = _run()
        sys.stdout.flush()
    except NeuroTouchError as error:
        if sys.flags.dev_mode and isinstance(error, PluginError) and error.__cause__ is not None:
            raise  # with the traceback of the package's own error
        code = _tell(error.message, error.hint, error.exit_code)
    except click.exceptions.NoArgsIsHelpError as error:
        print_error(error.format_message())
        code = error.exit_code
    except click.UsageError as error:
        from neurotouch_hid.cli.ui.usage_errors import explain_usage

        code = _tell(*explain_usage(error), error.exit_code)
    except (KeyboardInterrupt, click.Abort):
        print_error("Stopped.")
        code = EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader of our output is gone, as in `neurotouch demo | head`: nothing is wrong.
        sys.stdout = None  # nothing left to flush at exit
        code = 0
    except MemoryError:
        code = _tell("There is not enough memory.", "Close other programs, then try again.", 1)
    except RuntimeError as error:
        if "new thread" not in str(error):
            raise
        what = "No thread can be started: too little memory, or too many processes."
        code = _tell(what, "Close other programs, then try again.", 1)
    except OSError as error:
        code = _tell(*_explain_system(error), 1)
        sys.stdout = None
    end_at_next_interrupt()
    sys.exit(code if isinstance(code, int) else 0)


def _explain_system(error: OSError) -> tuple[str, str | None]:
    """Returns what the system refused, and the fix.

    A full disk under ``neurotouch ... > file``, a folder that vanished: files that we open
    ourselves have sentences of their own.
    """
    from neurotouch_hid.partial_file import suggest_fix

    if error.errno in (errno.EMFILE, errno.ENFILE):
        return "Too many files are open.", "Allow more, then try again: ulimit -n 1024"
    if error.filename:
        return f"The file '{error.filename}' cannot be used: {error.strerror}.", suggest_fix(error)
    if error.errno in _OUTPUT_FAULTS:
        return f"The output cannot be written: {error.strerror}.", None
    return f"The system refuses a call: {error.strerror}.", "Find out more: neurotouch doctor"


def _run() -> Any:
    """Runs the command line and returns the exit code.

    Not by click's own ``main``: that ends with 1 where the reader of our output is gone, and takes
    every EOFError for Ctrl-D at one of its questions.

    Raises:
        NeuroTouchError: a question has met the end of the input.
    """
    if "_NEUROTOUCH_COMPLETE" in os.environ:
        from click.shell_completion import add_completion_class

        from neurotouch_hid.cli.ui.shells import Bash, Zsh

        add_completion_class(Bash)
        add_completion_class(Zsh)
        return cli.main(prog_name="neurotouch", standalone_mode=False)
    try:
        with cli.make_context("neurotouch", sys.argv[1:]) as ctx:
            return cli.invoke(ctx)
    except click.exceptions.Exit as end:
        return end.exit_code
    except KeyboardInterrupt:
        print_error("")  # ends the line in which the terminal shows ^C
        raise
    except click.Abort as error:
        if error.__context__ is not None:
            print_error("")  # ends the line of the question
        if isinstance(error.__context__, EOFError):
            raise EndOfInputError from None
        raise


def _tell(message: str, hint: str | None, exit_code: int) -> int:
    """Prints an error and its fix; returns the exit code."""
    print_error(make_lines_printable(f"Error: {message}"))
    if hint:
        print_error(make_lines_printable(f"Fix: {hint}"))
    return exit_code
