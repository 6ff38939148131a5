"""Names of keyboard keys and mouse buttons, for people, and what the kernel calls them."""

from collections.abc import Collection, Mapping
from string import ascii_lowercase, digits
from types import MappingProxyType
from typing import Final

from pydantic_core import PydanticCustomError

from neurotouch_hid.files.faults import suggest

_NAMED: Final = {
    "ctrl": "LEFTCTRL",
    "shift": "LEFTSHIFT",
    "alt": "LEFTALT",
    "super": "LEFTMETA",
    "right_ctrl": "RIGHTCTRL",
    "right_shift": "RIGHTSHIFT",
    "altgr": "RIGHTALT",
    "right_super": "RIGHTMETA",
    "enter": "ENTER",
    "escape": "ESC",
    "space": "SPACE",
    "tab": "TAB",
    "backspace": "BACKSPACE",
    "delete": "DELETE",
    "insert": "INSERT",
    "home": "HOME",
    "end": "END",
    "page_up": "PAGEUP",
    "page_down": "PAGEDOWN",
    "up": "UP",
    "down": "DOWN",
    "left": "LEFT",
    "right": "RIGHT",
    "minus": "MINUS",
    "equal": "EQUAL",
    "left_bracket": "LEFTBRACE",
    "right_bracket": "RIGHTBRACE",
    "semicolon": "SEMICOLON",
    "apostrophe": "APOSTROPHE",
    "grave": "GRAVE",
    "backslash": "BACKSLASH",
    "comma": "COMMA",
    "dot": "DOT",
    "slash": "SLASH",
    "caps_lock": "CAPSLOCK",
    "num_lock": "NUMLOCK",
    "scroll_lock": "SCROLLLOCK",
    "print": "SYSRQ",
    "pause": "PAUSE",
    "menu": "COMPOSE",
    "keypad_plus": "KPPLUS",
    "keypad_minus": "KPMINUS",
    "keypad_times": "KPASTERISK",
    "keypad_divide": "KPSLASH",
    "keypad_dot": "KPDOT",
    "keypad_enter": "KPENTER",
    "play": "PLAYPAUSE",
    "stop": "STOPCD",
    "next": "NEXTSONG",
    "previous": "PREVIOUSSONG",
    "rewind": "REWIND",
    "fast_forward": "FASTFORWARD",
    "mute": "MUTE",
    "volume_up": "VOLUMEUP",
    "volume_down": "VOLUMEDOWN",
    "mic_mute": "MICMUTE",
    "brightness_up": "BRIGHTNESSUP",
    "brightness_down": "BRIGHTNESSDOWN",
    "back": "BACK",
    "forward": "FORWARD",
    "refresh": "REFRESH",
    "home_page": "HOMEPAGE",
    "search": "SEARCH",
}

KEYS: Final[Mapping[str, str]] = MappingProxyType(
    {name: f"KEY_{name.upper()}" for name in (*ascii_lowercase, *digits)}
    | {f"f{number}": f"KEY_F{number}" for number in range(1, 25)}
    | {f"keypad_{digit}": f"KEY_KP{digit}" for digit in digits}
    | {name: f"KEY_{kernel}" for name, kernel in _NAMED.items()}
)
"""Every key a profile can name, by position on a US keyboard; the layout is the desktop's."""

MOUSE_BUTTONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "left": "BTN_LEFT",
        "right": "BTN_RIGHT",
        "middle": "BTN_MIDDLE",
        "back": "BTN_SIDE",
        "forward": "BTN_EXTRA",
    }
)
"""Every mouse button a profile can name."""

MAX_CHORD: Final = 5


def parse_chord(text: str) -> tuple[str, ...]:
    """Returns the kernel's names of the keys in a chord such as ``ctrl+shift+c``.

    Raises:
        PydanticCustomError: a key has another name, is there twice, or there are too many.
    """
    names = text.split("+")
    for name in names:
        if name not in KEYS:
            near = suggest(name, list(KEYS)) if name else 'the key itself is called "equal"'
            raise PydanticCustomError(
                "key", "'{key}' is not the name of a key", {"key": name, "hint": near}
            )
    if len(set(names)) < len(names):
        raise PydanticCustomError("key_twice", "a key is in this chord twice")
    if len(names) > MAX_CHORD:
        raise PydanticCustomError(
            "chord", "a chord has at most {most} keys", {"most": str(MAX_CHORD)}
        )
    return tuple(KEYS[name] for name in names)


def is_order_to_kernel(kernel_names: Collection[str]) -> bool:
    """Returns True of a chord with Alt and Print, which begins a "magic" order to Linux itself."""
    return "KEY_SYSRQ" in kernel_names and not {"KEY_LEFTALT", "KEY_RIGHTALT"}.isdisjoint(
        kernel_names
    )
