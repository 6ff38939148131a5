"""Other cameras of the family, emulated: colour, other sensors, newer firmware."""

import threading

import numpy as np
import pytest
from neurotouch_devtools.emulator import Identity
from neurotouch_devtools.emulator.sight import FILTERS, see

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.errors import CameraError
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline
from neurotouch_hid.source.davis import DavisSource
from neurotouch_hid.source.davis.camera import CameraVersions
from neurotouch_hid.source.davis.mosaic import Mosaic
from tests.emulator.host import make_scene
from tests.source.davis.cable import Cable, Clock, emulate

DIM = {"R": 0.5, "G": 1.0, "B": 0.35, "W": 1.0}
LEAD_US = 100_000
SMALL = (240, 180)
LEFT, TOP = (SENSOR_WIDTH_PX - SMALL[0]) // 2, (SENSOR_HEIGHT_PX - SMALL[1]) // 2


def plug(packets, **options):
    clock = Clock()
    return Cable(emulate(packets, clock_ns=clock, await_reset=True, **options), clock.step)


def find_end_us(packets):
    """When the scene is over, in the time of the driver."""
    return packets[-1].t_end_us + LEAD_US


def collect(cable, packets):
    """Everything the driver makes of a scene: events and frames."""
    seen = []
    with DavisSource(cameras=cable, max_delay_us=600_000_000) as source:
        for packet in source.poll():
            seen += [] if packet is None else [packet]
            if seen and seen[-1].t_end_us >= find_end_us(packets) + 30_000:
                break
    events = np.concatenate([packet.events for packet in seen])
    return events, [frame for packet in seen for frame in packet.frames]


def play(cable, packets):
    """The kinds of gesture that a pipeline finds in a scene."""
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    kinds, stop = [], threading.Event()

    def look(step):
        kinds.append(step.gesture.kind)
        if step.packet.t_end_us >= find_end_us(packets):
            stop.set()

    with DavisSource(cameras=cable, max_delay_us=600_000_000) as source:
        run_pipeline(source, pipeline, MemoryDevice(), [look], stop=stop)
    return kinds


@pytest.mark.parametrize("colour", range(1, 9))
def test_the_mosaic_of_every_filter_is_taken_out_of_the_frames(colour, push):
    scene = push.packets
    shown = [frame.pixels for packet in scene for frame in packet.frames]
    dim = [frame.pixels for p in see(scene, (346, 260), colour, DIM) for frame in p.frames]
    mosaic = Mosaic()
    for pixels in dim:
        mosaic.level(pixels)
    off = np.abs(np.array(dim, float) - np.array(shown, float))
    expected = 1.0 / np.array([DIM[FILTERS[colour][k]] for k in (0, 1, 3, 2)])
    assert mosaic.gains == pytest.approx(expected, rel=0.02)
    assert off.mean() < 0.6
    assert np.percentile(off, 99.9) < 5.0  # one DN of a blue pixel is three


def test_a_black_or_a_white_picture_teaches_no_gains():
    mosaic = Mosaic()
    for level in (0, 255):
        mosaic.level(np.full((260, 346), level, np.uint8))
    assert mosaic.gains.tolist() == [1.0] * 4


def test_a_filter_that_passes_almost_nothing_is_not_learnt():
    mosaic = Mosaic()
    pixels = np.full((260, 346), 100, np.uint8)
    pixels[::2, ::2] = 10
    mosaic.level(pixels)
    assert mosaic.gains.tolist() == [1.0] * 4


def test_a_colour_camera_plays_as_a_monochrome_one(push):
    kinds = play(plug(push.packets, colour=1, shares=DIM), push.packets)
    assert kinds.count(GestureKind.PUSH) > 50


