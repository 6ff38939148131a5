"""However the pad ends, nothing stays pressed."""

import pytest

from neurotouch_hid.device.outputs.identity import load_identities

XBOX = load_identities()["xbox360"].layout
KEY_RELEASES = {(1, control.code, 0) for control in XBOX.buttons.values()}
AXIS_RELEASES = {(3, control.code, 0) for control in XBOX.axes.values()}


def after_the_press(seen: dict) -> set[tuple[int, ...]]:
    """What came after the last control went out; the ends of frames left out."""
    events = [tuple(event) for event in seen["events"] if event[0] != 4]  # scan codes
    pressed = events.index((0, 0, 0), events.index((3, 17, 1)))  # the end of its frame
    assert len({event for event in events[: pressed + 1] if event[0]}) == 19
    return {event for event in events[pressed + 1 :] if event[0]}


@pytest.mark.parametrize("pad", ["closed", "closed_hid"])
def test_closing_releases_everything_then_the_pad_is_gone(guest, pad):
    seen = guest(pad)
    assert after_the_press(seen) == KEY_RELEASES | AXIS_RELEASES
    assert seen["ended"] == "No such device"
    assert not seen["node_left"]


@pytest.mark.parametrize("pad", ["killed", "killed_hid"])
def test_kill_9_leaves_no_key_pressed_and_no_pad(guest, pad):
    seen = guest(pad)
    assert after_the_press(seen) == KEY_RELEASES
    assert seen["ended"] == "No such device"
    assert not seen["node_left"]
