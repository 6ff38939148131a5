"""The model of each place is read off the models; nothing is written down a second time."""

import pytest

from neurotouch_hid.profile import UserSettings
from neurotouch_hid.profile.schema.conditions import Condition, Sequence, WeakRelease
from neurotouch_hid.profile.schema.feedback import Volumes
from neurotouch_hid.profile.schema.profile import Binding, Layer, Profile, Safety, SafetyGesture
from neurotouch_hid.profile.schema.shaping import Expo
from neurotouch_hid.profile.schema.targets import ButtonTarget, MouseMotionTarget, Repeat
from neurotouch_hid.profile.schema.timing import Timing
from neurotouch_hid.profile.schema.tree import find_model
from neurotouch_hid.profile.schema.user import MovementRange, Ranges


@pytest.mark.parametrize(
    ("root", "keys", "value", "model"),
    [
        (Profile, (), None, Profile),
        (Profile, ("bindings",), [], None),
        (Profile, ("bindings", 0), {}, Binding),
        (Profile, ("layers", 1), {}, Layer),
        (Profile, ("layers", 1, "bindings", 0), {}, Binding),
        (Profile, ("layers", "bindings", 0), {}, None),
        (Profile, ("bindings", 0, "when"), {"gesture": "push"}, Condition),
        (Profile, ("bindings", 0, "when"), {"sequence": ["push"]}, Sequence),
        (Profile, ("bindings", 0, "when"), "push", None),
        (Profile, ("bindings", 0, "when", "<pattern>"), None, Condition),
        (Profile, ("bindings", 0, "when", "<pattern>", "release"), {}, WeakRelease),
        (Profile, ("bindings", 0, "do"), {"button": "a"}, ButtonTarget),
        (Profile, ("bindings", 0, "do"), {"mouse": "motion"}, MouseMotionTarget),
        (Profile, ("bindings", 0, "do"), {"button": "a", "key": "a"}, None),
        (Profile, ("bindings", 0, "do", "<motion>"), None, MouseMotionTarget),
        (Profile, ("bindings", 0, "do", "repeat"), {}, Repeat),
        (Profile, ("bindings", 0, "do", "curve"), {"expo": 0.3}, Expo),
        (Profile, ("bindings", 0, "do", "button"), None, None),
        (Profile, ("timing",), "slow", Timing),
        (Profile, ("safety",), {}, Safety),
        (Profile, ("safety", "pause"), {}, SafetyGesture),
        (Profile, ("nothing", "here"), {}, None),
        (UserSettings, ("range",), {}, Ranges),
        (UserSettings, ("range", "push_left"), {}, MovementRange),
        (UserSettings, ("feedback", "volume"), {}, Volumes),
    ],
)
def test_the_model_of_a_place(root, keys, value, model):
    assert find_model(root, keys, value) is model
