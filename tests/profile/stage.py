"""What the tests of the mapping share: a profile from lines, a script, a timeline."""

from neurotouch_hid.messages import GamepadState, Gesture
from neurotouch_hid.profile import Mapping, Profile, UserSettings, perform, rehearse
from neurotouch_hid.profile.reading.load import parse_profile

RAW = UserSettings(filter="none")


def make_profile(*bindings: str, more: str = "") -> Profile:
    """A profile of one layer; ``more`` are further lines at its top level."""
    lines = "".join(f"  - {{{binding}}}\n" for binding in bindings)
    return parse_profile(f"version: 1\nname: x\n{more}\nbindings:\n{lines}".encode(), "x.yaml")


def tell(profile: Profile, script: str, user: UserSettings = RAW) -> list[str]:
    """``ms what`` for every change of an output and everything that was ignored."""
    mapping = Mapping(profile, user)
    return [
        f"{moment.t_us // 1000} {change}"
        for moment in perform(mapping, rehearse(script))
        for change in moment.changes
    ]


def run(mapping: Mapping, script: str, start_us: int = 0) -> list[GamepadState]:
    """All states of a script that begins at ``start_us``."""
    return [mapping.update(shift(gesture, start_us)) for gesture in rehearse(script)]


def shift(gesture: Gesture, by_us: int) -> Gesture:
    return Gesture(
        gesture.t_us + by_us,
        gesture.kind,
        gesture.contacts_mm,
        gesture.contacts_px,
        gesture.intensity_mm,
        gesture.translation_mm,
    )
