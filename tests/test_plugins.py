"""Methods and sources of other packages: the two examples, and packages that are wrong."""

import json
import math
import os
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from neurotouch_hid import Driver, DriverOptions, open_gel
from neurotouch_hid.errors import PluginError
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.gesture.method import make_method
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
)
from neurotouch_hid.source import open_source
from tests.processes import LIMIT_S, run_command, start_neurotouch

EXAMPLES = Path(__file__).parents[1] / "examples"
WRONG = """
from dataclasses import replace
import numpy as np
from neurotouch_hid.messages import EventPacket, no_gesture

class NoReset:
    def __init__(self, config): ...
    def update(self, *_): ...

class NoGesture(NoReset):
    def reset(self): ...

class Raises(NoReset):
    def reset(self): ...
    def update(self, *_): return 1 / 0

class Panics(NoReset):
    class Panic(BaseException): ...
    def reset(self): ...
    def update(self, *_): raise self.Panic("index out of bounds")

class Asserts(NoReset):
    def reset(self): ...
    def update(self, *_): assert False

class RaisesAtReset(NoReset):
    @property
    def reset(self): raise ValueError("no state")

class Loops(NoReset):
    def reset(self): ...
    left = 50
    def update(self, t_us, *_):
        self.left -= 1
        if self.left < 0:
            print("loops", flush=True)
            while True: ...
        return no_gesture(t_us)

class Leaves(NoReset):
    def reset(self): ...
    def update(self, *_): raise SystemExit(3)

class OneArgument(NoReset):
    def reset(self): ...
    def update(self, markers): ...

class FlatContacts(NoReset):
    def reset(self): ...
    def update(self, t_us, *_):
        return replace(no_gesture(t_us), contacts_mm=np.zeros(2))

class Told(NoReset):
    change = {}
    def reset(self): ...
    def update(self, t_us, *_):
        return replace(no_gesture(t_us), **self.change)

class Unready:
    name, rig, is_live, is_simulated = "unready", None, False, True
    def __init__(self, rest, **_): self.rest = rest
    def __enter__(self): return self
    def __exit__(self, *_): ...
    def close(self): ...
    def __iter__(self):
        if self.rest == "raises":
            raise KeyError("no frame")
        yield EventPacket(0, 10_000, np.zeros(3))

class Given(Unready):
    packets = ()
    def __iter__(self): return iter(self.packets)

class NoRig(Unready):
    rig = "paper"

class RaisesAtName(Unready):
    @property
    def name(self): raise ValueError("no serial")

class Polled(Unready):
    def poll(self):
        yield None
        raise ConnectionError("cable gone")

class ResetFails(NoReset):
    def reset(self): raise LookupError("no state")

def no_model(config):
    raise ValueError("no model")

def no_file(rest, *, slice_us, seed):
    open("/no/gel.dat")

def takes_nothing(): ...

def no_source(rest, *, slice_us, seed):
    return object()
"""


@pytest.fixture
def installed(tmp_path):
    """Makes packages look installed, as pip does: the code, and a .dist-info folder beside it."""

    def install(name, code, entry_points):
        (tmp_path / f"{name}.py").write_text(code)
        info = tmp_path / f"{name}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        lines = [
            line
            for group, points in entry_points.items()
            for line in (f"[{group}]", *(f"{key} = {value}" for key, value in points.items()))
        ]
        (info / "entry_points.txt").write_text("\n".join(lines))
        return tmp_path

    def install_example(folder):
        project = tomllib.loads((EXAMPLES / folder / "pyproject.toml").read_text())["project"]
        (module,) = (EXAMPLES / folder).glob("*.py")
        return install(module.stem, module.read_text(), project["entry-points"])

    install.example = install_example
    return install


def run(folder, *arguments, environment=None):
    program = f"import sys; sys.path.append({str(folder)!r}); " + (
        "from neurotouch_hid.__main__ import main; main()"
    )
    return run_command(
        sys.executable,
        "-c",
        program,
        *arguments,
        code=None,
        env={**os.environ, **(environment or {})},
    )


def play(folder, tmp_path, *arguments):
    trace = tmp_path / "trace.jsonl"
    fast = ("--speed", "max", "--device", "memory", "--show", "nothing", "--trace", trace)
    done = run(folder, "run", *arguments, *fast)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in trace.read_text().splitlines()]


