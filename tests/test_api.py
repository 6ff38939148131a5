"""The API: ten lines read a gel, wherever it is."""

import json
import re
import subprocess
import sys
import threading
from dataclasses import fields
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

import neurotouch_hid
from neurotouch_hid import (
    Driver,
    DriverOptions,
    Gel,
    NeuroTouchError,
    Touch,
    load_profile,
    open_gel,
)
from neurotouch_hid.errors import NotRunningError, RecordingError, SourceError
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.vocabulary import Axis
from tests.processes import run_command

READ = """
import json, sys
from neurotouch_hid import open_gel

with open_gel("driver:") as gel:
    for touch in gel:
        if touch.kind == "push" and touch.intensity_mm > 5:
            break
heavy = [name for name in ("numba", "cv2", "pydantic", "scipy") if name in sys.modules]
pushed = touch.markers_mm[touch.measured]
print(json.dumps([heavy, touch.intensity_mm, len(touch.contacts_mm), float(abs(pushed).max()),
                  max(touch.pad.axes.values(), key=abs, default=0.0), touch.events is None]))
"""


def test_ten_lines_read_a_simulated_gel():
    with open_gel("sim:push", profile="spacecraft", speed="max") as gel:
        touches = list(gel)
    pushes = [touch for touch in touches if touch.kind == "push"]
    strongest = max(pushes, key=lambda touch: touch.intensity_mm)
    assert {touch.kind for touch in touches} == {"none", "push"}
    assert strongest.intensity_mm == pytest.approx(7.0, abs=0.7)
    assert strongest.contacts_mm.shape == (1, 2)
    assert strongest.translation_mm[0] > 5 * abs(strongest.translation_mm[1])
    assert np.hypot(*strongest.markers_mm[strongest.measured].T).max() > 5
    assert strongest.pad.axes[Axis.LEFT_X] > 0.5
    assert sum(len(touch.events) for touch in touches) > 100_000
    assert any(touch.frames for touch in touches)


def test_a_recording_is_read_the_same_way(push, tmp_path):
    path = tmp_path / "push.aedat4"
    with RecordingWriter(path) as writer:
        for packet in push.packets:
            writer.write(packet)
    with open_gel(str(path), speed="max") as gel:
        assert "push" in {touch.kind for touch in gel}


def test_a_running_driver_is_read_without_loading_what_compiles():
    options = DriverOptions(source="sim:tour", device="memory", profile="spacecraft")
    ended = threading.Event()

    def end(_step):
        if reader.poll() is not None:
            ended.set()

    with Driver(options) as driver:
        reader = subprocess.Popen([sys.executable, "-c", READ], stdout=subprocess.PIPE, text=True)
        driver.run([end], seconds=60, stop=ended)
        out, _ = reader.communicate(timeout=60)
    heavy, intensity_mm, n_contacts, moved_mm, stick, no_events = json.loads(out)
    assert heavy == []
    assert intensity_mm > 5
    assert n_contacts == 1
    assert moved_mm > 2
    assert abs(stick) > 0.3
    assert no_events


def test_who_reads_on_goes_on_where_it_stopped():
    with open_gel("sim:push", speed="max") as gel:
        first = [touch.t_us for touch in islice(gel, 3)]
        second = [touch.t_us for touch in islice(gel, 3)]
    assert second[0] > first[-1]


def test_a_closed_gel_says_so():
    gel = open_gel("sim:push", speed="max")
    gel.close()
    gel.close()
    with pytest.raises(NeuroTouchError, match="The gel is closed"):
        next(iter(gel))


MISUSE = [
    ({"source": 5}, TypeError, "source must be a text such as 'sim:tour', not int: 5"),
    ({"profile": None}, TypeError, "profile must be a name or path such as 'spacecraft', not None"),
    ({"profile": 3}, TypeError, "profile must be a name or path such as 'spacecraft', not int: 3"),
    ({"method": 1}, TypeError, "method must be a text such as 'neurotouch', not int: 1"),
    ({"gel": 5}, TypeError, "gel must be a name or path such as 'own.gel.yaml', not int: 5"),
    ({"speed": "fast"}, ValueError, "speed must be 'recorded' or 'max', not 'fast'"),
    ({"player": 9}, ValueError, "player must be 1, 2, 3 or 4, not 9"),
    ({"player": 1.0}, TypeError, "player must be a whole number from 1 to 4, not float: 1.0"),
    ({"player": True}, TypeError, "player must be a whole number from 1 to 4, not bool: True"),
    ({"rate_hz": "250"}, TypeError, "rate_hz must be a number such as 250, not str: '250'"),
    ({"rate_hz": -5}, ValueError, "rate_hz must be from 25 to 1000, not -5"),
    ({"rate_hz": float("nan")}, ValueError, "rate_hz must be from 25 to 1000, not nan"),
    ({"seed": "a"}, TypeError, "seed must be a whole number such as 0, not str: 'a'"),
    ({"seed": 1.5}, TypeError, "seed must be a whole number such as 0, not float: 1.5"),
    ({"seed": -1}, ValueError, "seed must be 0 or more, not -1"),
    ({"personal": "yes"}, TypeError, "personal must be True or False, not str: 'yes'"),
]


@pytest.mark.parametrize(("arguments", "error", "sentence"), MISUSE)
def test_a_wrong_argument_is_one_sentence(arguments, error, sentence):
    for source in ("sim:push", "driver:"):
        with pytest.raises(error, match=f"^{re.escape(sentence)}"):
            open_gel(**{"source": source, **arguments})
    if arguments != {"profile": None}:  # the first of the person's favourites
        with pytest.raises(error, match=f"^{re.escape(sentence)}"):
            DriverOptions(**arguments)


