"""Drafts: texts that were begun and not saved, kept beside the profiles."""

from pathlib import Path
from typing import TYPE_CHECKING

from neurotouch_hid.cli.ui.output import echo, say
from neurotouch_hid.partial_file import write_whole

if TYPE_CHECKING:
    from neurotouch_hid.profile.editing import EditedFile, ProfileText


def find_draft(edited: "EditedFile") -> Path:
    """Returns the path of a profile's draft; it need not exist."""
    return edited.store.path.parent / ".drafts" / edited.store.path.name


def save_draft(draft: Path, text: "ProfileText") -> None:
    """Keeps a text that was not saved, and says where."""
    draft.parent.mkdir(parents=True, exist_ok=True)
    write_whole(draft, text.text.encode())
    say("WARNING", f"Not saved; the draft is in {draft}")
    echo(f"Go on with it: neurotouch profile edit {draft.stem}")
