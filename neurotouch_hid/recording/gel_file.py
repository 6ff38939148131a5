"""The file of a recording's gel, which says where its dots are."""

from pathlib import Path

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.partial_file import write_whole


def gel_path(recording: Path | str) -> Path:
    """Returns the path of a recording's gel: ``NAME.gel.yaml`` beside ``NAME.aedat4``."""
    return Path(recording).with_suffix(".gel.yaml")


def write_gel(recording: Path, content: bytes) -> None:
    """Writes the gel of a new recording; one that belonged to an older recording goes.

    Args:
        recording: its path.
        content: of the gel's file; empty for the gel of the paper, which needs none.

    Raises:
        RecordingError: it cannot be written.
    """
    write_beside(gel_path(recording), content)


def write_beside(path: Path, content: bytes) -> None:
    """Writes a file that belongs to a new recording; without content, removes an older one.

    Raises:
        RecordingError: it cannot be written.
    """
    try:
        if content:
            write_whole(path, content)
        else:
            path.unlink(missing_ok=True)
    except OSError as error:
        raise RecordingError.of_writing(path, error) from error
