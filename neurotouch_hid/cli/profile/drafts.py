"""Drafts: texts that were begun and not saved, kept beside the profiles."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.output import echo, say
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.partial_file import write_whole

if TYPE_CHECKING:
    from neurotouch_hid.profile.editing import EditedFile, ProfileText


def find_draft(edited: "EditedFile") -> Path:
    """Returns the path of a profile's draft; it need not exist."""
    return edited.store.path.parent / ".drafts" / edited.store.path.name


def save_draft(draft: Path, text: "ProfileText") -> None:
    """Keeps a text that was not saved, and says where."""
    write_draft(draft, text)
    say("WARNING", f"Not saved; the draft is in {draft}")
    echo(f"Go on with it: neurotouch profile edit {draft.stem}")


def write_draft(draft: Path, text: "ProfileText") -> None:
    """Writes a text into the place of a draft.

    Raises:
        NeuroTouchError: it cannot be written.
    """
    try:
        draft.parent.mkdir(parents=True, exist_ok=True)
        write_whole(draft, text.text.encode())
    except OSError as error:
        raise NeuroTouchError.of_writing(draft, error) from None


@contextmanager
def keep_draft(
    draft: Path, edited: "EditedFile", find_text: "Callable[[], ProfileText]"
) -> Iterator[None]:
    """Keeps what was changed if the block cannot save it, or the person leaves it by Ctrl-C.

    Args:
        draft: where it is kept.
        edited: the file as it was.
        find_text: returns the text as it is now.
    """
    try:
        yield
    except (click.Abort, KeyboardInterrupt, NeuroTouchError):
        if find_text() != edited.text:
            save_draft(draft, find_text())
        else:
            draft.unlink(missing_ok=True)
        raise
