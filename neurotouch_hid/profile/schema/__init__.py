"""The models of the profile and of the user's file: what each may say.

A name loads its module when it is first asked for.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.profile.schema.conditions import Condition
    from neurotouch_hid.profile.schema.feedback import Feedback, SoundName, Volumes
    from neurotouch_hid.profile.schema.keyboard_keys import KEYS, parse_chord
    from neurotouch_hid.profile.schema.layering import merge_bindings
    from neurotouch_hid.profile.schema.movements import MOVEMENTS, MovementName
    from neurotouch_hid.profile.schema.profile import (
        FIRST_LAYER,
        Binding,
        Profile,
        SafetyGesture,
        SettingsFile,
        make_schema,
        profile_schema,
    )
    from neurotouch_hid.profile.schema.shaping import Expo, Points, Power, Shaped
    from neurotouch_hid.profile.schema.strict import Strict, give_unit, make_optional
    from neurotouch_hid.profile.schema.targets import (
        KeyTarget,
        MouseButtonTarget,
        MouseMotionTarget,
        MouseWheelTarget,
    )
    from neurotouch_hid.profile.schema.timing import FilterName, Timing, resolve_times
    from neurotouch_hid.profile.schema.user import (
        MovementRange,
        UserSettings,
        choose_filter,
        user_schema,
    )
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "conditions": "Condition",
            "feedback": "Feedback SoundName Volumes",
            "keyboard_keys": "KEYS parse_chord",
            "layering": "merge_bindings",
            "movements": "MOVEMENTS MovementName",
            "profile": "FIRST_LAYER Binding Profile SafetyGesture SettingsFile make_schema "
            "profile_schema",
            "shaping": "Expo Points Power Shaped",
            "strict": "Strict give_unit make_optional",
            "targets": "KeyTarget MouseButtonTarget MouseMotionTarget MouseWheelTarget",
            "timing": "FilterName Timing resolve_times",
            "user": "MovementRange UserSettings choose_filter user_schema",
        },
    )

__all__ = [
    "FIRST_LAYER",
    "KEYS",
    "MOVEMENTS",
    "Binding",
    "Condition",
    "Expo",
    "Feedback",
    "FilterName",
    "KeyTarget",
    "MouseButtonTarget",
    "MouseMotionTarget",
    "MouseWheelTarget",
    "MovementName",
    "MovementRange",
    "Points",
    "Power",
    "Profile",
    "SafetyGesture",
    "SettingsFile",
    "Shaped",
    "SoundName",
    "Strict",
    "Timing",
    "UserSettings",
    "Volumes",
    "choose_filter",
    "give_unit",
    "make_optional",
    "make_schema",
    "merge_bindings",
    "parse_chord",
    "profile_schema",
    "resolve_times",
    "user_schema",
]
