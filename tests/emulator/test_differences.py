"""Where drivers disagree about the same words, as the public facts have it: ours takes the best."""

import threading
import time

import numpy as np
import pytest
from neurotouch_devtools.emulator import CameraConfig

from tests.emulator.stage import finish, start

pytestmark = pytest.mark.filterwarnings("ignore:DynamicImporter:ImportWarning")  # gi's own

CLOSING = "7001 8001 1000 3000 7001 8001"  # drivers hand out a slice when a later one begins
START = "7001 0001"
FAR = (
    "83E8 100A 3014 2015 1159 3103 83EF 1000 2000 7001 1001 3001 8005 1002 2002 7003 "
    f"FFFF 1003 3003 {CLOSING}"
)
"""Events with a wrap word that counts three."""
MALFORMED = (
    "7001 83E8 1190 3005 83E9 100A 312C 3005 83EA 2007 7003 8005 1001 3001 0000 0020 5F00 "
    "6C00 CE20 1003 3003 CA38 1004 3004"
)
"""Row 400, column 300, words of no meaning, a time that goes back."""
ROW = (1000, 400, 5, 1)
COLUMN = (1001, 10, 300, 1)
GOOD = [(1001, 10, 5, 1), (1002, 10, 7, 0), (98309, 1, 1, 1), (118304, 3, 3, 1)]


def hear(plug, driver, text, n_events, out):
    """The events a driver makes of words, in µs since the first one, as it streams."""
    ready = threading.Event()

    def see_nothing():
        ready.set()  # looked at for the first time: the driver has started it and set its clock
        yield from ()

    config = CameraConfig(await_reset=driver != "neuromorphic")
    cable = plug(config, scene=see_nothing())
    process = start(
        cable, "-m", "tests.emulator.drivers", driver, str(out), str(n_events), "0", "100"
    )
    camera = cable.camera
    deadline = time.monotonic() + 120
    while not ready.wait(0.05) and time.monotonic() < deadline and process.poll() is None:
        pass
    while driver != "own" and not all(camera.registers[3, parameter] for parameter in (2, 3, 4)):
        assert time.monotonic() < deadline  # others then switch the motion sensor on
        time.sleep(0.05)
    time.sleep(1.0)
    for parameter in (2, 3, 4):
        camera.write((3, parameter), 0)  # no samples of the motion sensor in between
    camera.say(np.array([int(word, 16) for word in f"{START} {text}".split()], np.uint16))
    finish(process)
    events = np.load(out)["events"]
    return [tuple(event) for event in events.T.tolist()]


def since(events, first):
    """Events by the time of the first one, which is known."""
    return [(t - events[0][0] + first, x, y, p) for t, x, y, p in events]


def assert_far(events, last_us):
    assert since(events, 1000)[:7] == [
        (1000, 10, 20, 1),
        (1000, 10, 21, 0),
        (1000, 345, 259, 1),
        (1007, 0, 0, 0),
        (32768, 1, 1, 1),
        (32773, 2, 2, 0),
        (last_us, 3, 3, 1),
    ]


def test_neuromorphic_counts_a_wrap_once_and_holds_back_time(plug, tmp_path):
    events = hear(plug, "neuromorphic", f"{FAR} {MALFORMED}", 13, tmp_path / "seen.npz")
    assert_far(events, 98303)
    assert since(events[8:], 1001) == [
        *GOOD[:2],
        *((32773, 1, 1, 1), (52768, 3, 3, 1), (52768, 4, 4, 1)),
    ]


def test_dv_checks_no_address_and_ends_when_time_goes_back(plug, tmp_path):
    events = hear(plug, "dv", f"{FAR} {MALFORMED}", 1000, tmp_path / "seen.npz")
    assert_far(events, 163839)
    assert since(events[8:], 1000)[:4] == [ROW, COLUMN, *GOOD[:2]]
    assert (4, 4) not in [event[1:3] for event in events]


def test_ours_takes_the_best_of_each(plug, tmp_path):
    text = f"{FAR} {MALFORMED} {CLOSING}"
    events = hear(plug, "own", text, 14, tmp_path / "seen.npz")
    assert_far(events, 163839)
    assert since(events[8:], 1001)[:5] == [*GOOD, (118304, 4, 4, 1)]
