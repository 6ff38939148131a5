"""Stage 4: a profile says what each gesture does; the mapping does it."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from neurotouch_hid.profile.codes import explain
from neurotouch_hid.profile.library import list_profiles
from neurotouch_hid.profile.load import (
    Checked,
    check_content,
    check_profile,
    check_user,
    load_profile,
    load_user,
)
from neurotouch_hid.profile.schema import Profile, profile_schema
from neurotouch_hid.profile.user import UserSettings, user_schema

if TYPE_CHECKING:
    from neurotouch_hid.profile.decision import Decision
    from neurotouch_hid.profile.mapping import Mapping
    from neurotouch_hid.profile.rehearsal import rehearse
    from neurotouch_hid.profile.timeline import Moment, perform

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

_ENGINE = {
    "Decision": "decision",
    "Mapping": "mapping",
    "Moment": "timeline",
    "perform": "timeline",
    "rehearse": "rehearsal",
}
"""Where the names of the engine come from. It needs numpy, whose import costs more than reading
and checking a profile; so it is loaded when it is first asked for."""


def __getattr__(name: str) -> Any:
    if name not in _ENGINE:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f"{__name__}.{_ENGINE[name]}"), name)
