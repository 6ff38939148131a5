"""From a simulated sensor of 1280x720, without frames, to the pad; it is unplugged, or silent."""

import threading
import time

import pytest

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline, warm_up
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.events.source import EventCameraSource
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence
from neurotouch_hid.source.strobe.config import StrobeConfig
from tests.soak.plugs import TimedDevice
from tests.source.events.fake_library import Camera, Device, Library, magnify

PATIENCE_S = 120.0
MOST_S = 0.1  # from the pulled cable, or the last data, to a neutral pad
HURRY_US = 600_000_000  # old slices are as good as new ones: the packets come all at once


@pytest.fixture(scope="module")
def strobed():
    """A push of 7 mm before a camera whose LED ring goes off 20 times a second."""
    stroke = Stroke(GestureKind.PUSH, (Finger((2.0, 3.0), (7.0, 0.0)),), hold_us=300_000)
    script = sequence("push", stroke, rest_us=250_000, gap_us=100_000)
    return list(Simulator(script, nuisances={"strobe": 1.5}, seed=1))


def film(title, packets):
    """A camera that shows packets of 346x260 in its own pixels."""
    camera = Camera(title)
    for packet in packets:
        camera.show(packet.t_end_us, magnify(packet.events, camera.view))
    return camera


class PacedDevice(Device):
    """A device that gives each packet when it is due."""

    def __init__(self, *parts):
        super().__init__(*parts)
        self.began_s = time.monotonic()

    def __next__(self):
        if self.camera.script:
            due_s = self.began_s + 1e-6 * self.camera.script[0][0]
            self.camera.unplugged.wait(max(0.0, due_s - time.monotonic()))
        return super().__next__()


class Bench:
    """A pipeline that plays a camera; ``done`` says after each step whether to stop."""

    def __init__(self, camera):
        self.library, self.pad = Library(camera), TimedDevice()
        self.steps, self.stop, self.done = [], threading.Event(), lambda _: False
        self.end_s = time.monotonic() + PATIENCE_S

    def look(self, step):
        self.steps.append(step)

    def turned(self):
        if self.done(self.steps) or time.monotonic() > self.end_s:
            self.stop.set()

    def play(self, **options):
        pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
        warm_up(Pipeline.build(load_profile("spacecraft"), GestureConfig()))
        config = EventsConfig(strobe=StrobeConfig())
        with EventCameraSource("", config, library=self.library, **options) as source:
            run_pipeline(
                source, pipeline, self.pad, [self.look], stop=self.stop, on_round=self.turned
            )


def test_a_push_before_a_finer_sensor_without_frames_moves_the_stick(strobed):
    bench = Bench(film("Prophesee EVK4", strobed))
    last_us = strobed[-1].t_end_us - 10_000
    bench.done = lambda steps: steps and steps[-1].packet.t_end_us >= last_us
    bench.play(max_delay_us=HURRY_US)
    kinds = [step.gesture.kind for step in bench.steps]
    found = next(k for k, step in enumerate(bench.steps) if step.gel.is_found)
    assert bench.steps[found].packet.t_end_us <= 250_000
    assert kinds.count(GestureKind.PUSH) > 30
    assert set(kinds) == {GestureKind.NONE, GestureKind.PUSH}
    pushed = [state for state in bench.pad.states if not state.is_neutral]
    assert max(max(state.axes.values(), default=0.0) for state in pushed) > 0.3
    assert bench.steps[-1].pad.is_neutral


@pytest.fixture(scope="module")
def filmed(strobed):
    """The packets of that push as a sensor of 1280x720 sends them."""
    return film("Prophesee EVK4", strobed).script


def unplug(bench):
    (camera,) = bench.library.cameras
    bench.library.unplug(camera)


def fall_silent(bench):
    bench.library.cameras[0].script.clear()


def end_while_pushing(script, end, monkeypatch):
    """Returns how long the pad stayed pushed after the data had ended, s."""
    monkeypatch.setattr("tests.source.events.fake_library.Device", PacedDevice)
    bench, ended_s = Bench(Camera("Prophesee EVK4", script=script)), []

    def look(steps):
        pushed = [step.gesture.kind is GestureKind.PUSH for step in steps[-20:]]
        if not ended_s and len(pushed) == 20 and all(pushed):
            ended_s.append(time.monotonic())
            end(bench)
        return ended_s and not bench.pad.is_pushed.is_set()

    bench.done = look
    bench.play(plugged=bench.library.list_plugged, slice_us=4_000)
    return bench.pad.released_s - ended_s[0]


@pytest.mark.parametrize("end", [unplug, fall_silent])
def test_the_pad_is_neutral_soon_after_a_camera_of_1280x720_ends(filmed, end, monkeypatch):
    taken_s = [end_while_pushing(filmed, end, monkeypatch) for _ in range(3)]
    assert all(s > 0.0 for s in taken_s)
    assert sorted(taken_s)[1] <= MOST_S, taken_s
