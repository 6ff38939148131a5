"""Stage 4: a profile says what each gesture does; the mapping does it."""

from neurotouch_hid.profile.codes import explain
from neurotouch_hid.profile.decision import Decision
from neurotouch_hid.profile.library import list_profiles
from neurotouch_hid.profile.load import (
    Checked,
    check_content,
    check_profile,
    check_user,
    load_profile,
    load_user,
)
from neurotouch_hid.profile.mapping import Mapping
from neurotouch_hid.profile.rehearsal import rehearse
from neurotouch_hid.profile.schema import Profile, profile_schema
from neurotouch_hid.profile.timeline import Moment, perform
from neurotouch_hid.profile.user import UserSettings, user_schema

__all__ = [
    "Checked",
    "Decision",
    "Mapping",
    "Moment",
    "Profile",
    "UserSettings",
    "check_content",
    "check_profile",
    "check_user",
    "explain",
    "list_profiles",
    "load_profile",
    "load_user",
    "perform",
    "profile_schema",
    "rehearse",
    "user_schema",
]
