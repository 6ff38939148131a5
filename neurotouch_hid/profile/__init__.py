"""Stage 4: a profile says what each gesture does; the mapping does it.

A name loads its module when it is first asked for. The engine needs numpy, whose import costs
more than reading and checking a profile; the names of profiles need not even the models.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.profile.decision_log import MappingDecision
    from neurotouch_hid.profile.diagnostics import explain
    from neurotouch_hid.profile.mapping import Mapping
    from neurotouch_hid.profile.reading import (
        Checked,
        check_content,
        check_profile,
        check_user,
        list_profiles,
        load_profile,
        load_unused,
        load_user,
    )
    from neurotouch_hid.profile.rehearsal import perform, rehearse
    from neurotouch_hid.profile.schema import Profile, UserSettings, profile_schema, user_schema
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "decision_log": "MappingDecision",
            "diagnostics": "explain",
            "mapping": "Mapping",
            "reading": "Checked check_content check_profile check_user list_profiles "
            "load_profile load_unused load_user",
            "rehearsal": "perform rehearse",
            "schema": "Profile UserSettings profile_schema user_schema",
        },
    )

__all__ = [
    "Checked",
    "Mapping",
    "MappingDecision",
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
