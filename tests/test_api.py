"""The API: ten lines read a gel, wherever it is."""

import json
import subprocess
import sys
import threading
from itertools import islice

import numpy as np
import pytest

from neurotouch_hid import Driver, DriverOptions, NeuroTouchError, open_gel
from neurotouch_hid.errors import NotRunningError, SourceError
from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.vocabulary import Axis

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


@pytest.mark.parametrize(
    ("arguments", "error", "sentence"),
    [
        ({"source": 5}, TypeError, "source must be a text such as 'sim:tour', not int: 5"),
        ({"source": "sim:push", "profile": None}, TypeError, "profile must be a text"),
        ({"source": "sim:push", "speed": "fast"}, ValueError, "must be 'recorded' or 'max'"),
        ({"source": "sim:push", "player": 5}, ValueError, "player must be 1, 2, 3 or 4, not 5"),
        ({"source": "sim:push", "rate_hz": 1}, ValueError, "must be between 25 and 1000"),
        ({"source": "sim:pusch"}, SourceError, "no simulated scene called 'pusch'"),
        ({"source": "driver:"}, NotRunningError, "No driver is running"),
    ],
)
def test_misuse_gives_one_sentence(arguments, error, sentence):
    with pytest.raises(error, match=sentence):
        open_gel(**arguments)
