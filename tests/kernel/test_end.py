"""However the pad ends, nothing stays pressed."""

from neurotouch_hid.device.gamepad import AXES, BUTTONS

KEY_RELEASES = {(1, control.code, 0) for control in BUTTONS.values()}
AXIS_RELEASES = {(3, control.code, 0) for control in AXES.values()}


def after_the_press(seen: dict) -> set[tuple[int, ...]]:
    """What came after the last control went out; the ends of frames left out."""
    events = [tuple(event) for event in seen["events"]]
    pressed = events.index((3, 17, 1))
    assert len({event for event in events[: pressed + 1] if event[0]}) == 19
    return {event for event in events[pressed + 1 :] if event[0]}


def test_closing_releases_everything_then_the_pad_is_gone(guest):
    seen = guest("closed")
    assert after_the_press(seen) == KEY_RELEASES | AXIS_RELEASES
    assert seen["ended"] == "No such device"
    assert not seen["node_left"]


def test_kill_9_leaves_no_key_pressed_and_no_pad(guest):
    seen = guest("killed")
    assert after_the_press(seen) == KEY_RELEASES
    assert seen["ended"] == "No such device"
    assert not seen["node_left"]
