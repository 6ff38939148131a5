"""The watch over real mice as its thread meets them; in a real kernel it is tested too."""

import os
from pathlib import Path

import pytest
from evdev import InputEvent, ecodes

from neurotouch_hid.device.inputs import mouse_watch as mousewatch
from neurotouch_hid.device.inputs.mouse_watch import MouseWatch
from neurotouch_hid.device.inputs.nodes import Input
from tests.waiting import wait_until

LIMIT_S = 60.0
ODD, PLAIN = (
    Input(
        Path(f"/dev/input/event{number}"),
        "Mouse",
        "usb-1",
        "",
        1,
        number,
        1 << ecodes.BTN_LEFT,
        0,
        1 << ecodes.REL_X,
        0,
    )
    for number in (1, 2)
)


class Mouse:
    """An opened mouse that moves whenever a byte is written to ``hand``."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.fd, self.hand = os.pipe2(os.O_NONBLOCK)

    def read(self):
        os.read(self.fd, 1)
        yield InputEvent(0, 0, ecodes.EV_REL, ecodes.REL_X, 1)

    def close(self) -> None:
        os.close(self.fd)
        os.close(self.hand)


@pytest.fixture
def mice(monkeypatch):
    """The mice that are plugged in, and those that have been opened."""
    plugged: list[Input] = []
    opened: list[Mouse] = []

    def open_mouse(path: Path) -> Mouse:
        if path == ODD.node:
            b"Mou\xff".decode()  # as evdev does
        opened.append(Mouse(path))
        return opened[-1]

    monkeypatch.setattr(Input, "readable", True)
    monkeypatch.setattr(mousewatch, "_SEARCH_S", 0.01)
    monkeypatch.setattr(mousewatch, "find_inputs", lambda: list(plugged))
    monkeypatch.setattr(mousewatch, "InputDevice", open_mouse)
    return plugged, opened


@pytest.mark.parametrize("comes_later", [False, True])
def test_a_mouse_whose_name_is_no_text_keeps_no_other_from_being_watched(mice, comes_later):
    plugged, opened = mice
    if not comes_later:
        plugged.append(ODD)
    watch = MouseWatch()
    try:
        plugged.extend([ODD, PLAIN] if comes_later else [PLAIN])
        wait_until(lambda: opened)
        os.write(opened[0].hand, b"x")
        wait_until(lambda: watch.quiet_s < 1e6)
    finally:
        watch.close()
