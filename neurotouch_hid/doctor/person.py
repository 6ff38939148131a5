"""Checks the person's own settings: profiles, calibration, the keys that stop everything, sound."""

import datetime
import errno
import os
import re
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

from neurotouch_hid.device import ChordReader, explain_keyboards, find_keyboards
from neurotouch_hid.doctor.finding import Finding, approve, fail, skip, warn
from neurotouch_hid.driver.settings import load_driver_settings
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.monitor.sound_programs import SOUND_PROGRAMS
from neurotouch_hid.partial_file import suggest_fix
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile import list_profiles, load_profile, load_user
from neurotouch_hid.profile.reading import find_user_folder

_CALIBRATED: Final = re.compile(r"^# Calibrated (\d{4}-\d{2}-\d{2})\.", re.MULTILINE)
_OLD_DAYS: Final = 180


def check_profiles() -> Finding:
    """Checks that all profiles load, the first favourite exists and versions can be kept."""
    names = list_profiles()
    for profile in names:
        load_profile(profile)
    user = load_user()
    load_driver_settings()
    for favourite in user.slots:
        if favourite not in names:
            return fail(
                f"Your favourite profile '{favourite}' does not exist.",
                "Choose another: neurotouch profile use NAME. All names: neurotouch profile list",
            )
    folder = find_user_folder()
    nearest = next(each for each in (folder, *folder.parents) if each.exists())
    if not os.access(nearest, os.W_OK):
        is_read_only = os.statvfs(nearest).f_flag & os.ST_RDONLY
        number = errno.EROFS if is_read_only else errno.EACCES
        return warn(
            f"{len(names)} profiles are in order, but {nearest} cannot be written, so none can be "
            "changed and no version kept.",
            suggest_fix(OSError(number, os.strerror(number), str(nearest))),
        )
    return approve(f"{len(names)} profiles are in order; '{user.slots[0]}' plays first.")


def check_calibration() -> Finding:
    """Checks whether the person is calibrated, and how long ago."""
    ranges = load_user().range
    measured = [name for name in type(ranges).model_fields if getattr(ranges, name) is not None]
    if not measured:
        return skip(
            "Not calibrated: the reference hand is assumed. To calibrate: neurotouch calibrate"
        )
    found = _CALIBRATED.search(read_text(find_user_file(), MAX_SETTINGS_BYTES))
    sentence = f"{len(measured)} of 8 movements are calibrated"
    if found is None:
        return approve(f"{sentence}, by hand.")
    age = (
        datetime.datetime.now(tz=datetime.UTC).date() - datetime.date.fromisoformat(found[1])
    ).days
    age = max(age, 0)  # a clock that was set back
    sentence = f"{sentence}, {age} days ago."
    if age > _OLD_DAYS:
        return warn(sentence, "Hands change. To measure again: neurotouch calibrate")
    return approve(sentence)


def check_keyboard() -> Finding:
    """Checks whether the keys that stop everything can be read."""
    keyboards = find_keyboards()
    sentence, fix = explain_keyboards(keyboards)
    sentence = f"{sentence[0].upper()}{sentence[1:]}."
    if not keyboards:
        return skip(sentence)
    if fix:
        return warn(sentence, fix)
    return approve(f"{sentence} Try them: neurotouch doctor --keys")


def try_chords(
    say: Callable[[str], object], wait: Callable[[Callable[[], bool]], bool], **places: Path
) -> Finding:
    """Asks the person to press each chord, without a time limit.

    Args:
        say: shows the person a sentence.
        wait: waits until its argument returns True (returns True), or the person skips.
        places: folders in which keyboards are searched, for tests.
    """
    heard: set[str] = set()
    chords = load_driver_settings().keys_of
    reader = ChordReader(heard.add, chords, **places)
    try:
        missed = []
        for name, keys in chords.items():
            words = " + ".join(key.removeprefix("KEY_").capitalize() for key in keys)
            say(f"Hold {words} together ({name}). There is no time limit; S and Enter skips.")
            if not wait(partial(heard.__contains__, name)):
                missed.append(name)
            else:
                say(f"Received: {name}.")
    finally:
        reader.close()
    if not missed:
        return approve(f"Received: {' and '.join(chords)}.")
    if len(missed) == len(chords):
        return skip("You skipped the keys.")
    return warn(f"Not received: {', '.join(missed)}.", "See the check 'keyboard'.")


def check_sound() -> Finding:
    """Checks whether the sounds the person asked for can be played."""
    sound = load_user().feedback.sound
    if sound == "none":
        return skip("Sound is off. Switch it on: neurotouch profile set user feedback.sound tones")
    programs = [command[0] for command in SOUND_PROGRAMS[sound]]
    found = next(filter(shutil.which, programs), None)
    if found is None:
        package = "speech-dispatcher" if sound == "speech" else "pipewire-bin"
        return warn(
            f"You want {sound}, but no program for it is installed: {', '.join(programs)}.",
            "Install one (Debian, Ubuntu).",
            f"sudo apt install {package}",
        )
    return approve(f"{sound.capitalize()} are played through {found}.")