def test_the_example_of_a_method_recognises_pushes(installed, tmp_path):
    folder = installed.example("own_method")
    steps = play(folder, tmp_path, "--source", "sim:push", "--method", "mean_push")
    assert {step["gesture"] for step in steps} == {"none", "push"}
    assert max(step["intensity_mm"] for step in steps) > 2.0


def test_the_example_of_a_source_mirrors_the_push(installed, tmp_path):
    folder = installed.example("own_source")
    strongest = max(
        play(folder, tmp_path, "--source", "mirrored:sim:push"), key=lambda s: s["intensity_mm"]
    )
    assert strongest["gesture"] == "push"
    assert abs(abs(strongest["direction_deg"]) - 180) < 15  # to the left: the push goes right


def test_names_are_offered_where_one_is_wrong(installed):
    folder = installed.example("own_method")
    done = run(folder, "run", "--method", "mean_pusch", "--source", "sim:push")
    assert done.returncode == 2
    assert "There is no method 'mean_pusch'.\nFix: Did you mean mean_push?" in done.stderr
    installed.example("own_source")
    done = run(folder, "run", "--source", "mirored:sim:push", "--device", "memory")
    assert done.returncode == 3
    assert "mirrored:" in done.stderr


@pytest.mark.parametrize(
    ("points", "arguments", "sentence"),
    [
        (
            {"neurotouch.methods": {"bad": "wrong:Missing"}},
            ("--method", "bad", "--source", "sim:push"),
            "'bad' of the package wrong cannot be loaded: AttributeError",
        ),
        (
            {"neurotouch.methods": {"bad": "wrong:NoReset"}},
            ("--method", "bad", "--source", "sim:push"),
            "The method 'bad' has no function 'reset'.",
        ),
        (
            {"neurotouch.methods": {"bad": "wrong:NoGesture"}},
            ("--method", "bad", "--source", "sim:push"),
            "The method 'bad' returned NoneType, not a Gesture.",
        ),
        (
            {"neurotouch.sources": {"bad": "wrong:no_source"}},
            ("--source", "bad:x"),
            "The source 'bad:' has no name, rig, is_live",
        ),
        (
            {"neurotouch.methods": {"bad": "wrong:OneArgument"}},
            ("--method", "bad", "--source", "sim:push"),
            "The function 'update' of the method 'bad' cannot be called: too many",
        ),
        (
            {"neurotouch.methods": {"bad": "wrong:takes_nothing"}},
            ("--method", "bad", "--source", "sim:push"),
            "'wrong:takes_nothing' of the package wrong cannot be called: too many",
        ),
        (
            {"neurotouch.methods": {"bad": "wrong:FlatContacts"}},
            ("--method", "bad", "--source", "sim:push"),
            "The method 'bad' returned contacts of the shapes (2,) (mm) and (0, 2) (px).",
        ),
        (
            {"neurotouch.sources": {"bad": "wrong:Unready"}},
            ("--source", "bad:numbers"),
            "The source 'bad:' gave events of the dtype float64.",
        ),
        (
            {"neurotouch.sources": {"bad": "wrong:NoRig"}},
            ("--source", "bad:x"),
            "The source 'bad:' has 'paper' as rig.",
        ),
        (
            {"neurotouch.sources": {"bad": "wrong:Unready"}},
            ("--source", "bad:folder/play.aedat4"),
            "The source 'bad:' gave events of the dtype float64.",
        ),
    ],
)
def test_what_is_wrong_in_a_package_is_said_in_one_sentence(installed, points, arguments, sentence):
    folder = installed("wrong", WRONG, points)
    done = run(folder, "run", *arguments, "--device", "memory", "--speed", "max")
    assert done.returncode == 1
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"kind": "push"}, "returned the kind 'push'"),
        ({"t_us": 0}, "returned the time 0"),
        ({"contacts_mm": [(0.0, 0.0)]}, "contacts of the types list and float64"),
        ({"contacts_mm": np.zeros((1, 2))}, "contacts of the shapes (1, 2) (mm) and (0, 2) (px)"),
        ({"contacts_mm": np.full((0, 2), 0)}, "contacts of the types int64 and float64"),
        ({"intensity_mm": "7 mm"}, "returned '7 mm' as intensity_mm"),
        ({"intensity_mm": -1.0}, "returned -1.0 as intensity_mm"),
        ({"intensity_mm": math.nan}, "returned nan as intensity_mm"),
        ({"confidence": 1.5}, "returned 1.5 as confidence"),
        ({"scale": None}, "returned None as scale"),
        ({"scale": np.float32(1.0)}, f"returned {np.float32(1.0)!r} as scale"),
        ({"rotation_rad": 1e300}, "returned 1e+300 as rotation_rad"),
        ({"translation_mm": (np.float32(1.0), 0.0)}, "as translation_mm"),
        (
            {"contacts_mm": np.full((1, 2), math.nan), "contacts_px": np.zeros((1, 2))},
            "returned a contact that is nowhere",
        ),
        ({"translation_mm": None}, "returned None as translation_mm"),
        ({"translation_mm": (0.0, 0.0, 0.0)}, "as translation_mm"),
        ({"translation_mm": (0.0, math.nan)}, "as translation_mm"),
    ],
)
def test_a_wrong_value_in_a_gesture_is_named(installed, monkeypatch, change, sentence):
    folder = installed("wrong", WRONG, {"neurotouch.methods": {"bad": "wrong:Told"}})
    monkeypatch.syspath_prepend(folder)
    sys.modules.pop("wrong", None)
    method = make_method(GestureConfig(method="bad"))
    sys.modules["wrong"].Told.change = change
    with pytest.raises(PluginError) as caught:
        method.update(4_000, 4_000, None, None, None, None)
    assert caught.value.message.startswith("The method 'bad' returned ")
    assert sentence in caught.value.message
    assert "must be" in caught.value.hint


