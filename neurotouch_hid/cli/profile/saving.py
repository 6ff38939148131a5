"""What every change of a profile ends with: checked, saved, told."""

import sys
from typing import TYPE_CHECKING

from neurotouch_hid.cli.ui.outcome import Outcome
from neurotouch_hid.errors import ProfileError

if TYPE_CHECKING:
    from neurotouch_hid.profile.editing import EditedFile


def save_edited(edited: "EditedFile", text: str, *, plain: bool, as_json: bool = False) -> None:
    """Saves a changed text if it is right, and tells what has changed.

    Raises:
        ProfileError: there are errors, or it cannot be written; nothing has changed. With
            ``as_json`` errors are told, and the process ends with the error's exit code.
    """
    from neurotouch_hid.profile.editing import compare

    path = edited.store.path
    if text == edited.text and edited.content is not None:
        message = f"{edited.name} says so already, nothing has changed."
        Outcome(message, file=path).tell(plain=plain, as_json=as_json)
        return
    checked = edited.check(text)
    try:
        checked.require()
    except ProfileError as error:
        fix = error.hint or "Nothing was saved."
        if not as_json:
            raise ProfileError(error.message, hint=fix) from None
        refused = Outcome("There are errors.", "FAILED", path, checked=checked, fix=fix)
        refused.tell(plain=plain, as_json=True)
        sys.exit(error.exit_code)
    edited.save(text)
    notes = (
        ("This is your own copy; the shipped profile stays as it is.",) if edited.shipped else ()
    )
    saved = Outcome(
        f"Saved {path}",
        file=path,
        changed=True,
        lines=compare(edited.text, text),
        checked=checked,
        notes=notes,
    )
    saved.tell(plain=plain, as_json=as_json)
