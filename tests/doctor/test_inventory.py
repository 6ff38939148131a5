"""Game controllers as Linux lists them."""

import pytest

from neurotouch_hid.doctor.inventory import find_pads

XBOX_KEYS = "7cdb000000000000 0 0 0 0"
"""The eleven buttons of an Xbox pad, as the kernel writes them on 64 bit."""


@pytest.fixture
def machine(tmp_path):
    """A folder like /sys/class/input, with links into one like /sys/devices."""

    def plug(number, name, *, keys=XBOX_KEYS, axes="3003f", place="", virtual=True):
        kind = "virtual/input" if virtual else "pci0000:00/usb1"
        device = tmp_path / f"sys/devices/{kind}/input{number}"
        for folder in ("capabilities", "id"):
            (device / folder).mkdir(parents=True)
        ids = {"bustype": "0003", "vendor": "045e", "product": "028e", "version": "0110"}
        files = {"name": name, "phys": place, "capabilities/key": keys, "capabilities/abs": axes}
        for file, text in (files | {f"id/{key}": value for key, value in ids.items()}).items():
            (device / file).write_text(f"{text}\n")
        entry = device / f"event{number}"
        entry.mkdir()
        (entry / "device").symlink_to("..")
        (tmp_path / "class").mkdir(exist_ok=True)
        (tmp_path / f"class/event{number}").symlink_to(entry)
        (tmp_path / "dev").mkdir(exist_ok=True)
        (tmp_path / f"dev/event{number}").touch()

    plug.find = lambda: find_pads(tmp_path / "class", tmp_path / "dev")
    (tmp_path / "class").mkdir()
    return plug


def test_none(machine):
    assert machine.find() == ()


def test_ours_a_strangers_and_a_real_one(machine):
    machine(10, "Microsoft X-Box 360 pad", place="neurotouch/pad0")
    machine(3, "Steam's", place="")
    machine(2, "Real pad\x1b[31m", place="usb-0000:00:14.0-1/input0", virtual=False)
    pads = machine.find()
    assert [pad.node.rsplit("/", 1)[1] for pad in pads] == ["event2", "event3", "event10"]
    assert [(pad.virtual, pad.ours) for pad in pads] == [
        (False, False),
        (True, False),
        (True, True),
    ]
    assert pads[0].name == "Real pad[31m"  # no control sequence reaches the terminal
    assert pads[2].usb_id == "045e:028e"
    assert pads[2].ids == (3, 0x045E, 0x028E, 0x0110)
    assert all(pad.readable for pad in pads)


def test_keyboards_mice_and_odd_boxes_are_none(machine):
    machine(
        0, "keyboard", keys="402000000 3803078f800d001 feffffdfffefffff fffffffffffffffe", axes="0"
    )
    machine(1, "mouse", keys="1f0000 0 0 0 0", axes="0")
    machine(2, "a box with a joystick button", axes="0")
    assert machine.find() == ()


def test_one_that_goes_while_we_look(machine, tmp_path):
    machine(1, "going")
    machine(2, "staying")
    (tmp_path / "sys/devices/virtual/input/input1/name").unlink()
    assert [pad.name for pad in machine.find()] == ["staying"]
