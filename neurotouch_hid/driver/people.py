"""The settings of the people at a machine, as they have handed them over to its service.

A service may not read home folders. Each person's commands send it a copy of the saved settings.
The copy applies while that person is at the machine, and to no other person.
"""

import os
import re
import shutil
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.driver.admission import find_seated_users
from neurotouch_hid.errors import DriverError
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.partial_file import suggest_fix, write_whole
from neurotouch_hid.players import find_runtime_folder, find_user_file
from neurotouch_hid.profile.reading import find_user_folder
from neurotouch_hid.vocabulary import NAME_PATTERN

MAX_PROFILES: Final = 100
_ORIGIN: Final = "origin"


@dataclass(frozen=True, slots=True)
class Person:
    """A person whose settings the service has.

    Attributes:
        uid: the user.
        folder: the service's copy of the settings.
        origin: the folder that they were copied from, as that person calls it.
    """

    uid: int
    folder: Path
    origin: Path

    def name_file(self, path: Path) -> Path:
        """Returns the person's own file of which ``path`` is the copy; else ``path`` itself."""
        if path.is_relative_to(self.folder):
            return self.origin / path.relative_to(self.folder)
        return path


class People:
    """A folder for each person, which only the service reads.

    Args:
        folder: the settings are kept in it.
        player: the player number; None means the one of the environment.
        find_seated: finds the users at the machine, the one at the first seat first.
    """

    def __init__(
        self,
        folder: Path,
        player: int | None = None,
        find_seated: Callable[[], Sequence[int]] = find_seated_users,
    ) -> None:
        self._folder = folder
        self._player = player
        self._find_seated = find_seated

    def find_present(self) -> Person | None:
        """Returns the person at the machine; None for nobody, or one without settings here.

        Of several seats the first one counts: there is one gel.
        """
        seated = self._find_seated()
        if not seated:
            return None
        folder = self._folder / str(seated[0])
        try:
            return Person(seated[0], folder, Path(read_text(folder / _ORIGIN, MAX_SETTINGS_BYTES)))
        except OSError:
            return None

    def is_present(self, uid: int) -> bool:
        """Returns True for the person at the machine, with settings here or without."""
        return uid in self._find_seated()[:1]

    def keep(self, uid: int, settings: dict[str, Any]) -> None:
        """Keeps a person's settings in place of those before.

        Args:
            uid: the user.
            settings: ``folder``: where they are from; ``user``: the text of their values, or None;
                ``profiles``: the text of each profile by its name. Without values and profiles the
                machine's settings apply again.

        Raises:
            DriverError: the user is not at the machine, these are no settings, or they cannot be
                written.
        """
        if not self.is_present(uid):
            raise DriverError(
                "The service plays the settings of the person at the machine, and that is not you.",
                hint="They apply once you sit there. For everybody without settings: "
                "/etc/neurotouch, as administrator.",
            )
        origin, texts = _read_settings(settings, self._player)
        folder = self._folder / str(uid)
        try:
            if not texts:
                if folder.exists():
                    shutil.rmtree(folder)
                return
            for name, text in texts.items():
                (folder / name).parent.mkdir(mode=0o700, parents=True, exist_ok=True)
                write_whole(folder / name, text.encode())
            write_whole(folder / _ORIGIN, os.fsencode(origin))
            for path in [*folder.glob("profiles/*"), find_user_file(self._player, folder)]:
                if str(path.relative_to(folder)) not in texts:
                    path.unlink(missing_ok=True)
        except OSError as error:
            raise DriverError(
                f"The service cannot keep your settings in '{self._folder}': {error.strerror}.",
                hint=suggest_fix(error),
            ) from error


def find_people_folder() -> Path:
    """Returns where a service keeps people's settings: systemd names its folder of state."""
    state = os.environ.get("STATE_DIRECTORY", "").split(":")[0]
    return (Path(state) if state else find_runtime_folder()) / "people"


def _read_settings(settings: dict[str, Any], player: int | None) -> tuple[str, dict[str, str]]:
    """Returns where settings are from, and the text of each file by its path in that folder.

    Raises:
        DriverError: these are none.
    """
    origin, user, profiles = (settings.get(key) for key in ("folder", "user", "profiles"))
    texts: dict[str, Any] = {}
    here = Path("/")
    if user is not None:
        texts[str(find_user_file(player, here).relative_to(here))] = user
    if not isinstance(origin, str) or not origin.startswith("/") or not isinstance(profiles, dict):
        raise DriverError("These are no settings.")
    if len(profiles) > MAX_PROFILES:
        raise DriverError(f"These are more than {MAX_PROFILES} profiles.")
    for name, text in profiles.items():
        if not re.fullmatch(NAME_PATTERN, name):
            raise DriverError("One of the profiles has no name.")
        texts[str((find_user_folder(here) / f"{name}.yaml").relative_to(here))] = text
    for text in texts.values():
        if not isinstance(text, str) or len(text) > MAX_SETTINGS_BYTES:
            raise DriverError(f"One of the files is larger than {MAX_SETTINGS_BYTES // 1024} kB.")
        with suppress(UnicodeEncodeError):
            text.encode()
            continue
        raise DriverError("One of the files is not valid text.")
    return origin, texts
