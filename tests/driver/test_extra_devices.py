"""Which profiles ask for a keyboard or a mouse."""

import pytest

from neurotouch_hid.device import ExtraDevice
from neurotouch_hid.driver.extra_devices import find_extra_devices
from neurotouch_hid.profile import load_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.profile.schema.profile import Profile

KEYBOARD, MOUSE = ExtraDevice.KEYBOARD, ExtraDevice.MOUSE
SHIPPED = {"keyboard-arrows": {KEYBOARD}, "media-keys": {KEYBOARD}, "mouse": {MOUSE}}
NAMES = sorted(path.stem for path in find_shipped_folder().glob("*.yaml"))


@pytest.mark.parametrize("name", NAMES)
def test_shipped_profiles(name):
    profile = load_profile(find_shipped_folder() / f"{name}.yaml")
    used = find_extra_devices(profile)
    text = (find_shipped_folder() / f"{name}.yaml").read_text()
    assert (KEYBOARD in used) == ("{key: " in text)
    assert (MOUSE in used) == ("{mouse: " in text)
    assert used == SHIPPED.get(name, used)


@pytest.mark.parametrize(
    ("target", "used"),
    [
        ({"button": "a"}, set()),
        ({"key": "ctrl+c"}, {KEYBOARD}),
        ({"mouse": "left"}, {MOUSE}),
        ({"mouse": "motion"}, {MOUSE}),
        ({"mouse": "wheel"}, {MOUSE}),
        ({"command": "pause"}, set()),
    ],
)
def test_a_layer_that_is_not_there_at_first_counts(target, used):
    profile = Profile.model_validate(
        {
            "version": 1,
            "name": "two",
            "layers": [
                {"name": "base", "bindings": [{"when": "pinch", "do": {"layer": "more"}}]},
                {"name": "more", "bindings": [{"when": "push", "do": target}]},
            ],
        }
    )
    assert find_extra_devices(profile) == used
