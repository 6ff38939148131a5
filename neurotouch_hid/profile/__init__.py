"""Stage 4: a profile says what each gesture does; the mapping does it."""

from neurotouch_hid.profile.decision import Decision
from neurotouch_hid.profile.library import list_profiles
from neurotouch_hid.profile.load import load_profile
from neurotouch_hid.profile.mapping import Mapping
from neurotouch_hid.profile.schema import Profile, profile_schema
from neurotouch_hid.profile.user import UserSettings, user_schema

__all__ = [
    "Decision",
    "Mapping",
    "Profile",
    "UserSettings",
    "list_profiles",
    "load_profile",
    "profile_schema",
    "user_schema",
]
