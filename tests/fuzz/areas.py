"""The table of the areas: everything that comes from outside and is fuzzed."""

from typing import Final

from tests.fuzz.area import Area
from tests.fuzz.recordings import RECORDINGS
from tests.fuzz.texts import CAMERAS, DRIVERS, IDENTITIES, LABELS, RIGS, SERVICES, USERS

AREAS: Final[dict[str, Area]] = {
    "recordings": RECORDINGS,
    "rigs": RIGS,
    "labels": LABELS,
    "identities": IDENTITIES,
    "users": USERS,
    "drivers": DRIVERS,
    "services": SERVICES,
    "cameras": CAMERAS,
}
