"""The HID report byte by byte, and back."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.device.outputs.descriptor import ReportFormat
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.messages import Axis, Button, GamepadState

LAYOUT = load_identities()["own"].layout
FORMAT = ReportFormat(LAYOUT.controls)

DESCRIPTOR = """
05 01 09 08 a1 01  05 01 09 05 a1 00
09 30 09 31 09 33 09 34  16 00 80 26 ff 7f  75 10 95 04 81 02
09 32 09 35  15 00 26 ff 00  75 08 95 02 81 02
09 39  15 01 25 08 35 00 46 3b 01 65 14  75 04 95 01 81 42  95 01 81 01  45 00 65 00
05 09  09 01 09 02 09 04 09 05 09 07 09 08 09 0b 09 0c 09 0d 09 0e 09 0f
15 00 25 01 75 01 95 0b 81 02  95 05 81 01  c0 c0
"""
REST = "0000 0000 0000 0000 00 00 00 0000"


def pack(*buttons: Button, **axes: float) -> bytes:
    state = GamepadState(0, frozenset(buttons), {Axis(name): value for name, value in axes.items()})
    return FORMAT.pack(LAYOUT.encode(state))


def test_the_descriptor():
    assert FORMAT.descriptor == bytes.fromhex(DESCRIPTOR)


@pytest.mark.parametrize(
    ("report", "expected"),
    [
        (pack(), REST),
        (pack(left_x=1.0), "ff7f 0000 0000 0000 00 00 00 0000"),
        (pack(left_y=-1.0), "0000 0180 0000 0000 00 00 00 0000"),
        (pack(right_x=1.0), "0000 0000 ff7f 0000 00 00 00 0000"),
        (pack(right_y=1.0), "0000 0000 0000 ff7f 00 00 00 0000"),
        (pack(left_trigger=1.0), "0000 0000 0000 0000 ff 00 00 0000"),
        (pack(right_trigger=0.5), "0000 0000 0000 0000 00 80 00 0000"),
        (pack(dpad_y=-1.0), "0000 0000 0000 0000 00 00 01 0000"),
        (pack(dpad_x=1.0, dpad_y=-1.0), "0000 0000 0000 0000 00 00 02 0000"),
        (pack(dpad_x=1.0), "0000 0000 0000 0000 00 00 03 0000"),
        (pack(dpad_y=1.0), "0000 0000 0000 0000 00 00 05 0000"),
        (pack(dpad_x=-1.0, dpad_y=-1.0), "0000 0000 0000 0000 00 00 08 0000"),
        (pack(Button.A), "0000 0000 0000 0000 00 00 00 0100"),
        (pack(Button.X, Button.RS), "0000 0000 0000 0000 00 00 00 0404"),
        (pack(*Button), "0000 0000 0000 0000 00 00 00 ff07"),
    ],
)
def test_a_report(report, expected):
    assert report == bytes.fromhex(expected)


@pytest.mark.parametrize("name", load_identities())
@given(
    buttons=st.frozensets(st.sampled_from(list(Button))),
    axes=st.dictionaries(st.sampled_from(list(Axis)), st.floats(-1, 1)),
)
def test_what_is_packed_comes_out_again(name, buttons, axes):
    layout = load_identities()[name].layout
    form = ReportFormat(layout.controls)
    values = layout.encode(GamepadState(0, buttons, axes))
    assert form.unpack(form.pack(values)) == values


@pytest.mark.parametrize("size", [0, 12, 14])
def test_another_length_is_no_report(size):
    with pytest.raises(ValueError, match="13 bytes"):
        FORMAT.unpack(bytes(size))


def test_a_hat_beyond_its_values_is_centred():
    report = bytes.fromhex("0000 0000 0000 0000 00 00 0f 0000")
    assert FORMAT.unpack(report) == LAYOUT.encode(GamepadState(0))
