"""All errors that a person can meet.

The exit codes of the command line::

    NeuroTouchError            1   anything else that we can explain
    ├── EndOfInputError        1   the standard input has ended before a question was answered
    ├── SourceError            3   a source cannot be opened or has failed
    │   ├── CameraError        3   the camera cannot be found, opened or used
    │   │   └── CameraBusyError  75  another program has the camera, which goes on undisturbed
    │   └── GelNotFoundError   5   the source works, but no gel is in the picture
    ├── RecordingError         4   a recording or its labels cannot be read or written
    ├── ProfileError           6   a profile cannot be loaded (file, line, column)
    ├── DeviceError            7   the virtual gamepad cannot be made or written
    ├── PageError              1   the local web page cannot be served
    ├── StreamError            1   states cannot be sent to other programs
    ├── PluginError            1   a method or source of another package cannot be used
    ├── DesktopError           1   the desktop does not say which window is active
    └── DriverError            8   the running driver cannot be reached, refuses or does not end
        ├── NotRunningError    8   no driver is running
        └── AlreadyRunningError  75  another driver is running, which goes on undisturbed

The command line adds 0 (done), 2 (wrong usage) and 130 (Ctrl-C before the work was done).
"""

from pathlib import Path
from typing import Self

from neurotouch_hid.printable import make_lines_printable


class NeuroTouchError(Exception):
    """A failure with one clear sentence for the user and, if there is one, a fix.

    Whatever the sentence quotes is made printable here, once for all places that show it.
    """

    exit_code = 1

    def __init__(self, message: str, *, hint: str | None = None) -> None:
        self.message = make_lines_printable(message)
        self.hint = None if hint is None else make_lines_printable(hint)
        super().__init__(self.message)

    @classmethod
    def of_writing(cls, path: Path, error: OSError) -> Self:
        """Returns the error about a file or folder that cannot be written.

        Args:
            path: as the person calls it.
            error: what the system said.
        """
        from neurotouch_hid.partial_file import suggest_fix  # noqa: PLC0415  # a panic needs none

        return cls(f"'{path}' cannot be written: {error.strerror}.", hint=suggest_fix(error))


class EndOfInputError(NeuroTouchError):
    """A question cannot be answered, because the standard input has ended."""

    def __init__(self) -> None:
        super().__init__(
            "The input has ended, so no more questions can be answered.",
            hint="Answer in a terminal. Ctrl-D ends the input, Ctrl-C the command.",
        )


class SourceError(NeuroTouchError):
    """A source of events cannot be opened or has failed."""

    exit_code = 3


class CameraError(SourceError):
    """The camera cannot be found, opened, set up or read."""


class CameraBusyError(CameraError):
    """Another program uses the camera."""

    exit_code = 75


class GelNotFoundError(SourceError):
    """Frames arrive, but the gel's markers are not in them."""

    exit_code = 5


class RecordingError(NeuroTouchError):
    """A recording, its labels or its rig file cannot be read or written."""

    exit_code = 4


class ProfileError(NeuroTouchError):
    """A profile cannot be loaded; the message has ``file:line:column`` and the marked line."""

    exit_code = 6


class DeviceError(NeuroTouchError):
    """The virtual gamepad cannot be created or written."""

    exit_code = 7


class PageError(NeuroTouchError):
    """The local web page cannot be served."""


class DriverError(NeuroTouchError):
    """The running driver cannot be reached, refuses, or does not end."""

    exit_code = 8


class NotRunningError(DriverError):
    """No driver of this user is running."""


class AlreadyRunningError(DriverError):
    """Another driver of this user is running; 75 is what sysexits.h calls a temporary failure."""

    exit_code = 75


class DesktopError(NeuroTouchError):
    """The desktop does not say which window is active."""


class StreamError(NeuroTouchError):
    """States cannot be sent to other programs: a library or the address is missing."""


class PluginError(NeuroTouchError):
    """A method or a source of another package cannot be used."""


def require_type(name: str, value: object, kind: type | tuple[type, ...], wanted: str) -> None:
    """Checks the type of an argument; True and False are no numbers.

    Args:
        name: the argument's.
        value: what was given.
        kind: what it must be.
        wanted: the same in words, with an example.

    Raises:
        TypeError: it is something else.
    """
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        raise TypeError(f"{name} must be {wanted}, not {type(value).__name__}: {value!r}")
