"""Event cameras of other makers, played by made-up packets behind the library's interface."""

import logging
import time

import numpy as np
import pytest

from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.source.camera_errors import CameraAbsentError
from neurotouch_hid.source.camera_source import RETRY_S
from neurotouch_hid.source.events import library as library_module
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.events.models import MODELS, find_model
from neurotouch_hid.source.events.source import EventCameraSource
from neurotouch_hid.source.kernels.view import interpolate, map_events
from tests.source.events.fake_library import (
    Camera,
    Library,
    list_places,
    magnify,
    make_events,
)
from tests.source.taking import take, take_until
from tests.waiting import wait_until

PATIENCE_S = 60.0


def open_source(*cameras, name="", config=None, **options):
    return EventCameraSource(name, config, library=Library(*cameras), **options)


def test_events_come_in_slices_from_the_first_time_of_the_camera():
    camera = Camera("iniVation DAVIS 346")
    camera.show(5_000_300, make_events([5_000_000, 5_000_100], x=[3, 7], y=[4, 8], on=[1, 0]))
    camera.show(5_021_000, make_events([5_012_000], x=345, y=259))
    with open_source(camera) as source:
        assert source.name == "events:00ca0123"
        packets = take(source, 2)
    assert [(p.t_begin_us, p.t_end_us, p.gap) for p in packets] == [
        (0, 10_000, 0),
        (10_000, 20_000, 0),
    ]
    assert packets[0].events.tolist() == [(0, 3, 4, True), (100, 7, 8, False)]
    assert packets[1].events.tolist() == [(12_000, 345, 259, True)]
    assert camera.device is None


@pytest.mark.parametrize("title", ["Prophesee EVK4", "iniVation DAVIS 346"])
def test_the_first_packet_waits_for_no_kernel(title, monkeypatch):
    """A camera of 1280x720 sends 20,000 events in each ms that a kernel is compiled."""
    needed = [map_events] if title == "Prophesee EVK4" else [map_events, interpolate]
    for kernel in needed:
        monkeypatch.setattr(kernel, "_found", {})
    with open_source(Camera(title)):
        assert [kernel.n_variants for kernel in needed] == [1] * len(needed)


def test_slices_come_in_parts_while_the_gel_moves():
    camera = Camera("iniVation DAVIS 346")
    shown = ((k, 100 if k < 50 else 400) for k in range(1_000))  # noise, then motion

    def show_more():
        k, n = next(shown)
        stamps_us = 4_000 * k + np.arange(n) * 10
        camera.show(4_000 * k + 4_000, make_events(stamps_us, x=np.arange(n) % 346))

    with open_source(camera, slice_us=4_000, part_us=1_000) as source:
        source.set_activity(is_idle=True)
        packets = []
        for packet in source.poll():  # data that comes late would come in whole slices
            show_more()
            packets += [] if packet is None else [packet]
            if packets and packets[-1].t_end_us - packets[-1].t_begin_us == 1_000:
                break
    assert packets[-1].t_begin_us > 200_000
    assert 4_000 in {packet.t_end_us - packet.t_begin_us for packet in packets}


def test_a_canonical_pixel_fires_once_for_all_the_pixels_that_it_stands_for():
    camera = Camera()
    places = list_places(camera.view)
    ys, xs = np.nonzero(places == (100 | 120 << 16))
    n = len(xs)
    assert n > 8
    times = np.arange(n)
    camera.show(100, make_events(times, xs, ys))
    camera.show(20_000, make_events(times + 200, xs, ys, on=False))
    with open_source(camera) as source:
        (packet,) = take(source, 1)
        assert (source.stats().n_events, source.stats().n_shown) == (2 * n, 2)
    middle = (n + 1) // 2 - 1
    assert packet.events.tolist() == [(middle, 100, 120, True), (200 + middle, 100, 120, False)]


@pytest.mark.parametrize("title", [model.title for model in MODELS])
def test_every_model_of_the_library_is_opened_with_its_own_configuration(title):
    camera = Camera(title, script=[])
    config = EventsConfig(px_per_mm=4.0, centre_px=(camera.model.width_px / 2, 150.0))
    with open_source(camera, config=config):
        configuration = camera.device.configuration
        assert configuration.type() == camera.model.key
        limiter = getattr(configuration, "rate_limiter", None)
        assert (limiter is not None) == camera.model.has_limit
        if limiter is not None:
            assert (limiter.reference_period_us, limiter.maximum_events_per_period) == (200, 4_000)
        if camera.model.has_mask:
            assert any(configuration.x_mask)
            assert any(configuration.y_mask)


