"""The virtual keyboard, with the keys that a profile can name.

Keys are positions; the desktop's layout decides which letters they are. They are not on the pad,
because udev takes a pad with four of them for a keyboard.
"""

from functools import lru_cache

from evdev import ecodes

from neurotouch_hid.device.outputs.spec import DeviceSpec, make_key
from neurotouch_hid.messages import GamepadState

NAME = "NeuroTouch Keyboard"
IDS = (ecodes.BUS_VIRTUAL, 0x0000, 0x0001, 0x0001)
"""Bus, vendor, product, version. No program needs to know this keyboard by its ids, so it borrows
none: on the virtual bus vendors are not assigned, and 0 means that there is no hardware. The
product only keeps it apart from the mouse, where a desktop keeps settings by ids."""

PHYS = "neurotouch/keyboard0"

_ROWS = (
    # First what modifies: a chord goes down modifiers first, and comes up modifiers last.
    "LEFTCTRL LEFTSHIFT LEFTALT LEFTMETA RIGHTCTRL RIGHTSHIFT RIGHTALT RIGHTMETA",
    "ESC F1 F2 F3 F4 F5 F6 F7 F8 F9 F10 F11 F12 SYSRQ SCROLLLOCK PAUSE",
    "F13 F14 F15 F16 F17 F18 F19 F20 F21 F22 F23 F24",
    "GRAVE 1 2 3 4 5 6 7 8 9 0 MINUS EQUAL BACKSPACE",
    "TAB Q W E R T Y U I O P LEFTBRACE RIGHTBRACE BACKSLASH",
    "CAPSLOCK A S D F G H J K L SEMICOLON APOSTROPHE ENTER",
    "Z X C V B N M COMMA DOT SLASH SPACE COMPOSE",
    "INSERT HOME PAGEUP DELETE END PAGEDOWN UP LEFT DOWN RIGHT",
    "NUMLOCK KPSLASH KPASTERISK KPMINUS KP7 KP8 KP9 KPPLUS KP4 KP5 KP6 KP1 KP2 KP3 KPENTER",
    "KP0 KPDOT",
    "PLAYPAUSE STOPCD PREVIOUSSONG NEXTSONG REWIND FASTFORWARD",
    "MUTE VOLUMEDOWN VOLUMEUP MICMUTE BRIGHTNESSDOWN BRIGHTNESSUP",
    "BACK FORWARD REFRESH HOMEPAGE SEARCH",
)

KEYS = {
    name: make_key(ecodes.ecodes[name])
    for name in (f"KEY_{key}" for row in _ROWS for key in row.split())
}
"""Every key, by the kernel's name. ESC to S are all there: that is how udev knows a keyboard.

No power or sleep key: no gesture should switch the machine off. No auto-repeat of the kernel's
(EV_REP): desktops repeat by themselves, and a key must not repeat while this program stalls.
"""

SPEC = DeviceSpec(NAME, IDS, PHYS, tuple(KEYS.values()))


_ALTS = {"KEY_LEFTALT", "KEY_RIGHTALT"}
_SYSRQ = "KEY_SYSRQ"


def encode_keys(state: GamepadState) -> tuple[int, ...]:
    """Returns the report of a state: 1 for every key that is down, in the order of KEYS.

    Print is not down while Alt is: to the kernel the two begin its magic keys, and with B as the
    third many distributions let it reboot on the spot. A profile from a stranger must not do that.
    """
    keys = state.keys if state.keys.isdisjoint(_ALTS) else state.keys - {_SYSRQ}
    return _report(keys)


@lru_cache(maxsize=64)  # nearly always the same few, a hundred times a second
def _report(keys: frozenset[str]) -> tuple[int, ...]:
    return tuple(int(name in keys) for name in KEYS)
