"""Chooses profile and values as long as nobody has asked for another profile."""

from collections.abc import Callable
from typing import Final, NamedTuple

from neurotouch_hid.driver.options import DriverOptions
from neurotouch_hid.driver.people import People, Person
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile import Profile, UserSettings, load_profile, load_user


class Chosen(NamedTuple):
    """A profile and the values it is played with.

    Attributes:
        name: the profile as it was asked for, by name or path.
        profile: the profile.
        user: the values.
        person: the person at the machine whom both belong to; None: this process's user.
    """

    name: str
    profile: Profile
    user: UserSettings
    person: Person | None = None


NOTHING: Final = Chosen(
    "nothing", Profile.model_construct(name="nothing", bindings=[]), UserSettings.model_construct()
)
"""A profile without bindings. It is not checked, so no model is compiled for it."""


def choose_first(
    options: DriverOptions, people: People | None, announce: Callable[[str], object]
) -> Chosen:
    """Returns what a driver starts with; for a service, that of the person at the machine.

    Args:
        options: of the driver.
        people: a service's settings of the people at the machine.
        announce: is told if a person's settings cannot be used.

    Raises:
        ProfileError: a file cannot be used; for a service, one of the machine's.
    """
    if not options.personal:
        name = options.profile or UserSettings().slots[0]
        return Chosen(name, load_profile(name), UserSettings())
    if people is not None and (person := people.find_present()) is not None:
        try:
            return load_chosen(person, options.profile, options.player)
        except ProfileError as error:  # the machine still plays
            announce(f"The settings of user {person.uid} cannot be used: {error.message}")
    return load_chosen(None, options.profile, options.player)


def load_chosen(person: Person | None, default: str | None, player: int | None) -> Chosen:
    """Returns what applies to a person.

    Args:
        person: the one at the machine, for a service; None: this process's user.
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
    return Chosen(name, load_profile(name, folder), user, person)