@pytest.mark.parametrize("chip", [0, 1, 2])
def test_a_smaller_sensor_shows_the_middle_of_the_picture(chip):
    scene = make_scene(n_events=5000)
    events, frames = collect(plug(scene, chip=chip), scene)
    shown = np.concatenate([packet.events for packet in scene])
    x, y = shown["x"], shown["y"]
    inside = (x >= LEFT) & (x < LEFT + SMALL[0]) & (y >= TOP) & (y < TOP + SMALL[1])
    for name in ("x", "y", "p"):
        assert np.array_equal(events[name], shown[inside][name])
    assert len(frames) >= 2
    wholes = [frame.pixels for packet in scene for frame in packet.frames]
    middle = np.s_[TOP : TOP + SMALL[1], LEFT : LEFT + SMALL[0]]
    for frame, whole in zip(frames, wholes, strict=False):
        assert frame.pixels.shape == (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        assert np.array_equal(frame.pixels[middle], whole[middle])


def test_a_small_sensor_is_configured_as_its_maker_does(caplog):
    cable = plug(make_scene(), chip=2)
    with DavisSource(cameras=cable):
        registers = cable.camera.registers
        assert [registers[5, k] for k in (0, 1, 2, 3, 4, 8, 10, 19, 20)] == [
            *(0x427F, 0x5FFF, 0x401F, 0x5B9B, 0x573B, 0x23AD, 0x419D, 0x5FEF, 0x8410)
        ]
        assert [registers[1, k] for k in (41, 42, 43, 44)] == [0, 0, 239, 179]
        assert [registers[2, k] for k in (8, 9, 10, 11)] == [0, 0, 239, 179]
        assert [registers[1, k] for k in (11, 12)] == [180, 240]
        assert [registers[5, k] for k in (36, 143)] == [0, 0]  # of the DAVIS346
    assert "DAVIS240C, which this driver has only played in a simulation" in caplog.text
    assert "libcaer and dv-processing play it, too" in caplog.text


def test_a_gel_is_played_on_a_small_sensor(push):
    assert play(plug(push.packets, chip=2), push.packets).count(GestureKind.PUSH) > 50


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"chip": 4}, "the sensor DAVIS346A"),
        ({"chip": 9}, "libcaer plays it, too; dv-processing refuses it"),
        ({"firmware": 7}, "firmware version 7; this driver was made for version 6"),
        ({"firmware": 16}, "as libcaer does; dv-processing refuses it"),
    ],
)
def test_a_variant_that_should_work_is_played_with_a_warning(options, words, caplog):
    firmware = options.pop("firmware", 6)
    scene = make_scene()
    camera = plug(scene, identity=Identity(firmware=firmware), **options)
    events, frames = collect(camera, scene)
    assert len(events) == 2000
    assert frames
    assert words in caplog.text


def test_the_usual_camera_is_played_without_a_warning(caplog):
    scene = make_scene()
    collect(plug(scene), scene)
    assert not caplog.text


@pytest.mark.parametrize(
    ("options", "words", "others"),
    [
        ({"logic": (17, 1)}, "logic version 17", "libcaer and dv-processing refuse it, too."),
        ({"logic": (18, 0)}, "logic patch 0", "libcaer and dv-processing refuse it, too."),
        ({"chip": 6}, "DAVIS640", "libcaer and dv-processing play this sensor."),
        ({"chip": 8}, "DAVIS208", "libcaer plays this sensor."),
        ({"chip": 77}, "number 77", "Neither libcaer nor dv-processing plays this sensor."),
    ],
)
def test_a_refusal_says_what_others_do_and_names_the_makers_page(options, words, others):
    with pytest.raises(CameraError, match=words) as caught:
        DavisSource(cameras=plug(make_scene(), **options))
    assert others in caught.value.hint
    assert "https://inivation.gitlab.io/dv/dv-docs/docs/update-firmware/" in caught.value.hint
    assert "does not flash cameras" in caught.value.hint


def test_a_camera_says_which_variant_it_is():
    assert str(CameraVersions(6, 18, 1, 5, "DAVIS346B", 0)) == (
        "DAVIS346B, 346×260 pixels, monochrome, firmware 6, logic 18 patch 1"
    )
    assert str(CameraVersions(7, 18, 1, 2, "DAVIS240C", 5)) == (
        "DAVIS240C, 240×180 pixels, colour, filter RGBW, firmware 7, logic 18 patch 1"
    )
    assert "an unknown filter, number 9" in str(CameraVersions(6, 18, 1, 5, "DAVIS346B", 9))