EVENT = np.zeros(1, EVENT_DTYPE)
SLICE = EventPacket(0, 10_000, EVENT)
PIXELS = np.zeros((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)


def place(**values):
    """One event with these values."""
    event = EVENT.copy()
    for name, value in values.items():
        event[name] = value
    return event


@pytest.fixture
def given(installed, monkeypatch):
    """A source of another package that gives these packets."""
    folder = installed("wrong", WRONG, {"neurotouch.sources": {"bad": "wrong:Given"}})
    monkeypatch.syspath_prepend(folder)
    sys.modules.pop("wrong", None)  # another test's

    def give(*packets):
        source = open_source("bad:", speed="max")
        sys.modules["wrong"].Given.packets = packets
        return source

    return give


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"t_begin_us": np.int64(0)}, f"gave {np.int64(0)!r} as t_begin_us"),
        ({"t_end_us": math.nan}, "gave nan as t_end_us"),
        ({"gap": None}, "gave None as gap"),
        ({"t_end_us": 0}, "a slice from 0 to 0 us"),
        ({"t_end_us": 10**12}, "a slice from 0 to 1000000000000 us"),
        ({"t_begin_us": -1, "t_end_us": 1}, "a slice from -1 us on after one that ended at 0 us"),
        ({"events": None}, "events of the dtype None"),
        ({"events": np.zeros((1, 1), EVENT_DTYPE)}, "events of the shape (1, 1)"),
        ({"events": place(x=SENSOR_WIDTH_PX)}, "an event at x = 346"),
        ({"events": place(y=-1)}, "an event at y = -1"),
        ({"events": place(t=10_000)}, "an event at 10000 us in a slice from 0 to 10000 us"),
        (
            {"events": np.append(place(t=1), EVENT)},
            "events that are not in the order of their time",
        ),
        ({"frames": None}, "frames of the type NoneType"),
        ({"frames": (PIXELS,)}, "ndarray as a frame"),
        ({"frames": (Frame(PIXELS[:10], 0, 1),)}, "a frame of uint8, (10, 346)"),
        ({"frames": (Frame(PIXELS * 1.0, 0, 1),)}, "a frame of float64, (260, 346)"),
        ({"frames": (Frame(PIXELS, 0, np.int64(1)),)}, "as exposure_end_us"),
    ],
)
def test_a_wrong_packet_is_named_before_it_is_used(given, change, sentence):
    before = replace(SLICE, t_begin_us=-10_000, t_end_us=0, events=EVENT[:0])
    with pytest.raises(PluginError) as caught:
        list(given(before, replace(SLICE, **change)))
    assert caught.value.message.startswith("The source 'bad:' gave ")
    assert sentence in caught.value.message
    assert caught.value.hint


def test_a_slice_may_come_in_part_before_it_comes_whole(given):
    part = replace(SLICE, t_end_us=9_000, is_partial=True)
    later = replace(SLICE, t_begin_us=50_000, t_end_us=60_000, events=EVENT[:0])
    packets = (part, replace(SLICE, frames=(Frame(PIXELS, 0, 1),)), later)
    assert tuple(given(*packets)) == packets


