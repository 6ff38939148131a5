"""Finds the virtual keyboard and mouse that a profile needs beside the pad."""

from neurotouch_hid.device import ExtraDevice
from neurotouch_hid.profile import Profile
from neurotouch_hid.profile.schema import (
    KeyTarget,
    MouseButtonTarget,
    MouseMotionTarget,
    MouseWheelTarget,
)


def find_extra_devices(profile: Profile) -> frozenset[ExtraDevice]:
    """Returns the nodes that any binding in any layer of the profile can use."""
    targets = [binding.do for layer in profile.all_layers for binding in layer.bindings]
    found = set()
    if any(isinstance(target, KeyTarget) for target in targets):
        found.add(ExtraDevice.KEYBOARD)
    mice = MouseButtonTarget | MouseMotionTarget | MouseWheelTarget
    if any(isinstance(target, mice) for target in targets):
        found.add(ExtraDevice.MOUSE)
    return frozenset(found)
