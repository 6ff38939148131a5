"""The questions and answers of ``neurotouch profile edit user``."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.profile.drafts import keep_draft
from neurotouch_hid.cli.profile.saving import offer_saving
from neurotouch_hid.cli.ui.outcome import show_faults
from neurotouch_hid.cli.ui.output import choose, echo, say, show_changes
from neurotouch_hid.errors import ProfileError

if TYPE_CHECKING:
    from neurotouch_hid.profile.editing import EditedFile, ProfileText

_ASKED = (
    "timing",
    "filter",
    "handedness",
    "mirror",
    "rotate_deg",
    "neutral",
    "fatigue",
    "feedback.sound",
)
"""What people choose; ranges and what they do not use come from calibration."""


def ask_values(edited: "EditedFile", text: "ProfileText", draft: Path, *, plain: bool) -> bool:
    """Asks for one value after the other until the person is done, and returns True.

    Where it cannot be saved, or on Ctrl-C, a draft is kept.

    Raises:
        ProfileError: there are errors already.
    """
    with keep_draft(draft, edited, lambda: text):
        while (number := _ask_which(edited, text)) < len(_ASKED):
            text = _ask(edited, text, _ASKED[number], plain=plain)
        offer_saving(edited, text, plain=plain)
    return True


def _ask_which(edited: "EditedFile", text: "ProfileText") -> int:
    """Returns the index of the value to change; behind the last one: the person is done."""
    from neurotouch_hid.profile.editing import format_value

    settings = edited.check(text).require()
    shown = []
    for key in _ASKED:
        value: object = settings
        for part in key.split("."):
            value = getattr(value, part)
        plainly = value.model_dump(exclude_none=True) if hasattr(value, "model_dump") else value
        shown.append(f"{key}: {'the default' if value is None else format_value(plainly)}")
    return choose("Your own values: what do you want to change?", [*shown, "Done"])


def _ask(edited: "EditedFile", text: "ProfileText", key: str, *, plain: bool) -> "ProfileText":
    """Returns the text with another value; unchanged if the value does not fit."""
    from neurotouch_hid.profile import UserSettings
    from neurotouch_hid.profile.editing import (
        compare,
        list_words,
        parse_value,
        reset_value,
        set_value,
    )
    from neurotouch_hid.profile.schema import Feedback, Timing

    fields = {
        **UserSettings.model_fields,
        "timing": Timing.model_fields["preset"],
        "feedback.sound": Feedback.model_fields["sound"],
    }
    field = fields[key]
    echo(UserSettings.model_fields.get(key, field).description or "")
    words = list_words(field.annotation)
    try:
        value = ask_value(words)
        if value is None:
            return text
        if value:
            changed = set_value(text, key, parse_value(value), UserSettings)
        else:
            changed = reset_value(text, key, UserSettings)
    except ProfileError as error:
        say("FAILED", error.message, error.hint or "", plain=plain)
        return text
    checked = edited.check(changed)
    if checked.whole is None:
        show_faults(checked, plain=plain)
        echo("That does not fit, nothing has changed.")
        return text
    show_changes(compare(text, changed), plain=plain)
    return changed


def ask_value(words: Sequence[str]) -> str | None:
    """Asks for a value; returns it, nothing for the default, or None if the person goes back.

    Args:
        words: the values there are; empty if any can be typed.
    """
    if words:
        at = choose("Which?", [*words, "The default", "Back"])
        return [*words, "", None][at]
    question = "Value, 'default' for the default, or nothing to go back"
    value = str(click.prompt(question, default="", show_default=False)).strip()
    return None if not value else "" if value == "default" else value
