"""Finds, reads and checks profiles and the user's file.

A name loads its module when it is first asked for: a list of profiles needs no model of them.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.profile.reading.library import (
        OWN_VALUES,
        find_profile,
        find_shipped_folder,
        find_user_folder,
        list_changeable_folders,
        list_misnamed,
        list_profile_folders,
        list_profiles,
        propose_name,
    )
    from neurotouch_hid.profile.reading.load import (
        Checked,
        check_content,
        check_listed,
        check_profile,
        check_user,
        find_values,
        holds_values,
        load_profile,
        load_settings,
        load_unused,
        load_user,
        parse_profile,
        parse_settings,
    )
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "library": "OWN_VALUES find_profile find_shipped_folder find_user_folder "
            "list_changeable_folders list_misnamed list_profile_folders list_profiles propose_name",
            "load": "Checked check_content check_listed check_profile check_user find_values "
            "holds_values load_profile load_settings load_unused load_user parse_profile "
            "parse_settings",
        },
    )

__all__ = [
    "OWN_VALUES",
    "Checked",
    "check_content",
    "check_listed",
    "check_profile",
    "check_user",
    "find_profile",
    "find_shipped_folder",
    "find_user_folder",
    "find_values",
    "holds_values",
    "list_changeable_folders",
    "list_misnamed",
    "list_profile_folders",
    "list_profiles",
    "load_profile",
    "load_settings",
    "load_unused",
    "load_user",
    "parse_profile",
    "parse_settings",
    "propose_name",
]
