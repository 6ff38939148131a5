"""The table of the areas: everything that comes from outside and is fuzzed."""

from typing import Final

from neurotouch_hid.errors import DeviceError, DriverError, ProfileError
from tests.fuzz import control_socket, pad_messages, page_messages, profiles
from tests.fuzz.area import Area
from tests.fuzz.camera_words import CAMERA_WORDS
from tests.fuzz.clips import CLIPS
from tests.fuzz.recordings import RECORDINGS
from tests.fuzz.texts import CAMERAS, DRIVERS, GELS, IDENTITIES, LABELS, RIGS, SERVICES, USERS

FILES: Final[dict[str, Area]] = {
    "recordings": RECORDINGS,
    "clips": CLIPS,
    "rigs": RIGS,
    "labels": LABELS,
    "identities": IDENTITIES,
    "users": USERS,
    "drivers": DRIVERS,
    "services": SERVICES,
    "camera_settings": CAMERAS,
    "gels": GELS,
    "camera": CAMERA_WORDS,
}
"""Each case of them is right, or ends in the area's refusal."""

MESSAGES: Final[dict[str, Area]] = {
    "profiles": Area(
        profiles.make, lambda path: profiles.check(path.read_bytes()), ProfileError, ".yaml"
    ),
    "control": Area(
        control_socket.make,
        lambda path: control_socket.check(path.read_bytes()),
        DriverError,
        ".json",
    ),
    "pads": Area(
        pad_messages.make,
        lambda path: pad_messages.check(path.read_bytes()),
        DeviceError,
        ".hid",
    ),
    "page": Area(
        page_messages.make,
        lambda path: page_messages.check(path.read_bytes()),
        DriverError,
        ".json",
    ),
}
"""Each case of them gets an answer; a refusal is one, too."""

AREAS: Final[dict[str, Area]] = FILES | MESSAGES

AT_RANDOM: Final = frozenset({"camera"})
"""Areas that coverage cannot guide: a case says itself whether it is sound; a changed one lies."""
