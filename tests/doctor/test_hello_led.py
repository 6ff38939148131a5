"""Latency by an LED before the lens: the light is simulated, and the LED is a file."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.hello import command
from neurotouch_hid.doctor.hello.answers import Word, answer_all
from neurotouch_hid.doctor.hello.led import N_FLASHES, LedMeter
from neurotouch_hid.doctor.hello.session import LED, Session
from neurotouch_hid.driver.gel_file import load_gel_file
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.gel_making.plan import make_plan
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import sequence
from neurotouch_hid.vocabulary import SourceKind

SLICE_US = 4_000


class Light:
    """An LED, its file, and a camera that sees it some slices later.

    Args:
        folder: for the file.
        late: slices from the moment it is switched to the slice that shows it.
        frames: the camera sends frames, and no events.
        seen: False: it is too far away.
    """

    def __init__(self, folder, *, late=3, frames=False, seen=True):
        self.path = folder / "brightness"
        self.path.write_text("1\n")
        self.late, self.frames, self.seen = late, frames, seen
        self.n = 0
        self.history = []
        self.written = []

    def now_s(self):
        return 1e-6 * SLICE_US * self.n

    def slices(self):
        while True:
            self.written.append(self.path.read_text().strip())
            self.history.append(self.written[-1] != "0")
            self.n += 1
            yield self.show(self.n)

    def show(self, n):
        then, before = (
            self.seen and n > each and self.history[n - 1 - each]
            for each in (self.late, self.late + 1)
        )
        t_us = SLICE_US * n
        events = np.zeros(5_000 if then != before and not self.frames else 40, EVENT_DTYPE)
        events["t"], events["p"] = t_us, then or len(events) == 40
        pixels = np.full((260, 346), 90 if then else 30, np.uint8)
        frames = (Frame(pixels, t_us, t_us + 1),) if self.frames else ()
        return EventPacket(t_us, t_us + SLICE_US, events, frames)


class SlowLight(Light):
    """Pixels that follow the logarithm of the light as a first-order low pass, with noise.

    Args:
        folder: for the file.
        bandwidth_hz: their corner.
        most_per_us: as many events can be sent.
    """

    def __init__(self, folder, bandwidth_hz, most_per_us=np.inf):
        super().__init__(folder, late=0)
        self.constant_us = 1e6 / (2.0 * np.pi * bandwidth_hz)
        self.most_per_us = most_per_us
        self.rng = np.random.default_rng(3)
        self.flash_us = np.zeros(0)

    def show(self, n):
        """Nothing is left of a flash when the next one comes."""
        end_us = SLICE_US * n
        if self.history[-1] and not any(self.history[-2:-1]):
            began_us = end_us - SLICE_US + self.rng.uniform(0.0, 0.8 * SLICE_US)
            step = self.rng.uniform(0.5, 2.5, 4_000)  # logarithm of how much brighter it is
            threshold = self.rng.normal(0.2, 0.03, step.shape)
            shares = np.concatenate([k * threshold / step for k in range(1, 40)])
            own = began_us - self.constant_us * np.log(1.0 - shares[(shares > 0) & (shares < 1)])
            sent = began_us + np.arange(len(own)) / self.most_per_us
            self.flash_us = np.maximum(np.sort(own), sent)
        inside = (self.flash_us >= end_us - SLICE_US) & (self.flash_us < end_us)
        noise = self.rng.uniform(end_us - SLICE_US, end_us, 300)
        times_us = np.sort(np.concatenate([self.flash_us[inside], noise]))
        events = np.zeros(len(times_us), EVENT_DTYPE)
        events["t"], events["p"] = times_us, True
        return EventPacket(end_us - SLICE_US, end_us, events, ())


def flash(meter, light, most_s=60.0):
    """Shows slices until enough flashes were seen; returns what the person hears."""
    told = []
    for packet in light.slices():
        told += [meter.take(packet)]
        if meter.is_done or light.now_s() > most_s:
            return [each for each in told if each]
    raise AssertionError


@pytest.mark.parametrize("frames", [False, True])
@pytest.mark.parametrize("late", [0, 3, 25])
def test_the_time_from_switching_it_on_is_measured(tmp_path, frames, late):
    light = Light(tmp_path, late=late, frames=frames)
    with LedMeter(light.path, light.now_s) as meter:
        assert flash(meter, light) == ["That is enough. Go on when you like."]
        figures = meter.list_figures()
    assert figures["led_flashes"] == N_FLASHES
    expected_ms = 1e-3 * SLICE_US * (late + 1)
    assert figures["led_latency_ms"] == pytest.approx(expected_ms)
    assert figures["led_latency_most_ms"] == pytest.approx(expected_ms)


def test_it_is_as_it_was_in_the_end(tmp_path):
    (tmp_path / "max_brightness").write_text("255\n")
    light = Light(tmp_path)
    with LedMeter(light.path, light.now_s) as meter:
        flash(meter, light)
    assert set(light.written) == {"0", "255"}
    assert light.path.read_text() == "1\n"


def test_flashes_come_at_all_moments_of_a_frame(tmp_path):
    light = Light(tmp_path)
    with LedMeter(light.path, light.now_s) as meter:
        flash(meter, light)
    begun = [k for k in range(1, len(light.written)) if light.written[k - 1 : k + 1] == ["0", "1"]]
    assert len({k % 10 for k in begun}) > 5  # a camera with 25 frames/s


def test_a_light_that_is_too_far_away_is_told(tmp_path):
    light = Light(tmp_path, seen=False)
    with LedMeter(light.path, light.now_s) as meter:
        told = flash(meter, light, 10.0)
        assert meter.list_figures()["led_latency_ms"] is None
    assert set(told) == {"The LED is not seen. Hold it nearer to the lens."}


@pytest.mark.parametrize("bandwidth_hz", [20.0, 100.0, 300.0, 1_000.0])
def test_bandwidth_is_at_least_what_is_told(tmp_path, bandwidth_hz):
    light = SlowLight(tmp_path, bandwidth_hz)
    with LedMeter(light.path, light.now_s) as meter:
        flash(meter, light)
        figures = meter.list_figures()
    assert figures["bandwidth_hz"] == pytest.approx(bandwidth_hz, rel=0.2)
    assert figures["bandwidth_hz"] < 1.05 * bandwidth_hz


def test_a_flood_makes_it_less_and_never_more(tmp_path):
    light = SlowLight(tmp_path, 300.0, most_per_us=1.0)
    with LedMeter(light.path, light.now_s) as meter:
        flash(meter, light)
        assert 1.0 < meter.list_figures()["bandwidth_hz"] < 300.0


def test_frames_tell_no_bandwidth(tmp_path):
    light = Light(tmp_path, frames=True)
    with LedMeter(light.path, light.now_s) as meter:
        flash(meter, light)
        assert meter.list_figures()["bandwidth_hz"] is None


@pytest.mark.parametrize("content", [b"", b"my text", None])
def test_a_file_that_is_no_led_stays_as_it_is(tmp_path, content):
    path = tmp_path / "brightness"
    if content is not None:
        path.write_bytes(content)
    words = [str(tmp_path / "a"), "--source", "sim:rest", "--led", str(path)]
    result = CliRunner().invoke(command, words)
    assert isinstance(result.exception, NeuroTouchError)
    assert "switches no LED" in result.exception.message
    assert not path.exists() if content is None else path.read_bytes() == content


def test_a_recording_shows_no_led(tmp_path):
    words = [str(tmp_path / "a"), "--source", "file:a.aedat4", "--led", str(tmp_path / "b")]
    (tmp_path / "a.aedat4").touch()
    result = CliRunner().invoke(command, words)
    assert isinstance(result.exception, NeuroTouchError)


def test_the_person_is_asked_last_and_hears_the_figure(tmp_path, play_one):
    light = Light(tmp_path)
    with LedMeter(light.path, light.now_s) as meter:
        plan = make_plan(load_gel_file(None).settings)
        session = Session(plan, "davis", led=meter)
        n_prompts = session.n_prompts
        while session.prompt.key != LED:
            session.next(is_skipped=True)
        assert len(session.spans) == n_prompts - 1
        assert session.missing == f"0 of {N_FLASHES} flashes were seen."
        for packet in light.slices():
            session.take(replace(play_one, packet=packet))
            if not session.missing:
                break
        session.next()
        assert session.prompt is None
        answers = answer_all(session, SourceKind.CAMERA, {}, is_simulated=False)
    timing = next(each for each in answers if each.point == "timing")
    assert timing.word is Word.YES
    assert "16.0 ms in the median of 20 flashes, 16.0 ms at most" in timing.sentence


@pytest.fixture
def play_one():
    """A step of a gel at rest."""
    pipeline = Pipeline.build(load_profile("default"), GestureConfig())
    with Simulator(sequence("rest", rest_us=100_000)) as source:
        return pipeline.advance(next(iter(source)))