FAILING = [
    ("method", "no_model", "ValueError: no model"),
    ("method", "Raises", "ZeroDivisionError: division by zero"),
    ("method", "Panics", "Panic: index out of bounds"),
    ("method", "Asserts", "AssertionError"),
    ("method", "RaisesAtReset", "ValueError: no state"),
    ("source", "RaisesAtName", "ValueError: no serial"),
    ("method", "Leaves", "SystemExit: 3"),
    ("source", "no_file", "FileNotFoundError: [Errno 2] No such file or directory: '/no/gel.dat'"),
    ("source", "Unready", "KeyError: 'no frame'"),
    ("source", "Polled", "ConnectionError: cable gone"),
]
"""What raises in ``WRONG``, and what it says."""


@pytest.fixture
def offered(installed):
    """Installs ``WRONG`` with one entry point, and returns what an error says around its own."""

    def offer(kind, name, error):
        folder = installed("wrong", WRONG, {f"neurotouch.{kind}s": {"bad": f"wrong:{name}"}})
        place = f"{folder / 'wrong.py'}, line "
        return folder, f"The {kind} 'bad' of the package wrong failed: {error} ({place}"

    return offer


@pytest.fixture
def imported(offered, monkeypatch):
    """The same for this process."""

    def offer(kind, name, error):
        folder, said = offered(kind, name, error)
        monkeypatch.syspath_prepend(folder)
        sys.modules.pop("wrong", None)  # another test's
        return said

    return offer


@pytest.mark.parametrize(("kind", "name", "error"), FAILING)
def test_what_a_package_raises_is_its_error_on_the_command_line(offered, kind, name, error):
    folder, said = offered(kind, name, error)
    source = "bad:raises" if kind == "source" else "sim:push"
    method = "bad" if kind == "method" else "neurotouch"
    words = ("--source", source, "--method", method, "--device", "memory", "--speed", "max")
    done = run(folder, "run", *words)
    assert done.returncode == 1
    assert f"Error: {said}" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(("kind", "name", "error"), FAILING)
def test_what_a_package_raises_is_its_error_in_a_program(imported, kind, name, error):
    said = imported(kind, name, error)
    chosen = {"source": "bad:raises"} if kind == "source" else {"method": "bad"}
    options = DriverOptions(**{"source": "sim:push", **chosen}, device="memory", speed="max")
    with pytest.raises(PluginError) as caught:
        play_in_program(name, options)
    assert caught.value.message.startswith(said)
    assert caught.value.__cause__ is not None


def play_in_program(name, options):
    if name == "Polled":  # only a driver that runs polls
        with Driver(options) as driver:
            driver.run()
    with open_gel(options.source, method=options.method, speed="max") as gel:
        list(gel)


def test_a_method_that_fails_to_reset_is_named(imported):
    said = imported("method", "ResetFails", "LookupError: no state")
    method = make_method(GestureConfig(method="bad"))
    with pytest.raises(PluginError) as caught:
        method.reset()
    assert caught.value.message.startswith(said)


def test_a_second_signal_ends_a_method_that_does_not_return(installed, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    folder = installed("wrong", WRONG, {"neurotouch.methods": {"bad": "wrong:Loops"}})
    words = ("run", "--method", "bad", "--source", "sim:push", "--device", "memory")
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    with start_neurotouch(*words, "--show", "nothing", env=environment) as playing:
        try:
            assert playing.stdout.readline() == "loops\n"
            playing.terminate()
            with pytest.raises(subprocess.TimeoutExpired):
                playing.wait(1.5)
            playing.terminate()
            _, said = playing.communicate(timeout=LIMIT_S)
        finally:
            playing.kill()
    assert playing.returncode == 1
    assert "The method 'bad' of the package wrong failed: NotReturned: it does not return" in said


def test_the_whole_traceback_can_be_had(installed):
    folder = installed("wrong", WRONG, {"neurotouch.methods": {"bad": "wrong:Raises"}})
    arguments = ("run", "--method", "bad", "--source", "sim:push", "--device", "memory")
    told = run(folder, *arguments)
    assert f"({folder / 'wrong.py'}, line " in told.stderr
    assert "PYTHONDEVMODE=1" in told.stderr
    shown = run(folder, *arguments, environment={"PYTHONDEVMODE": "1"})
    assert "return 1 / 0" in shown.stderr


def test_the_ten_lines_print_gestures():
    program = EXAMPLES / "ten_lines" / "read_gel.py"
    done = run_command(sys.executable, program, "sim:push")
    assert "push" in done.stdout
