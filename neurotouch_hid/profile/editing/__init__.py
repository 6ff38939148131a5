"""Editing profiles and the user's own values: one place changes, and all can be undone."""

from neurotouch_hid.profile.editing.binding_words import parse_do, parse_when
from neurotouch_hid.profile.editing.deletion import delete_profile, take_deleted
from neurotouch_hid.profile.editing.edit_bindings import (
    bind,
    list_company,
    list_namesakes,
    locate_bindings,
    rebind,
    remove_binding,
    unbind,
)
from neurotouch_hid.profile.editing.edit_values import reset_value, set_value
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
from neurotouch_hid.profile.editing.file_header import adopt, forget_schema, upgrade
from neurotouch_hid.profile.editing.key_paths import list_key_paths, name_bindings
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.editing.remapping import (
    Remapping,
    list_substitutes,
    make_when,
    remap,
    remap_unused,
)
from neurotouch_hid.profile.editing.store import Store, Version
from neurotouch_hid.profile.editing.yaml_values import parse_value

__all__ = [
    "EditedFile",
    "ProfileText",
    "Remapping",
    "Store",
    "Version",
    "adopt",
    "bind",
    "compare",
    "delete_profile",
    "find_own_path",
    "forget_schema",
    "list_company",
    "list_key_paths",
    "list_namesakes",
    "list_substitutes",
    "locate_bindings",
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
    "take_deleted",
    "take_file",
    "take_profile",
    "take_user",
    "unbind",
    "upgrade",
]
