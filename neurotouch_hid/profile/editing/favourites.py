"""The profile a person plays: the first of the favourites."""

from collections.abc import Callable

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.small_file import find_real_path
from neurotouch_hid.profile.editing.edit_values import set_value
from neurotouch_hid.profile.editing.edited_file import EditedFile, take_user
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.reading.library import find_profile, list_profiles
from neurotouch_hid.profile.reading.load import load_profile, load_user
from neurotouch_hid.profile.schema.user import UserSettings

MOST_FAVOURITES = 8


def make_favourite(name: str, stamp: Callable[[], str]) -> tuple[str, EditedFile, ProfileText]:
    """Makes a profile the first of the person's favourites, and saves that.

    No version is kept: to take it back is to use another profile.

    Args:
        name: the profile, by name or path.
        stamp: the present moment, for the names of versions.

    Returns:
        The profile's name, the person's values as they were, and their text now.

    Raises:
        ProfileError: it has errors, is not among the person's profiles, or cannot be saved.
    """
    load_profile(name)
    path = find_profile(name)
    stem = path.stem
    known = list_profiles().get(stem)
    if known is None or find_real_path(known) != find_real_path(path):
        raise ProfileError(
            f"'{path}' is not among your profiles.",
            hint=f"Import it first: neurotouch profile import {name}",
        )
    slots = [stem, *(slot for slot in load_user().slots if slot != stem)]
    edited = take_user(stamp)
    text = set_value(edited.text, "slots", slots[:MOST_FAVOURITES], UserSettings)
    edited.save(text, keep=False)
    return stem, edited, text
