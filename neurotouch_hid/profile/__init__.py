"""Stage 4: a profile says what each gesture does; the mapping does it."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from neurotouch_hid.profile.codes import explain
    from neurotouch_hid.profile.decision import Decision
    from neurotouch_hid.profile.library import list_profiles
    from neurotouch_hid.profile.load import (
        Checked,
        check_content,
        check_profile,
        check_user,
        load_profile,
        load_unused,
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
    "load_unused",
    "load_user",
    "perform",
    "profile_schema",
    "rehearse",
    "user_schema",
]

_MODULES = {
    "Checked": "load",
    "Decision": "decision",
    "Mapping": "mapping",
    "Moment": "timeline",
    "Profile": "schema",
    "UserSettings": "user",
    "check_content": "load",
    "check_profile": "load",
    "check_user": "load",
    "explain": "codes",
    "list_profiles": "library",
    "load_profile": "load",
    "load_unused": "load",
    "load_user": "load",
    "perform": "timeline",
    "profile_schema": "schema",
    "rehearse": "rehearsal",
    "user_schema": "user",
}
"""Where the names come from; each is loaded when it is first asked for. The engine needs numpy,
whose import costs more than reading and checking a profile; the names of the profiles and the
codes of their faults need not even the models."""


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
