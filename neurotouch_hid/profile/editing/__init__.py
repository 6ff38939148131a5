"""Edits profiles and the user's own values: one place changes, and all can be undone.

A name loads its module when it is first asked for: writing a file needs no YAML and no model.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
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
    from neurotouch_hid.profile.editing.edit_values import reset_value, set_value, take_back
    from neurotouch_hid.profile.editing.edited_file import (
        EditedFile,
        compare,
        find_own_path,
        find_schema,
        make_profile,
        read_text,
        take_file,
        take_profile,
        take_user,
    )
    from neurotouch_hid.profile.editing.effect import (
        SavedEffect,
        hand_over_restored,
        hand_over_saved,
    )
    from neurotouch_hid.profile.editing.favourites import make_favourite
    from neurotouch_hid.profile.editing.file_header import MODELINE, adopt, forget_schema, upgrade
    from neurotouch_hid.profile.editing.key_paths import list_key_paths, name_bindings
    from neurotouch_hid.profile.editing.profile_text import ProfileText
    from neurotouch_hid.profile.editing.questions import (
        GESTURES,
        OUTPUTS,
        PRESSES,
        list_questions,
        list_words,
        sample_response,
    )
    from neurotouch_hid.profile.editing.remapping import (
        list_substitutes,
        make_when,
        remap,
        remap_unused,
    )
    from neurotouch_hid.profile.editing.store import Store
    from neurotouch_hid.profile.editing.summary import TOUR, summarize, summarize_binding
    from neurotouch_hid.profile.editing.yaml_values import format_value, parse_value
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "binding_words": "parse_do parse_when",
            "deletion": "delete_profile take_deleted",
            "edit_bindings": "bind list_company list_namesakes locate_bindings rebind "
            "remove_binding unbind",
            "edit_values": "reset_value set_value take_back",
            "edited_file": "EditedFile compare find_own_path find_schema make_profile read_text "
            "take_file take_profile take_user",
            "effect": "SavedEffect hand_over_restored hand_over_saved",
            "favourites": "make_favourite",
            "file_header": "MODELINE adopt forget_schema upgrade",
            "key_paths": "list_key_paths name_bindings",
            "profile_text": "ProfileText",
            "questions": "GESTURES OUTPUTS PRESSES list_questions list_words sample_response",
            "remapping": "list_substitutes make_when remap remap_unused",
            "store": "Store",
            "summary": "TOUR summarize summarize_binding",
            "yaml_values": "format_value parse_value",
        },
    )

__all__ = [
    "GESTURES",
    "MODELINE",
    "OUTPUTS",
    "PRESSES",
    "TOUR",
    "EditedFile",
    "ProfileText",
    "SavedEffect",
    "Store",
    "adopt",
    "bind",
    "compare",
    "delete_profile",
    "find_own_path",
    "find_schema",
    "forget_schema",
    "format_value",
    "hand_over_restored",
    "hand_over_saved",
    "list_company",
    "list_key_paths",
    "list_namesakes",
    "list_questions",
    "list_substitutes",
    "list_words",
    "locate_bindings",
    "make_favourite",
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
    "sample_response",
    "set_value",
    "summarize",
    "summarize_binding",
    "take_back",
    "take_deleted",
    "take_file",
    "take_profile",
    "take_user",
    "unbind",
    "upgrade",
]