def test_the_library_draws_the_region_that_was_asked_for():
    """Its own picture of a mask counts the rows as events do."""
    import neuromorphic_drivers

    from neurotouch_hid.source.events.models import Region, make_configuration

    module = neuromorphic_drivers.prophesee_evk4
    region = Region(100, 20, 300, 120)
    made = make_configuration(
        neuromorphic_drivers, find_model("Prophesee EVK4"), EventsConfig(), region
    )
    mask = module.RowColumnMask(set=False)
    for words, out in ((made.x_mask, mask.x_unpacked), (made.y_mask, mask.y_unpacked)):
        bits = np.unpackbits(np.array(words, "<u8").view(np.uint8), bitorder="little")
        out[:] = bits[: len(out)]
    rows, columns = np.nonzero(mask.pixels())
    limits = (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
    assert limits == tuple(region)


def test_a_bias_of_the_settings_reaches_the_camera():
    camera = Camera()
    config = EventsConfig(biases={"prophesee_evk4": {"diff_on": 20}, "lucid_triton": {"hpf": 1}})
    with open_source(camera, config=config):
        assert camera.device.configuration.biases.diff_on == 20
        assert camera.device.configuration.biases.diff_off == 0


@pytest.mark.parametrize(
    ("biases", "words"),
    [
        ({"OnBn": 3}, "The Prophesee EVK4 has no bias 'OnBn'"),
        ({"diff_on": 70_000}, "The bias diff_on of the Prophesee EVK4 cannot be 70000"),
    ],
)
def test_a_bias_that_cannot_be_is_refused(biases, words):
    with pytest.raises(CameraError, match=words) as caught:
        open_source(Camera(), config=EventsConfig(biases={"prophesee_evk4": biases}))
    assert caught.value.hint


def test_a_camera_is_chosen_by_number_or_by_a_part_of_its_name():
    one, two = Camera(serial="a"), Camera("iniVation DVXplorer", serial="b")
    for name, camera in (("a", one), ("b", two), ("evk", one), ("dvx", two)):
        with open_source(one, two, name=name):
            assert camera.device is not None
    with pytest.raises(CameraError, match="Several event cameras fit") as caught:
        open_source(one, two)
    assert caught.value.hint == "Choose one, for example: --source events:a"
    with pytest.raises(CameraAbsentError, match="No event camera is called 'c'"):
        open_source(one, two, name="c")
    with pytest.raises(CameraAbsentError, match="No event camera is plugged in"):
        open_source()


def test_a_camera_in_use_is_refused():
    with pytest.raises(CameraBusyError, match="in use by another program"):
        open_source(Camera(error="Rusb(Busy)"))
    with pytest.raises(CameraError, match="no right to read and write it"):
        open_source(Camera(error="Access denied (insufficient permissions)"))


def test_without_the_extra_one_sentence_says_which_command_installs_it(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "neuromorphic_drivers", None)
    with pytest.raises(CameraError, match="which is missing") as caught:
        library_module.load_library()
    assert caught.value.hint == "Install it: pip install 'neurotouch-hid[events]'"


def test_what_is_lost_on_the_way_is_counted_and_said_in_the_next_slice():
    camera = Camera("iniVation DAVIS 346")
    camera.show(10_000, make_events([0]))
    camera.show(20_000, make_events([11_000]), overflows=np.array([0, 0]))
    camera.show(30_000, make_events([21_000]), dropped_packets=3)
    camera.show(40_000, make_events([31_000]), dropped_packets=3)
    with open_source(camera) as source:
        packets = take(source, 4)
        assert source.stats().n_lost == 5
    assert [packet.gap for packet in packets] == [0, 2, 3, 0]


def test_old_data_is_thrown_away_and_counted():
    camera = Camera("iniVation DAVIS 346")
    camera.show(10_000, make_events([0]), backlog=40, system_time=time.time() - 1.0)
    camera.show(20_000, make_events([11_000]))
    with open_source(camera) as source:
        device = camera.device
        packets = take(source, 2)
        assert source.stats().n_cleared == 1
    assert device.cleared == [1]
    assert packets[1].gap == 40


def test_a_little_backlog_is_kept():
    camera = Camera("iniVation DAVIS 346")
    camera.show(20_000, make_events([0]), backlog=3)
    with open_source(camera) as source:
        device = camera.device
        take(source, 1)
    assert device.cleared == []


def test_times_that_go_back_are_held_and_counted():
    camera = Camera("iniVation DAVIS 346")
    camera.show(20_000, make_events([500, 400, 600]))
    with open_source(camera) as source:
        (packet,) = take(source, 1)
        assert source.stats().n_lost == 1
    assert packet.events["t"].tolist() == [0, 0, 100]


def test_a_camera_at_its_limit_is_said_once(caplog):
    camera = Camera()
    config = EventsConfig(max_events_per_s=1_000_000)
    for k in range(3):
        camera.show(4_000 * (k + 1), make_events(np.arange(4_000) + 4_000 * k))
    with open_source(camera, config=config) as source:
        take(source, 1)
        assert source.stats().limited_us > 3_000
    assert caplog.text.count("has reached its limit of 1000000 events/s") == 1


def test_a_camera_whose_clock_jumps_is_started_again():
    camera = Camera("iniVation DAVIS 346")
    camera.show(20_000, make_events([0]))
    camera.show(90_000_000, make_events([89_000_000]))
    camera.show(20_000, make_events([0]))
    with open_source(camera) as source:
        packets = take_until(source, lambda got: len(got) >= 3 and got[-1].gap)
        assert source.stats().n_restarts == 1
    assert packets[-1].t_end_us < 60_000_000
    assert camera.n_opened == 2


def test_a_camera_that_is_unplugged_and_back_plays_on_with_a_gap(caplog, monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.events.source.SILENCE_S", PATIENCE_S)
    caplog.set_level(logging.WARNING)
    camera = Camera("iniVation DVXplorer")
    fake = Library(camera)
    camera.show(20_000, make_events([0]))
    with EventCameraSource(library=fake, plugged=fake.list_plugged) as source:
        before = take(source, 1)
        fake.unplug(camera)
        wait_until(lambda: source.trouble)
        n_listed = fake.n_listed
        time.sleep(3.0 * RETRY_S)
        assert fake.n_listed <= n_listed + 1  # it stops all threads, so it is not asked in vain
        camera.show(20_000, make_events([3]))
        fake.plug(camera)
        after = take_until(source, lambda got: len(got) >= 1 and got[-1].gap)
        assert source.trouble == ""
        assert source.stats().n_connects == 2
    assert after[-1].t_begin_us > before[-1].t_end_us
    assert caplog.text.count("has failed") == 1


def test_another_camera_does_not_take_its_place(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.events.source.SILENCE_S", PATIENCE_S)
    camera, other = Camera(serial="1"), Camera(serial="2")
    fake = Library(camera)
    camera.show(20_000, make_events([0]))
    with EventCameraSource(library=fake, plugged=fake.list_plugged) as source:
        take(source, 1)
        fake.unplug(camera)
        fake.plug(other)
        wait_until(lambda: "is not plugged in" in source.trouble, lambda: source.trouble)
    assert other.n_opened == 0


def test_silence_is_a_failure(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.events.source.SILENCE_S", 0.1)
    camera = Camera("iniVation DVXplorer")
    camera.show(20_000, make_events([0]))
    with open_source(camera) as source:
        deadline = time.monotonic() + PATIENCE_S
        polled = source.poll()
        while "sends nothing" not in source.trouble:
            next(polled)
            assert time.monotonic() < deadline


def test_a_camera_without_usb_is_waited_for():
    fake = Library()
    fake.refusal = "Other error"
    with pytest.raises(CameraAbsentError):
        EventCameraSource(library=fake)
    EventCameraSource(library=fake, wait=True).close()


@pytest.mark.parametrize("title", ["Prophesee EVK4", "iniVation DVXplorer"])
def test_a_finer_sensor_gives_the_pipeline_the_events_of_a_davis(title, push):
    """An edge that crosses all the pixels behind a canonical one makes one event of them."""
    camera = Camera(title)
    packets = push.packets[:30]
    n_sent = 0
    for packet in packets:
        events = magnify(packet.events, camera.view)
        n_sent += len(events)
        camera.show(packet.t_end_us, events)
    shown = np.concatenate([packet.events for packet in packets])
    shown = shown[shown["t"] < packets[-1].t_begin_us]
    inside = np.isin(shown["x"] | shown["y"].astype(np.int32) << 16, list_places(camera.view))
    shown = shown[inside]
    with open_source(camera, max_delay_us=60_000_000) as source:
        got = take_until(source, lambda got: len(got) == len(packets) - 1)
        assert source.stats().n_events == n_sent > 3 * len(shown)
    events = np.concatenate([packet.events for packet in got])
    order = ["t", "y", "x"]
    events, shown = np.sort(events, order=order), np.sort(shown, order=order)
    events["t"] += shown["t"][0] - events["t"][0]
    events = events[events["t"] < packets[-1].t_begin_us]
    for name in ("t", "x", "y", "p"):
        assert np.array_equal(events[name], shown[: len(events)][name]), name
    assert len(events) > 0.99 * len(shown)
