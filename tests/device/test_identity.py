"""Identities as data, and the refusal of those that programs would misread."""

import os

import pytest

from neurotouch_hid.device.outputs.identity import (
    Identity,
    check_identity,
    choose_identity,
    load_identities,
)
from neurotouch_hid.errors import DeviceError

SHIPPED = load_identities()


def make(**changes: object) -> Identity:
    usual = {"name": "A pad", "vendor": 0x1234, "product": 0x5678, "version": 0x0100}
    return Identity(**{**usual, **changes}, layout=SHIPPED["own"].layout)


@pytest.mark.parametrize(
    ("name", "text", "ids"),
    [
        ("xbox360", "Microsoft X-Box 360 pad", (3, 0x045E, 0x028E, 0x0110)),
        ("own", "NeuroTouch Gamepad", (3, 0x1209, 0x4E54, 0x0100)),
        (
            "playstation",
            "Sony Interactive Entertainment Wireless Controller",
            (3, 0x054C, 0x09CC, 0x8111),
        ),
    ],
)
def test_what_each_shipped_one_claims(name, text, ids):
    spec = SHIPPED[name].make_spec(player=2)
    assert (spec.name, spec.ids, spec.phys) == (text, ids, "neurotouch/pad1")
    assert not spec.rumbles
    check_identity(SHIPPED[name], "uinput")


def test_the_usual_ones():
    assert choose_identity(None, "uinput") is SHIPPED["xbox360"]
    assert choose_identity(None, "hid") is SHIPPED["own"]


@pytest.mark.parametrize("name", ["xbox360", "playstation"])
def test_the_makers_ids_are_refused_for_hid(name):
    with pytest.raises(DeviceError, match="through hidraw and would misread") as caught:
        choose_identity(name, "hid")
    assert "'own'" in caught.value.hint


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"vendor": 0}, "ids that are 0"),
        ({"product": 0}, "ids that are 0"),
        ({"vendor": 0x28DE, "product": 0x11FF}, "Steam's own"),
        ({"vendor": 0x045E, "product": 0x028E, "version": 1}, "inverted D-pad"),
        ({"vendor": 0x045E, "product": 0x028E, "version": 0x0210}, "another maker's"),
        ({"vendor": 0x1209, "product": 0x0001}, "private tests"),
        ({"vendor": 0x1209, "product": 0x0010}, "private tests"),
    ],
)
def test_ids_that_are_misread_are_refused_with_the_reason(changes, reason):
    with pytest.raises(DeviceError, match=reason):
        check_identity(make(**changes), "uinput")


@pytest.mark.parametrize(
    "name",
    [
        *("uinput-pad", "Mouse pad", "gpio_ir_recv", "My Keyboard pad", "Trackpad", "A Clickpad"),
        *(
            "Synaptics pad",
            "The Laptop pad",
            "An LED pad",
            "A Thelio pad",
            "My Motion Sensors",
        ),
        *(
            "My IMU",
            "My Touchpad",
            "My Accelerometer",
            "My IR",
            "My Motion Plus",
            "My Nunchuk",
        ),
        *("My Pen", "My Finger", "My System Control"),
    ],
)
def test_names_that_sdl_ignores_are_refused(name):
    with pytest.raises(DeviceError, match="SDL would ignore"):
        check_identity(make(name=name), "uinput")


@pytest.mark.parametrize(
    ("name", "kind", "right"),
    [
        ("x" * 79, "uinput", True),
        ("x" * 80, "uinput", False),
        ("ä" * 40, "uinput", False),
        ("x" * 80, "hid", True),
        ("x" * 128, "hid", False),
        ("", "uinput", False),
        ("a\nb", "uinput", False),
    ],
)
def test_names_fit_the_kernel(name, kind, right):
    if right:
        check_identity(make(name=name), kind)
    else:
        with pytest.raises(DeviceError, match="is not a valid name for a pad"):
            check_identity(make(name=name), kind)


OWN = """
name = "My gel"
vendor = 0x1209
product = 0x4E54
version = 0x0101
layout = "xbox"
"""


def test_an_identity_of_ones_own(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(OWN)
    identity = choose_identity(str(file), "hid")
    assert (identity.name, identity.version) == ("My gel", 0x0101)
    assert identity.layout == SHIPPED["own"].layout


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"xbox"', '"nes"', "'layout' must be one of xbox, playstation"),
        ("0x1209", "70000", "'vendor' must be set, to a number"),
        ("0x1209", '"1209"', "'vendor' must be set, to a number"),
        ("0x1209", "true", "'vendor' must be set, to a number"),
        ("name", "title", "'name' must be set, to text"),
        ("version", "extra = 1\nversion", "unknown key 'extra'"),
        ("version =", "version", "is not valid TOML"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, old, new, says):
    file = tmp_path / "mine.toml"
    file.write_text(OWN.replace(old, new, 1))
    with pytest.raises(DeviceError, match=says):
        choose_identity(str(file), "uinput")


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(DeviceError, match="cannot be read: No such file"):
        choose_identity(str(tmp_path / "mine.toml"), "uinput")


def test_an_unknown_name():
    with pytest.raises(DeviceError, match="no identity called 'nes'") as caught:
        choose_identity("nes", "uinput")
    assert "xbox360, own, playstation" in caught.value.hint


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a = " + "[" * 20_000, "has too many brackets in one another|is not valid TOML"),
        ("a = " + "9" * 5_000, "is not valid TOML"),
        ("# " + "x" * (1 << 20), "cannot be read: it is larger than 64 kB"),
    ],
    ids=["deep", "long", "large"],
)
def test_a_file_made_to_harm(tmp_path, text, says):
    file = tmp_path / "mine.toml"
    file.write_text(text)
    with pytest.raises(DeviceError, match=says):
        choose_identity(str(file), "uinput")


def test_a_path_that_is_no_file(tmp_path):
    with pytest.raises(DeviceError, match="cannot be read: no file can have this name"):
        choose_identity("a\0.toml", "uinput")
    os.mkfifo(tmp_path / "pipe.toml")
    with pytest.raises(DeviceError, match="cannot be read: it is a pipe, not a file"):
        choose_identity(str(tmp_path / "pipe.toml"), "uinput")
