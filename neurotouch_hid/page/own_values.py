"""The person's own values on the page: shown, set one at a time, taken back."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final, TypedDict

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import describe_fault
from neurotouch_hid.page.handed_over import pass_on
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile import UserSettings, check_user, load_user
from neurotouch_hid.profile.calibration import (
    describe_unfinished,
    find_unfinished_file,
    undo_ranges,
)
from neurotouch_hid.profile.editing import (
    EditedFile,
    ProfileText,
    Store,
    read_text,
    reset_value,
    set_value,
    take_back,
    take_user,
)
from neurotouch_hid.profile.reading import OWN_VALUES, find_values
from neurotouch_hid.profile.schema import Timing

NAMES: Final = ("filter", "timing", "neutral", "fatigue", "feedback.sound")
"""What a person may set on the page."""

_HANDS: Final = {"hand": False, "simulated": True}
_KIND: Final = "values"
_NOT_READ: Final = "Your own values cannot be read."


class OwnValuesView(TypedDict, total=False):
    """The person's own values for the page.

    Attributes:
        values: those of ``NAMES``, by name; empty where the profile decides.
        fault: why they cannot be read; then there are no values.
        unfinished: how far a measurement is that has not been finished, of a hand and of a
            simulated one; empty if there is none.
        can_undo: whether a change can be undone, of the ``values`` and of the ``ranges``.
    """

    values: dict[str, str]
    fault: str
    unfinished: dict[str, str]
    can_undo: dict[str, bool]


def load_usable_user() -> UserSettings:
    """Returns the person's own values, or the defaults where they cannot be read."""
    try:
        return load_user()
    except ProfileError:
        return UserSettings()


def describe_own() -> OwnValuesView:
    """Returns what the page shows of the person, ready for JSON."""
    unfinished = {name: describe_unfinished(is_simulated=is_) for name, is_ in _HANDS.items()}
    return {**describe_values(), "unfinished": unfinished, "can_undo": _list_undoable()}


def find_unfinished_files() -> list[Path]:
    """Returns the files of unfinished measurements; they need not exist."""
    return [find_unfinished_file(is_simulated=is_simulated) for is_simulated in _HANDS.values()]


def describe_values() -> OwnValuesView:
    """Returns the person's own values, or why they cannot be read."""
    path = find_values()
    if not path.exists():
        return {"values": _list_values(UserSettings())}
    try:
        checked = check_user(read_text(path)[1], path.name)
    except ProfileError as error:
        return {"fault": f"{_NOT_READ} {error.message}"}
    if checked.whole is None:
        return {"fault": f"{_NOT_READ} {describe_fault(checked.faults[0])}"}
    return {"values": _list_values(checked.whole)}


@dataclass(frozen=True, slots=True)
class OwnValues:
    """Saves the person's own values; each kind of change can be taken back by itself.

    Args:
        stamp: the present moment, for the names of versions.
    """

    stamp: Callable[[], str]

    def set(self, name: str, value: str) -> str:
        """Sets a value, and tells in a sentence what has been saved.

        Args:
            name: one of ``NAMES``.
            value: a word; empty: the profile decides.

        Raises:
            ProfileError: there is no such value; nothing has changed.
            DriverError: it is saved, and the running driver does not play it.
        """
        if name not in NAMES:
            raise ProfileError("There is no such value.")
        edited = take_user(lambda: f"{self.stamp()}_{_KIND}")
        if describe_values().get("values", {}).get(name) == value:
            return "It is so already."
        if value:
            text = set_value(edited.text, name, value, UserSettings)
        else:
            text = reset_value(edited.text, name, UserSettings)
        return f"Saved. {_save(edited, text)}"

    def undo(self) -> str:
        """Takes back the last change made here; again, the one before.

        Raises:
            ProfileError: there is none.
            DriverError: as ``set``.
        """
        edited = take_user(self.stamp)
        text = _undo_values(edited)
        if text is None:
            raise ProfileError("There is no change of these values to undo.")
        return f"These values are as before. {_save(edited, text)}"

    def undo_calibration(self) -> str:
        """Takes back the last calibration; again, the one before.

        Raises:
            ProfileError: there is none.
            DriverError: as ``set``.
        """
        edited = take_user(self.stamp)
        text = _undo_ranges(edited)
        if text is None:
            raise ProfileError("There is no measurement to undo.")
        return f"Your range is as before that measurement. {_save(edited, text)}"

    def mend(self) -> str:
        """Puts the newest version that can be read in the place of values that cannot be read.

        Without one the values are put aside, as a version, and the usual ones apply.

        Raises:
            ProfileError: they can be read, or nothing can be written.
            DriverError: as ``set``.
        """
        path = find_user_file()
        if "fault" not in describe_values() or not path.exists():
            raise ProfileError("Your own values can be read: nothing needs to be mended.")
        store = Store(path, self.stamp, kept=10)
        store.keep_replaced()
        for version in store.versions():
            if check_user(version.path.read_bytes(), path.name).whole is not None:
                store.restore(version.number)
                return f"Your own values are as they were before. {pass_on(OWN_VALUES)}"
        store.delete()
        return f"Your own values were put aside, and the usual ones apply. {pass_on(OWN_VALUES)}"


def _undo_values(edited: EditedFile) -> ProfileText | None:
    return edited.undo_kind(_KIND, partial(take_back, names=NAMES, model=UserSettings))


def _undo_ranges(edited: EditedFile) -> ProfileText | None:
    return edited.undo_kind("calibration", undo_ranges)


def _list_undoable() -> dict[str, bool]:
    try:
        edited = take_user(str)
        return {
            "values": _undo_values(edited) is not None,
            "ranges": _undo_ranges(edited) is not None,
        }
    except ProfileError:
        return {"values": False, "ranges": False}


def _save(edited: EditedFile, text: ProfileText) -> str:
    """Saves the text and tells what became of it.

    Raises:
        ProfileError: it is not right; nothing has changed.
        DriverError: the running driver does not play it.
    """
    checked = edited.check(text)
    if checked.whole is None:
        raise ProfileError(f"Nothing was saved. {describe_fault(checked.faults[0])}")
    edited.save(text)
    return pass_on(OWN_VALUES)


def _list_values(settings: UserSettings) -> dict[str, str]:
    timing: Any = settings.timing
    return {
        "filter": settings.filter or "",
        "timing": "own" if isinstance(timing, Timing) else timing or "",
        "neutral": settings.neutral,
        "fatigue": settings.fatigue,
        "feedback.sound": settings.feedback.sound,
    }
