"""A file that takes its name only when it is complete."""

import os
from pathlib import Path

from neurotouch_hid.errors import RecordingError


class PartialFile:
    """A temporary file beside ``path``; ``commit`` moves it there in one step.

    The temporary name is that of the process too, so two writers never share it.

    Raises:
        RecordingError: the folder is missing or cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.partial = path.with_name(f".{path.stem}.{os.getpid()}.partial{path.suffix}")
        try:
            self.partial.touch()
        except OSError as error:
            raise RecordingError(
                f"'{path}' cannot be written: {error.strerror}.",
                hint="Choose a folder that exists and that you may write to.",
            ) from error

    def commit(self) -> None:
        """Gives the file its name, replacing an older one.

        Raises:
            RecordingError: the file system refuses.
        """
        try:
            self.partial.replace(self.path)
        except OSError as error:
            self.discard()
            raise RecordingError(f"'{self.path}' cannot be written: {error.strerror}.") from error

    def discard(self) -> None:
        """Removes the temporary file."""
        self.partial.unlink(missing_ok=True)
