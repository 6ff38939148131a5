"""Effect of a saved file: the running driver gets it, and the answer says what plays."""

from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.handover import hand_over
from neurotouch_hid.players import find_player
from neurotouch_hid.profile.editing.edited_file import EditedFile
from neurotouch_hid.profile.reading.library import OWN_VALUES
from neurotouch_hid.profile.reading.load import check_profile, load_user
from neurotouch_hid.profile.schema.user import UserSettings


@dataclass(frozen=True, slots=True)
class SavedEffect:
    """Effect of a saved file.

    Attributes:
        status: ``WARNING`` if the file has errors or the driver refuses it.
        said: the same in a sentence.
        fix: the fix if it has no effect.
        unused: the profile, if it is to be chosen before it plays.
    """

    status: Literal["OK", "WARNING"]
    said: str
    fix: str = ""
    unused: str = ""

    @property
    def text(self) -> str:
        """The sentence, and the command that lets the profile play."""
        if not self.unused:
            return self.said
        return f"{self.said} To play it: neurotouch profile use {self.unused}"


def hand_over_saved(name: str) -> SavedEffect:
    """Gives what has been saved to the running driver.

    Args:
        name: the profile, or ``user`` for the person's own values.
    """
    done = hand_over(find_player() if name == OWN_VALUES else None)
    if done.status == "refused":
        return SavedEffect("WARNING", done.text, done.fix)
    if name == OWN_VALUES:
        return SavedEffect("OK", done.text)
    if done.status == "plays":
        acts = any(_is_part_of(name, active, set()) for active in done.profiles)
        text = "It applies now."
        other = "It is not the active profile."
    else:
        acts, text = _is_part_of(name, _find_favourite(), set()), done.text
        other = "No driver is running."
    return SavedEffect("OK", text) if acts else SavedEffect("OK", other, unused=name)


def hand_over_restored(edited: EditedFile) -> SavedEffect:
    """Gives a version that was put back to the running driver; it may have errors of its time.

    Args:
        edited: the file as it is now.
    """
    if any(fault.severity == "error" for fault in edited.check(edited.text).faults):
        text = "It has errors, so it cannot be played."
        return SavedEffect("WARNING", text, f"See them: neurotouch profile check {edited.name}")
    return hand_over_saved(edited.name)


def _find_favourite() -> str:
    """Returns the profile that the next driver plays."""
    try:
        return load_user().slots[0]
    except ProfileError:  # the next start says what is wrong with the values
        return UserSettings().slots[0]


def _is_part_of(name: str, played: str, seen: set[str]) -> bool:
    """Returns whether a profile is the one that is played, or one that it extends."""
    if name == played:
        return True
    seen.add(played)
    with suppress(ProfileError):
        written = check_profile(played).written
        bases = [] if written is None else written.extends
        return any(_is_part_of(name, base, seen) for base in bases if base not in seen)
    return False
