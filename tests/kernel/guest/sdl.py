"""A gamepad as a game sees it: SDL 2 and SDL 3, through the libraries inside two wheels."""

import ctypes
import time
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import POINTER, byref, c_bool, c_char_p, c_int, c_int16, c_uint8, c_uint16, c_uint32
from ctypes import c_void_p as pointer
from importlib.metadata import files
from typing import Any

INIT_GAMEPAD = 0x2000
AXES = ("leftx", "lefty", "rightx", "righty", "lefttrigger", "righttrigger")
BUTTONS = (
    *("a", "b", "x", "y", "back", "guide", "start", "leftstick", "rightstick"),
    *("leftshoulder", "rightshoulder", "dpup", "dpdown", "dpleft", "dpright"),
)


class Guid(ctypes.Structure):
    """SDL's name for a kind of joystick."""

    _fields_ = (("data", c_uint8 * 16),)


def load(package: str, name: str) -> ctypes.CDLL:
    """Load the shared library whose file name begins with ``name`` out of an installed wheel."""
    found = [path for path in files(package) or [] if path.name.startswith(name)]
    return ctypes.CDLL(str(found[0].locate()))


def declare(library: ctypes.CDLL, name: str, result: Any, *arguments: Any) -> Any:
    """Return a function of the library with its types."""
    function = getattr(library, name)
    function.restype = result
    function.argtypes = arguments
    return function


class Sdl2:
    """The one gamepad that SDL 2 sees."""

    def __init__(self) -> None:
        library = load("pygame-ce", "libSDL2-2")
        declare(library, "SDL_Init", c_int, c_uint32)(INIT_GAMEPAD)
        self.quit = declare(library, "SDL_Quit", None)
        self.n_joysticks = declare(library, "SDL_NumJoysticks", c_int)()
        self.n_gamepads = sum(
            declare(library, "SDL_IsGameController", c_int, c_int)(index)
            for index in range(self.n_joysticks)
        )
        self.pad = declare(library, "SDL_GameControllerOpen", pointer, c_int)(0)
        self.name = declare(library, "SDL_GameControllerName", c_char_p, pointer)(self.pad)
        self.mapping = declare(library, "SDL_GameControllerMapping", c_char_p, pointer)(self.pad)
        self.guid = declare(library, "SDL_JoystickGetDeviceGUID", Guid, c_int)(0)
        self.update = declare(library, "SDL_GameControllerUpdate", None)
        self.axis = declare(library, "SDL_GameControllerGetAxis", c_int16, pointer, c_int)
        self.button = declare(library, "SDL_GameControllerGetButton", c_uint8, pointer, c_int)
        self.rumble = declare(
            library, "SDL_GameControllerRumble", c_int, pointer, c_uint16, c_uint16, c_uint32
        )
        joystick = declare(library, "SDL_GameControllerGetJoystick", pointer, pointer)(self.pad)
        self.counts = [
            declare(library, f"SDL_JoystickNum{what}", c_int, pointer)(joystick)
            for what in ("Axes", "Buttons", "Hats")
        ]

    def rumbles(self) -> bool:
        """Say whether the pad shakes when told to."""
        return self.rumble(self.pad, 0xFFFF, 0xFFFF, 100) == 0


class Sdl3:
    """The one gamepad that SDL 3 sees."""

    def __init__(self) -> None:
        library = load("tcod", "libSDL3")
        declare(library, "SDL_Init", c_bool, c_uint32)(INIT_GAMEPAD)
        self.quit = declare(library, "SDL_Quit", None)
        count = c_int()
        list_ids = POINTER(c_uint32)
        declare(library, "SDL_GetJoysticks", list_ids, POINTER(c_int))(byref(count))
        self.n_joysticks = count.value
        ids = declare(library, "SDL_GetGamepads", list_ids, POINTER(c_int))(byref(count))
        self.n_gamepads = count.value
        self.pad = declare(library, "SDL_OpenGamepad", pointer, c_uint32)(ids[0])
        self.name = declare(library, "SDL_GetGamepadName", c_char_p, pointer)(self.pad)
        self.mapping = declare(library, "SDL_GetGamepadMapping", c_char_p, pointer)(self.pad)
        self.guid = declare(library, "SDL_GetGamepadGUIDForID", Guid, c_uint32)(ids[0])
        self.update = declare(library, "SDL_UpdateGamepads", None)
        self.axis = declare(library, "SDL_GetGamepadAxis", c_int16, pointer, c_int)
        self.button = declare(library, "SDL_GetGamepadButton", c_bool, pointer, c_int)
        self.rumble = declare(
            library, "SDL_RumbleGamepad", c_bool, pointer, c_uint16, c_uint16, c_uint32
        )
        joystick = declare(library, "SDL_GetGamepadJoystick", pointer, pointer)(self.pad)
        self.counts = [
            declare(library, f"SDL_GetNumJoystick{what}", c_int, pointer)(joystick)
            for what in ("Axes", "Buttons", "Hats")
        ]
        kind = declare(library, "SDL_GetGamepadType", c_int, pointer)(self.pad)
        self.kind = declare(library, "SDL_GetGamepadStringForType", c_char_p, c_int)(kind).decode()

    def rumbles(self) -> bool:
        """Say whether the pad shakes when told to."""
        return bool(self.rumble(self.pad, 0xFFFF, 0xFFFF, 100))


@contextmanager
def open_games() -> Iterator[dict[str, Sdl2 | Sdl3]]:
    """Start both libraries, which find the pads of this moment, and end them again."""
    games = {"sdl2": Sdl2(), "sdl3": Sdl3()}
    yield games
    for game in games.values():
        game.quit()


def describe(game: Sdl2 | Sdl3) -> dict[str, Any]:
    """Return what the library says of its pad, and how long a game hangs when it wants rumble."""
    begun = time.monotonic()
    rumbles = game.rumbles()
    rumble_s = time.monotonic() - begun
    return {
        "n_joysticks": game.n_joysticks,
        "n_gamepads": game.n_gamepads,
        "name": game.name.decode(),
        "guid": bytes(game.guid.data).hex(),
        "mapping": game.mapping.decode(),
        "axes_buttons_hats": game.counts,
        "kind": getattr(game, "kind", None),
        "rumbles": rumbles,
        "rumble_s": rumble_s,
    }


def look(game: Sdl2 | Sdl3) -> dict[str, int]:
    """Return every axis and button that is not at rest."""
    game.update()
    axes = {name: int(game.axis(game.pad, index)) for index, name in enumerate(AXES)}
    buttons = {name: int(game.button(game.pad, index)) for index, name in enumerate(BUTTONS)}
    return {name: value for name, value in {**axes, **buttons}.items() if value}