def test_no_option_of_a_driver_is_without_a_check():
    for option in fields(DriverOptions):
        with pytest.raises((TypeError, ValueError), match=f"^{option.name} must be "):
            DriverOptions(**{option.name: b"?"})
    DriverOptions(seed=np.int64(3), rate_hz=np.float32(250), profile=None, listens=None)


@pytest.mark.parametrize(
    ("source", "error", "sentence", "hint"),
    [
        ("sim:pusch", SourceError, "no simulated scene called 'pusch'", "Did you mean sim:push?"),
        ("driver:", NotRunningError, "No driver is running", "neurotouch run"),
        ("driver:2", SourceError, "'driver:2' is not a source", "Write driver: alone"),
        ("", SourceError, "The source is empty", "Give one of davis:"),
        (Path("no.aedat4"), RecordingError, "There is no file 'no.aedat4'", "Check the name"),
        ("davis:", SourceError, "No DAVIS camera is plugged in", "the source sim:tour"),
    ],
)
def test_a_source_that_cannot_be_opened_is_one_sentence(source, error, sentence, hint):
    with pytest.raises(error, match=sentence) as caught:
        open_gel(source)
    assert hint in caught.value.hint
    assert "--" not in caught.value.hint  # an option of the command line


@pytest.mark.parametrize("name", [3, None])
def test_a_profile_has_a_name_or_a_path(name):
    with pytest.raises(TypeError, match="must be a name or path such as 'spacecraft', not"):
        load_profile(name)


def test_a_recording_and_a_profile_may_be_paths(push, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    recording, profile = Path("push.aedat4"), Path("mine")
    with RecordingWriter(recording) as writer:
        for packet in push.packets:
            writer.write(packet)
    profile.write_bytes((find_shipped_folder() / "spacecraft.yaml").read_bytes())
    with open_gel(recording, profile=profile, speed="max") as gel:
        assert max(touch.pad.axes.get(Axis.LEFT_X, 0.0) for touch in gel) > 0.5
    assert load_profile(profile).name == load_profile("spacecraft").name


def test_a_driver_takes_options_only():
    with pytest.raises(
        TypeError, match=re.escape("options must be DriverOptions(source=...), not")
    ):
        Driver("sim:tour")


def test_a_driver_is_used_once_and_inside_its_block():
    driver = Driver(DriverOptions(source="sim:push", device="memory", speed="max", personal=False))
    for use in (driver.steps, driver.run):
        with pytest.raises(NeuroTouchError, match="The driver is not open") as caught:
            use()
        assert "with Driver(options) as driver" in caught.value.hint
    with driver:
        steps = driver.steps()
        next(steps)
        with pytest.raises(NeuroTouchError, match="opened only once"):
            driver.__enter__()
        next(steps)  # and is none the worse
    for use in (driver.steps, driver.run, lambda: next(steps)):
        with pytest.raises(NeuroTouchError, match="The driver is not open"):
            use()
    with pytest.raises(NeuroTouchError, match="opened only once"):
        driver.__enter__()


def test_a_gel_that_another_thread_closes_says_so():
    gel = open_gel("sim:push", speed="max")

    def close_meanwhile():
        gel.close()
        raise NeuroTouchError("The driver is not open.")
        yield

    gel._touches = close_meanwhile()
    with pytest.raises(NeuroTouchError, match="The gel is closed"):
        list(gel)


def test_a_closed_gel_is_not_opened_again():
    gel = open_gel("sim:push", speed="max")
    gel.close()
    with pytest.raises(NeuroTouchError, match="The gel is closed"), gel:
        pass


LIGHT = {
    "client",
    "closing",
    "driver",
    "driver.options",
    "errors",
    "gel",
    "geometry",
    "ipc",
    "messages",
    "players",
    "lazy",
    "printable",
    "driver_state",
    "status",
    "subscriber",
    "vocabulary",
}
"""The modules that a reader of a running driver may load; ``make bench`` says what it costs."""


def test_a_reader_of_a_driver_loads_light_modules_only():
    program = """
import sys
from neurotouch_hid import open_gel
from neurotouch_hid.errors import NotRunningError

try:
    open_gel("driver:")
except NotRunningError:
    print(*(name for name in sys.modules if name.partition(".")[0] == "neurotouch_hid"))
    print(*{"numba", "cv2", "pydantic", "scipy", "importlib.metadata"} & set(sys.modules))
"""
    done = run_command(sys.executable, "-c", program)
    ours, heavy = done.stdout.splitlines()
    loaded = {name.removeprefix("neurotouch_hid.") for name in ours.split()} - {"neurotouch_hid"}
    assert loaded <= LIGHT
    assert heavy == ""


def test_what_is_public_stays():
    rule = (
        "What a program may rely on has changed. The deprecation rule (docs/api.md): a name that "
        "will go warns for at least one minor version before. Add names freely, and list them here."
    )
    assert sorted(neurotouch_hid.__all__) == [
        "Driver",
        "DriverOptions",
        "Gel",
        "NeuroTouchError",
        "Touch",
        "__version__",
        "load_profile",
        "open_gel",
    ], rule
    assert [each.name for each in fields(Touch)] == [
        "t_us",
        "kind",
        "intensity_mm",
        "contacts_mm",
        "translation_mm",
        "rotation_rad",
        "scale",
        "confidence",
        "pad",
        "markers_mm",
        "measured",
        "events",
        "frames",
    ], rule
    public = {name for name in [*dir(Gel), *Gel.__annotations__] if not name.startswith("_")}
    assert public == {"close", "name"}, rule
