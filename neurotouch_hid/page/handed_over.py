"""Passes saved settings to the running driver, and says on the page whether they apply."""

from neurotouch_hid.errors import DriverError
from neurotouch_hid.profile.editing import SavedEffect, hand_over_saved


def pass_on(name: str) -> str:
    """Passes the saved change to the running driver; returns a sentence about the result.

    Args:
        name: the profile, or ``user`` for the person's own values.

    Raises:
        DriverError: the saved change has no effect.
    """
    effect = hand_over_saved(name)
    if effect.status != "OK":
        raise DriverError(f"Saved, but not in use. {effect.said}", hint=effect.fix)
    return describe_effect(effect)


def describe_effect(effect: SavedEffect) -> str:
    """Returns the effect in the page's words: its buttons, where the terminal has commands."""
    if not effect.unused:
        return effect.said
    return f"{effect.said} To play it: choose {effect.unused} under Profile, then 'Play with it'."
