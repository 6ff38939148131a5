"""Deletes a person's own profile, which ``undo`` brings back."""

from collections.abc import Collection
from pathlib import Path

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.players import PLAYERS, find_user_file
from neurotouch_hid.profile.editing.edited_file import EditedFile, Stamp, find_own_path
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.editing.store import Store
from neurotouch_hid.profile.reading.library import (
    OWN_VALUES,
    find_profile,
    find_user_folder,
    list_profile_folders,
    list_profiles,
)
from neurotouch_hid.profile.reading.load import check_profile, load_user


def delete_profile(name: str, stamp: Stamp, played: Collection[str] = ()) -> Path | None:
    """Deletes a profile of the person's own; it stays among the versions of that name.

    Args:
        name: the profile.
        stamp: the present moment, for the name of the version.
        played: profiles that are needed now, beside the favourites.

    Returns:
        The profile that has this name from now on, which was hidden before; None without one.

    Raises:
        ProfileError: it is not the person's own, it is needed, or it cannot be deleted.
    """
    if name == OWN_VALUES:
        raise ProfileError(
            "'user' is what your own values are called, and no profile.",
            hint="Go back to the default of one: neurotouch profile set user KEY --default",
        )
    if find_profile(name) != find_user_folder() / f"{name}.yaml":
        raise ProfileError(
            f"'{name}' is not your own profile, so it is never deleted.",
            hint="See which are yours: neurotouch profile list",
        )
    own = find_own_path(name)
    rest = [folder / own.name for folder in list_profile_folders()[1:]]
    hidden = next((path for path in rest if path.is_file()), None)
    if hidden is None:
        _require_unneeded(name, played)
    Store(own, stamp).delete()
    return hidden


def take_deleted(name: str, stamp: Stamp) -> EditedFile | None:
    """Returns a deleted profile to be looked at or brought back; None if it was not deleted."""
    if "/" in name or name == OWN_VALUES or name in list_profiles():
        return None
    try:
        store = Store(find_own_path(name), stamp)
    except ProfileError:  # no name at all
        return None
    return EditedFile(name, store, None, ProfileText("")) if store.versions() else None


def _require_unneeded(name: str, played: Collection[str]) -> None:
    """Makes sure that nothing is left that names the profile.

    Raises:
        ProfileError: a player's favourites, a driver, or another profile does.
    """
    for player in map(int, PLAYERS):
        slots = load_user(player=player).slots if find_user_file(player).exists() else []
        if name in slots:
            raise _refuse_favourite(name, slots, player)
    if name in played:
        raise ProfileError(
            f"'{name}' is the active profile.",
            hint="Choose another: neurotouch profile use default",
        )
    for other, path in list_profiles().items():
        written = check_profile(path).written if other != name else None
        if written is not None and name in written.extends:
            raise ProfileError(
                f"Your profile '{other}' is built on '{name}'.",
                hint=f"Delete that one first: neurotouch profile delete {other}",
            )


def _refuse_favourite(name: str, slots: list[str], player: int) -> ProfileError:
    others = [slot for slot in slots if slot != name]
    whose = "" if player == 1 else f" of player {player}"
    command = f"NEUROTOUCH_PLAYER={player} neurotouch" if player > 1 else "neurotouch"
    if name == slots[0]:
        return ProfileError(
            f"'{name}' is the active profile{whose}.",
            hint=f"Choose another, then take this one out of the favourites: {command} profile set "
            f"user slots {','.join(others or ['default'])}",
        )
    return ProfileError(
        f"'{name}' is among the favourites{whose}.",
        hint=f"Take it out: {command} profile set user slots {','.join(others)}",
    )
