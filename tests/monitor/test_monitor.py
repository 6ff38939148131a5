"""What the taps print and write."""

import io
import json
import os
import re
from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    Axis,
    Button,
    EventPacket,
    GamepadState,
    GelProblem,
    GelState,
    Gesture,
    GestureKind,
    MarkerField,
    Step,
)
from neurotouch_hid.monitor import (
    LinesMonitor,
    PictureMonitor,
    TraceWriter,
    describe_gesture,
    describe_outputs,
)
from neurotouch_hid.monitor.terminal import draw_step
from neurotouch_hid.monitor.text_output import TextOutput
from neurotouch_hid.profile import MappingDecision

FOUND = GelState(is_found=True, was_found=True, problem=GelProblem.NONE)
RIG = Rig((173.0, 130.0), 2.5)
REST_PX = RIG.to_px(PAPER_GEL.points_mm).astype(np.float32)


def step(t_us, kind, intensity_mm=0.0, translation_mm=(0.0, 0.0), contacts_mm=(), pad=None):
    contacts = np.array(contacts_mm, float).reshape(-1, 2)
    gesture = Gesture(t_us, kind, contacts, RIG.to_px(contacts), intensity_mm, translation_mm)
    field = MarkerField(t_us, REST_PX, REST_PX + np.float32(0.1), np.ones(177, bool))
    packet = EventPacket(t_us - 10_000, t_us, np.zeros(0, EVENT_DTYPE))
    return Step(packet, None, field, gesture, pad or GamepadState(t_us), FOUND)


PUSH = step(
    1_000_000,
    GestureKind.PUSH,
    4.25,
    (-3.0, 0.1),
    [(4.0, 8.0)],
    GamepadState(1_000_000, frozenset({Button.A}), {Axis.LEFT_X: -0.5}),
)
REST = step(2_000_000, GestureKind.NONE)


@pytest.mark.parametrize(
    ("translation", "word"),
    [
        ((1, 0), "right"),
        ((0, 1), "down"),
        ((-1, 0), "left"),
        ((0, -1), "up"),
        ((1, -1), "up-right"),
    ],
)
def test_push_is_described_with_its_direction(translation, word):
    gesture = step(0, GestureKind.PUSH, 3.21, translation, [(0, 0), (1, 1)]).gesture
    assert describe_gesture(gesture) == f"push {word} 3.2 mm, 2 fingers"


def test_twist_is_described_in_whole_words():
    gesture = step(0, GestureKind.TWIST_CCW, 2.0, contacts_mm=[(0, 0)]).gesture
    assert describe_gesture(gesture) == "twist counter-clockwise 2.0 mm, 1 finger"


def test_pad_is_described_by_what_is_pressed():
    assert describe_outputs(PUSH.pad) == "left stick left 50 %, button A"
    assert not describe_outputs(REST.pad)


def test_trace_has_one_line_per_slice_with_every_control(tmp_path):
    path = tmp_path / "play.jsonl"
    trace = TraceWriter(path)
    trace(PUSH)
    trace(REST)
    assert not path.exists()  # not under its name before it is complete
    trace.close()
    first, second = map(json.loads, path.read_text().splitlines())
    assert first["t_us"] == 1_000_000
    assert first["gesture"] == "push"
    assert first["intensity_mm"] == 4.25
    assert first["contacts_px"] == [[183.0, 150.0]]
    assert first["direction_deg"] == pytest.approx(178.09, abs=0.01)
    assert first["markers_tracked"] == 177
    assert set(first["pad"]) == {*map(str, Axis), *map(str, Button)}
    assert first["pad"]["left_x"] == -0.5
    assert first["pad"]["a"] is True
    assert first["pad"]["b"] is False
    assert second["direction_deg"] is None
    assert not any(second["pad"].values())
    assert list(tmp_path.iterdir()) == [path]


def test_a_trace_that_finds_no_room_says_so_once_and_leaves_nothing(tmp_path):
    full, told = tmp_path / "full", []
    full.symlink_to("/dev/full")
    trace = TraceWriter(full, told.append)
    for _ in range(1000):
        trace(PUSH)
    trace.close()
    assert len(told) == 1
    assert "No space left on device" in told[0]
    assert full.is_symlink()


def test_a_link_in_the_way_of_a_trace_is_not_followed(tmp_path):
    victim, path = tmp_path / "victim", tmp_path / "play.jsonl"
    victim.write_text("precious")
    for name in (f"{path.name}.part", f".{path.name}.{os.getpid()}.partial"):
        (tmp_path / name).symlink_to(victim)
    trace = TraceWriter(path)
    trace(PUSH)
    trace.close()
    assert victim.read_text() == "precious"
    assert path.read_text().count("\n") == 1


