"""Opens a profile or the user's file to be edited, and saves it only if it is right."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path

from pydantic import BaseModel

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.small_file import (
    MAX_SETTINGS_BYTES,
    find_real_path,
    read_bytes,
    suggest_reading,
)
from neurotouch_hid.players import find_machine_folder, find_user_file, look_into
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.editing.edit_values import reset_value
from neurotouch_hid.profile.editing.file_header import MODELINE, adopt
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.editing.store import Store
from neurotouch_hid.profile.reading.library import (
    OWN_VALUES,
    find_profile,
    find_shipped_folder,
    find_user_folder,
    list_profile_folders,
    list_profiles,
    propose_name,
)
from neurotouch_hid.profile.reading.load import (
    Checked,
    check_content,
    check_user,
    load_unused,
    load_user,
    suggest_moving,
)
from neurotouch_hid.profile.schema.profile import Profile
from neurotouch_hid.profile.schema.user import UserSettings
from neurotouch_hid.vocabulary import NAME_PATTERN

Stamp = Callable[[], str]
"""The present moment as letters, digits, ``-`` and ``_``."""

TakeBack = Callable[[ProfileText, ProfileText, ProfileText], ProfileText]
"""Takes a change back in a text, given that text, and the text before and after the change."""


@dataclass(frozen=True, slots=True)
class EditedFile:
    """A file being edited.

    Attributes:
        name: what people call it.
        store: where it is saved to.
        content: what is there, or None if it does not exist.
        text: what an edit begins with.
        model: what it is: a profile or the user's own values.
        shipped: true if saving makes the person's own copy of a shipped profile, or the machine's.
    """

    name: str
    store: Store
    content: bytes | None
    text: ProfileText
    model: type[BaseModel] = Profile
    shipped: bool = False

    def check(self, text: ProfileText) -> Checked[Profile] | Checked[UserSettings]:
        """Returns the text with all its faults, as it would be there."""
        content, name = text.encode(), make_printable(str(self.store.path))
        if self.model is UserSettings:
            return check_user(content, name)
        path = self.store.path
        if path.parent == find_user_folder():  # there it hides a shipped one of its name
            path = list_profiles().get(path.stem, path)
        return check_content(content, name, path, load_unused())

    def save(
        self, text: ProfileText, *, keep: bool = True
    ) -> Checked[Profile] | Checked[UserSettings]:
        """Saves the text if it is right; the old one becomes a version unless ``keep`` is False.

        Returns:
            The text as it was checked, with its warnings.

        Raises:
            ProfileError: there are errors, or it cannot be written; nothing has changed.
        """
        checked = self.check(text)
        checked.require()
        begun = self.text.encode() or None
        self.store.save(text.encode(), over=self.content, keep=keep, begun=begun)
        return checked

    def undo_kind(self, kind: str, take_back: TakeBack) -> ProfileText | None:
        """Returns the text without the last change of a kind; None if there is none to undo.

        Args:
            kind: how the stamps of its versions end.
            take_back: is given the text, and a change's text before and after.
        """
        for before, after in self.store.changes(kind):
            changed = (self.text.rewrite(each.decode()) for each in (before, after))
            text = take_back(self.text, *changed)
            if text != self.text:
                return text
        return None


def take_profile(name_or_path: str, stamp: Stamp) -> EditedFile:
    """Returns a profile to be edited; of one for everybody, the copy that saving makes.

    Raises:
        ProfileError: there is none, or it cannot be read as text.
    """
    path = find_profile(name_or_path)
    text, content = read_text(path)
    if find_real_path(path).parent not in {each.resolve() for each in list_profile_folders()[1:]}:
        return EditedFile(path.stem, Store(path, stamp), content, text)
    own = find_user_folder() / path.name
    if own.exists():  # named by its path
        raise ProfileError(
            f"'{path}' is for everybody and never changed from here.",
            hint=f"Edit your own copy: {own}",
        )
    return EditedFile(
        path.stem, Store(own, stamp), None, adopt(text, path.stem, find_schema(own)), shipped=True
    )


def make_profile(name: str, template: str, stamp: Stamp) -> EditedFile:
    """Returns a new profile of the user's, begun as a copy of another.

    Raises:
        ProfileError: the name is taken or none, there is no such template, or the folder cannot be
            looked into.
    """
    own = find_own_path(name)
    if own in look_into(own.parent) and own.exists():  # a link may lead nowhere
        raise ProfileError(
            f"You have a profile '{name}' already.",
            hint=f"Change it: neurotouch profile edit {name}",
        )
    text, _ = read_text(find_profile(template))
    return EditedFile(name, Store(own, stamp), None, adopt(text, name, find_schema(own)))


def take_file(name_or_path: str, stamp: Stamp) -> EditedFile:
    """Returns a profile to be edited, or for ``user`` the person's own values.

    Raises:
        ProfileError: as ``take_profile``.
    """
    own = name_or_path == OWN_VALUES
    return take_user(stamp) if own else take_profile(name_or_path, stamp)


def take_user(stamp: Stamp) -> EditedFile:
    """Returns the person's own values to be edited.

    A new file begins with what applied to the person until now: the machine's values, if it has
    some.
    """
    path = find_user_file()
    store = Store(path, stamp, kept=10)
    if path.exists():
        text, content = read_text(path, suggest_moving(path))
        return EditedFile("user", store, content, text, UserSettings)
    schema = find_schema(path, "user-1.json")
    machine = find_user_file(folder=find_machine_folder())
    if machine.exists():
        text = adopt(read_text(machine)[0], "user", schema)
        if load_user().slots == UserSettings().slots:  # no choice, and must not become one
            text = reset_value(text, "slots", UserSettings)
        return EditedFile("user", store, None, text, UserSettings)
    begin = "# What belongs to you and applies in every profile.\nversion: 1\n"
    text = ProfileText(f"{MODELINE}{schema}\n#\n{begin}", str(path))
    return EditedFile("user", store, None, text, UserSettings)


def find_own_path(name: str) -> Path:
    """Returns the path of the user's own profile of a name.

    Raises:
        ProfileError: that is no name.
    """
    if not re.fullmatch(NAME_PATTERN, name):
        near = propose_name(name)
        raise ProfileError(
            f"A profile cannot be called '{make_printable(name[:80])}'.",
            hint=(f"Try: {near}. " if near and "/" not in name else "")
            + "A name has 1 to 64 letters from a to z, digits, _ or -, and no - in front; it is "
            "never a path.",
        )
    if name == OWN_VALUES:
        raise ProfileError(
            f"'{name}' is what your own values are called.", hint="Give the profile another name."
        )
    return find_user_folder() / f"{name}.yaml"


def find_schema(path: Path, schema: str = "profile-1.json") -> str:
    """Returns the path of a shipped schema, for the schema line of a file."""
    shipped = find_shipped_folder() / "schema" / schema
    if path.parent.resolve() == find_shipped_folder().resolve():
        return f"schema/{schema}"
    return str(shipped)


def read_text(path: Path, otherwise: str = "Check the name.") -> tuple[ProfileText, bytes]:
    """Returns the text of a file, with its own ends of lines, and its bytes.

    Args:
        path: the file.
        otherwise: the fix where it cannot be read although no right is missing.

    Raises:
        ProfileError: it is not a file, too large, or not UTF-8.
    """
    try:
        content = read_bytes(path, MAX_SETTINGS_BYTES)
    except OSError as error:
        raise ProfileError(
            f"'{make_printable(str(path))}' cannot be read: {error.strerror}.",
            hint=suggest_reading(error, otherwise),
        ) from None
    try:
        return ProfileText(content.decode("utf-8"), make_printable(str(path))), content
    except UnicodeDecodeError:
        raise ProfileError(f"'{make_printable(str(path))}' is not UTF-8 text.") from None


def compare(before: ProfileText, after: ProfileText) -> list[tuple[str, int, str]]:
    """Returns the lines that differ: ``removed`` or ``added``, the line's number, its text."""
    found = []
    old_line = new_line = 0
    lines = before.text.splitlines(), after.text.splitlines()
    for line in unified_diff(*lines, n=0, lineterm=""):
        hunk = re.match(r"@@ -(\d+)(?:,(\d+))? \+(\d+)(?:,(\d+))? @@", line)
        if hunk is not None:
            # a hunk of no lines is named by the line before it
            old_line = int(hunk[1]) + (hunk[2] == "0")
            new_line = int(hunk[3]) + (hunk[4] == "0")
        elif old_line and line.startswith("-"):
            found.append(("removed", old_line, line[1:]))
            old_line += 1
        elif new_line and line.startswith("+"):
            found.append(("added", new_line, line[1:]))
            new_line += 1
    return found
