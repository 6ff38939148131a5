"""Editing profiles and the user's own values: one place changes, and all can be undone."""

from neurotouch_hid.profile.editing.edited_file import (
    EditedFile,
    compare,
    find_own_path,
    make_profile,
    read_text,
    take_paper,
    take_profile,
    take_user,
)
from neurotouch_hid.profile.editing.paths import list_ways, name_bindings
from neurotouch_hid.profile.editing.phrases import parse_do, parse_when
from neurotouch_hid.profile.editing.remapping import (
    Remapping,
    avoid,
    hand_over,
    list_wishes,
    make_when,
)
from neurotouch_hid.profile.editing.revision import (
    adopt,
    bind,
    find_bindings,
    reset_value,
    set_value,
    unbind,
    upgrade,
)
from neurotouch_hid.profile.editing.store import Store, Version
from neurotouch_hid.profile.editing.values import parse_value

__all__ = [
    "EditedFile",
    "Remapping",
    "Store",
    "Version",
    "adopt",
    "avoid",
    "bind",
    "compare",
    "find_bindings",
    "find_own_path",
    "hand_over",
    "list_ways",
    "list_wishes",
    "make_profile",
    "make_when",
    "name_bindings",
    "parse_do",
    "parse_value",
    "parse_when",
    "read_text",
    "reset_value",
    "set_value",
    "take_paper",
    "take_profile",
    "take_user",
    "unbind",
    "upgrade",
]