def fill_disk():
    return os.fdopen(os.open("/dev/full", os.O_WRONLY), "w")


def lose_reader():
    """The end of a pipe whose reader has gone."""
    read, write = os.pipe()
    os.close(read)
    return os.fdopen(write, "w")


@pytest.mark.parametrize("lost", [fill_disk, lose_reader])
@pytest.mark.parametrize("make", [LinesMonitor, lambda out: PictureMonitor(out, "x")])
def test_an_output_that_fails_is_told_once_and_dropped(lost, make):
    told = []
    with lost() as stream:  # to close it, and write what is left, fails no more
        monitor = make(TextOutput(stream, "the output", told.append))
        for _ in range(3):
            monitor(PUSH)
            monitor(replace(REST, gesture=replace(REST.gesture, t_us=3_000_000)))
        monitor.close()
    assert len(told) == 1
    assert "The game goes on without it." in told[0]


def test_trace_into_a_missing_folder_is_one_sentence(tmp_path):
    with pytest.raises(NeuroTouchError, match=r"cannot be written: No such file"):
        TraceWriter(tmp_path / "missing" / "play.jsonl")


def test_what_is_no_file_is_not_replaced_by_one(tmp_path):
    """As root, ``--trace /dev/null`` would otherwise take the device from everybody."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    trace = TraceWriter(path)
    trace(step(10_000, GestureKind.NONE))
    trace.close()
    assert path.is_fifo()
    assert json.loads(os.read(reader, 100_000))["t_us"] == 10_000
    os.close(reader)


def test_lines_tell_only_changes():
    out = io.StringIO()
    monitor = LinesMonitor(out)
    for one in (PUSH, PUSH, REST, REST):
        monitor(one)
    assert out.getvalue().splitlines() == [  # counted from the first step, whatever the clock
        "    0.00 s  push left 4.2 mm, 1 finger; pad left stick left 50 %, button A",
        "    1.00 s  at rest (peak 4.2 mm); pad neutral",
    ]


def test_lines_tell_an_ignored_gesture_once_and_at_once():
    ignored = MappingDecision(
        REST.gesture.t_us, "ignored", "pinch -> button a", "lasted 940 ms < 2000 ms"
    )
    pressed = MappingDecision(REST.gesture.t_us, "pressed", "pinch -> button b")
    out = io.StringIO()
    monitor = LinesMonitor(out, lambda: [ignored, pressed])
    for _ in range(2):
        monitor(REST)
    said = [line for line in out.getvalue().splitlines() if "pinch" in line]
    assert said == ["    0.00 s  ignored: pinch -> button a, because lasted 940 ms < 2000 ms"]


def test_picture_shows_gel_gesture_and_pad():
    assert draw_step(PUSH, "sim:test")[0].endswith(" 1.00 s")
    assert draw_step(PUSH, "sim:test", begun_us=750_000)[0].endswith(" 0.25 s")
    lines = draw_step(PUSH, "sim:test")
    text = "\n".join(lines)
    assert "push left 4.2 mm, 1 finger" in text
    assert "177 of 177" in text
    gel = "\n".join(line[:29] for line in lines[2:17])
    assert gel.count("·") + gel.count("●") == 177
    assert lines[2 + 7 + 2][2 * (7 + 1)] == "●"  # the contact at (4, 8) mm: 1 right, 2 down
    assert "[A] b  x " in text


def test_picture_fits_eighty_columns_and_never_wraps(monkeypatch):
    assert max(map(len, draw_step(PUSH, "sim:test"))) <= 80
    monkeypatch.setenv("COLUMNS", "40")
    assert "\n".join(draw_step(PUSH, "sim:test", columns=40)).count("·") == 0
    out = io.StringIO()
    monitor = PictureMonitor(out, "sim:test")
    monitor(PUSH)
    monitor.close()
    rows = re.sub(r"\x1b\[[?\w]*", "", out.getvalue()).replace("\r", "").splitlines()
    assert max(map(len, rows)) == 40
    assert {"gesture    push left 4.2 mm, 1 finger", "markers    177 of 177 tracked"} <= set(rows)
    assert any(row.startswith("intensity   4.2 mm ") for row in rows)


def test_picture_is_never_higher_than_the_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("LINES", "10")
    out = io.StringIO()
    monitor = PictureMonitor(out, "sim:test")
    monitor(PUSH)
    monitor.close()
    assert out.getvalue().count("\n") % 9 == 0
    assert "\x1b[17A" not in out.getvalue()
    assert "push left" in out.getvalue()


def test_picture_gives_the_cursor_back():
    out = io.StringIO()
    monitor = PictureMonitor(out, "sim:test")
    monitor(PUSH)
    monitor.close()
    assert out.getvalue().endswith("\x1b[?25h")
    assert "push left" in out.getvalue()
