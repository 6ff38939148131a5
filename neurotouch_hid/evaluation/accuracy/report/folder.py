"""Writes the folder of a report: complete or not at all, and never over other files."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from neurotouch_hid.errors import NeuroTouchError

PAGE, NUMBERS, FIGURES = "report.html", "report.json", "figures"


def check_folder(folder: Path) -> None:
    """Checks before the long work that a report can be written; creates the folders above it.

    Raises:
        NeuroTouchError: it cannot be written, or other files would be lost.
    """
    folder = folder.resolve()
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        is_taken = folder.exists() and not _is_replaceable(folder)
        TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}-").cleanup()
    except OSError as error:
        raise NeuroTouchError.of_writing(folder, error) from error
    if is_taken:
        raise NeuroTouchError(
            f"'{folder}' contains files that are not part of a report.",
            hint="Name a new folder; only an empty one or an older report is replaced.",
        )


@contextmanager
def fill_folder(folder: Path) -> Iterator[Path]:
    """Yields a new empty folder; it is moved into place at the end, removed on error.

    Raises:
        NeuroTouchError: see ``check_folder``; or the disk is full.
    """
    check_folder(folder)
    folder = folder.resolve()
    try:
        with TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}-") as beside:
            new = Path(beside) / "new"
            (new / FIGURES).mkdir(parents=True)
            yield new
            if folder.exists():
                folder.rename(Path(beside) / "old")
            new.rename(folder)
    except OSError as error:
        raise NeuroTouchError.of_writing(folder, error) from error


def _is_replaceable(folder: Path) -> bool:
    """Returns True for an empty folder and for a report without added files."""
    names = {entry.name for entry in folder.iterdir()}
    if not names:
        return True
    figures = (folder / FIGURES).iterdir() if FIGURES in names else ()
    return (
        PAGE in names
        and names <= {PAGE, NUMBERS, FIGURES}
        and all(entry.suffix == ".svg" for entry in figures)
    )
