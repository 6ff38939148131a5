"""Keys held together, read from nodes as the kernel makes them: a folder of pipes stands in."""

import array
import fcntl
import os
import struct
import termios
from pathlib import Path
from random import Random

import pytest
from evdev import ecodes

from neurotouch_hid.device.inputs.hotkeys import (
    CHORDS,
    ChordReader,
    explain_keyboards,
    find_keyboards,
)
from tests.waiting import wait_until

EVENT = struct.Struct("@llHHi")
LIMIT_S = 60.0
KEYS = ("KEY_ESC", "KEY_ENTER", "KEY_SPACE", "KEY_A", "KEY_BACKSPACE")


class Machine:
    """``/dev/input`` and ``/sys/class/input`` of a machine with some nodes."""

    def __init__(self, folder: Path) -> None:
        self.nodes, self.system = folder / "dev", folder / "sys"
        self.nodes.mkdir()
        self.system.mkdir()

    def plug(self, number: int, name="Keyboard", phys="usb-1/input0", keys=KEYS) -> "VirtualDevice":
        device = self.system / f"event{number}" / "device"
        (device / "capabilities").mkdir(parents=True)
        bits = sum(1 << ecodes.ecodes[key] for key in keys)
        words = [f"{bits >> shift & (1 << 64) - 1:x}" for shift in range(704, -1, -64)]
        (device / "capabilities" / "key").write_text(" ".join(words) + "\n")
        (device / "name").write_text(name + "\n")
        (device / "phys").write_text(phys + "\n")
        os.mkfifo(self.nodes / f"event{number}")
        return VirtualDevice(self.nodes / f"event{number}")

    def keyboards(self):
        return find_keyboards(self.nodes, self.system)


class VirtualDevice:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.descriptor = os.open(path, os.O_RDWR | os.O_NONBLOCK)

    def send(self, kind: int, code: int, value: int) -> None:
        os.write(self.descriptor, EVENT.pack(0, 0, kind, code, value))

    def press(self, *keys: str, value: int = 1) -> None:
        for key in keys:
            self.send(ecodes.EV_KEY, ecodes.ecodes[key], value)
        self.send(ecodes.EV_SYN, ecodes.SYN_REPORT, 0)

    def count_unread(self) -> int:
        """Bytes that nobody has read yet."""
        answer = array.array("i", [0])
        fcntl.ioctl(self.descriptor, termios.FIONREAD, answer)
        return answer[0]

    def release(self, *keys: str) -> None:
        self.press(*keys, value=0)


@pytest.fixture
def machine(tmp_path) -> Machine:
    return Machine(tmp_path)


@pytest.fixture
def heard(machine):
    """A keyboard, and what is heard on it."""
    node = machine.plug(3)
    heard: list[str] = []
    reader = ChordReader(heard.append, nodes=machine.nodes, system=machine.system)
    yield node, heard
    reader.close()
    reader.close()
    os.close(node.descriptor)


@pytest.mark.parametrize("chord", list(CHORDS))
def test_chord_is_told_once_whatever_else_is_down(heard, chord):
    node, told = heard
    node.press("KEY_A")
    node.press(*CHORDS[chord])
    node.press(*CHORDS[chord], value=2)  # the kernel's repetition
    node.release(*CHORDS[chord])
    node.press(*CHORDS[chord])
    wait_until(lambda: len(told) >= 2)
    assert told == [chord, chord]


def test_keys_one_after_the_other_are_no_chord(heard):
    node, told = heard
    for key in CHORDS["panic"]:
        node.press(key)
        node.release(key)
    node.press("KEY_ESC", "KEY_BACKSPACE")
    node.release("KEY_ESC")
    node.press("KEY_ENTER")
    node.press("KEY_SPACE", "KEY_ESC")  # now a chord, and a sign that all before was read
    wait_until(lambda: told)
    assert told[0] == "panic"
    assert set(told) == {"panic", "pause"}


def test_what_was_down_before_events_were_lost_counts_no_more(heard):
    node, told = heard
    node.press("KEY_BACKSPACE", "KEY_ESC")
    node.send(ecodes.EV_SYN, ecodes.SYN_DROPPED, 0)
    node.press("KEY_ENTER")
    node.press("KEY_BACKSPACE", "KEY_ESC", "KEY_SPACE")
    wait_until(lambda: len(told) == 2)
    assert told == ["panic", "pause"]


def test_torn_and_foreign_bytes_do_no_harm(heard):
    node, told = heard
    os.write(node.descriptor, Random(1).randbytes(EVENT.size * 3 + 7))
    wait_until(lambda: not node.count_unread())
    node.press(*CHORDS["panic"])
    wait_until(lambda: told)


def test_chord_over_two_keyboards_one_plugged_in_later(machine):
    first, told = machine.plug(0), []
    reader = ChordReader(told.append, nodes=machine.nodes, system=machine.system)
    try:
        second = machine.plug(11, name="Switch box", keys=("KEY_ENTER",))
        wait_until(lambda: "Switch box" in reader.describe())
        first.press("KEY_BACKSPACE", "KEY_ESC")
        second.press("KEY_ENTER")
        wait_until(lambda: told == ["panic"])
        os.close(first.descriptor)  # unplugged: nothing is down on it any more
        (machine.nodes / "event0").unlink()
        second.press("KEY_ENTER")
    finally:
        reader.close()
    assert told == ["panic"]


def test_other_chords_can_be_chosen(machine):
    node, told = machine.plug(0), []
    chords = {"panic": ("KEY_SPACE",)}
    reader = ChordReader(told.append, chords, nodes=machine.nodes, system=machine.system)
    try:
        node.press("KEY_SPACE")
        wait_until(lambda: told == ["panic"])
    finally:
        reader.close()


def test_own_keyboard_pads_and_buttons_of_the_case_are_never_read(machine):
    machine.plug(0, name="NeuroTouch Keyboard", phys="neurotouch/keyboard0")
    machine.plug(1, name="Power Button", keys=("KEY_POWER",))
    machine.plug(2, name="Pad", keys=("BTN_SOUTH",))
    assert machine.keyboards() == []
    sentence, fix = explain_keyboards(machine.keyboards())
    assert "no keyboard" in sentence
    assert fix is None


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_unreadable_keyboard_is_told_with_the_rule(machine):
    machine.plug(0).path.chmod(0)
    _check_unreadable(machine.keyboards())


def test_explanation_of_an_unreadable_keyboard_has_the_rule(machine):
    machine.plug(0)
    (found,) = machine.keyboards()
    assert found.readable
    assert "chords work on Keyboard" in explain_keyboards([found])[0]
    _check_unreadable([type(found)(found.node, found.name, readable=False)])


def _check_unreadable(keyboards) -> None:
    sentence, fix = explain_keyboards(keyboards)
    assert "may not read" in sentence
    assert "event0 (Keyboard)" in sentence
    assert 'ENV{ID_INPUT_KEYBOARD}=="1", TAG+="uaccess"' in fix
    assert "see what is typed" in fix


def test_name_of_a_keyboard_is_no_danger(machine):
    machine.plug(0)
    (machine.system / "event0/device/name").write_bytes(b"\x1b[2JKey\xffboard\n")
    (found,) = machine.keyboards()
    assert found.name == "[2JKey\ufffdboard"


def test_machine_without_input_is_no_error(tmp_path):
    assert find_keyboards(tmp_path / "dev", tmp_path / "sys") == []
