"""Stage 4: a profile says what each gesture does; the mapping does it."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from neurotouch_hid.profile.decision_log import MappingDecision
    from neurotouch_hid.profile.diagnostics.codes import explain
    from neurotouch_hid.profile.mapping import Mapping
    from neurotouch_hid.profile.reading.library import list_profiles
    from neurotouch_hid.profile.reading.load import (
        Checked,
        check_content,
        check_profile,
        check_user,
        load_profile,
        load_unused,
        load_user,
    )
    from neurotouch_hid.profile.rehearsal.script import rehearse
    from neurotouch_hid.profile.rehearsal.timeline import TimelineEntry, perform
    from neurotouch_hid.profile.schema.profile import Profile, profile_schema
    from neurotouch_hid.profile.schema.user import UserSettings, user_schema

__all__ = [
    "Checked",
    "Mapping",
    "MappingDecision",
    "Profile",
    "TimelineEntry",
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
    "Checked": "reading.load",
    "MappingDecision": "decision_log",
    "Mapping": "mapping",
    "TimelineEntry": "rehearsal.timeline",
    "Profile": "schema.profile",
    "UserSettings": "schema.user",
    "check_content": "reading.load",
    "check_profile": "reading.load",
    "check_user": "reading.load",
    "explain": "diagnostics.codes",
    "list_profiles": "reading.library",
    "load_profile": "reading.load",
    "load_unused": "reading.load",
    "load_user": "reading.load",
    "perform": "rehearsal.timeline",
    "profile_schema": "schema.profile",
    "rehearse": "rehearsal.script",
    "user_schema": "schema.user",
}
"""Where the names come from; each is loaded when it is first asked for. The engine needs numpy,
whose import costs more than reading and checking a profile; the names of the profiles and the
codes of their faults need not even the models."""


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
