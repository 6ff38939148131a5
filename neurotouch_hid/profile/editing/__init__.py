"""Editing profiles and the user's own values: one place changes, and all can be undone."""

from neurotouch_hid.profile.editing.deletion import delete_profile, take_deleted
from neurotouch_hid.profile.editing.edited_file import (
    EditedFile,
    compare,
    find_own_path,
    make_profile,
    read_text,
    take_file,
    take_profile,
    take_user,
)
from neurotouch_hid.profile.editing.paths import list_ways, name_bindings
from neurotouch_hid.profile.editing.phrases import parse_do, parse_when
from neurotouch_hid.profile.editing.remapping import (
    Remapping,
    list_substitutes,
    make_when,
    remap,
    remap_unused,
)
from neurotouch_hid.profile.editing.revision import (
    adopt,
    bind,
    find_bindings,
    forget_schema,
    list_company,
    list_namesakes,
    rebind,
    remove_binding,
    reset_value,
    set_value,
    take_back,
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
    "bind",
    "compare",
    "delete_profile",
    "find_bindings",
    "find_own_path",
    "forget_schema",
    "list_company",
    "list_namesakes",
    "list_substitutes",
    "list_ways",
    "make_profile",
    "make_when",
    "name_bindings",
    "parse_do",
    "parse_value",
    "parse_when",
    "read_text",
    "rebind",
    "remap",
    "remap_unused",
    "remove_binding",
    "reset_value",
    "set_value",
    "take_back",
    "take_deleted",
    "take_file",
    "take_profile",
    "take_user",
    "unbind",
    "upgrade",
]
