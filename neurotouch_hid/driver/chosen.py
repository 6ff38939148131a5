"""Which profile and whose values apply when nobody has asked for another profile yet."""

from typing import NamedTuple

from neurotouch_hid.driver.people import Person
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile import Profile, UserSettings, load_profile, load_user


class Chosen(NamedTuple):
    """A profile, the name it was asked for by, and the values it is played with."""

    name: str
    profile: Profile
    user: UserSettings


def load_chosen(person: Person | None, default: str | None, player: int | None) -> Chosen:
    """Returns what applies to a person.

    Args:
        person: who is at the machine, for a service; None: this process's user.
        default: the profile for a person who has chosen no favourite; None: the first favourite.
        player: the player number; None means the one of the environment.

    Raises:
        ProfileError: a file cannot be used.
    """
    folder = None if person is None else person.folder
    user = load_user(player=player, folder=folder)
    chooses = (
        person is not None
        and "slots" in user.model_fields_set
        and find_user_file(player, folder).exists()  # else these are the machine's
    )
    name = user.slots[0] if chooses or default is None else default
    return Chosen(name, load_profile(name, folder), user)
