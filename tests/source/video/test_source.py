"""Pictures become frames of equal slices, each in the slice in which its exposure ends."""

import numpy as np

from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.source.video.source import SEARCH_US, PictureSlicer

RANDOM = np.random.default_rng(0)


class Finder:
    """Finds no gel, and counts how often it is asked."""

    gel = PAPER_GEL

    def __init__(self):
        self.n_asked = 0

    def find(self, pixels, *, is_still=False):
        self.n_asked += 1
        assert pixels.shape == (260, 346)


def draw():
    """A noisy picture; no two are the same."""
    return RANDOM.integers(80, 100, (480, 640)).astype(np.uint8)


def play(slicer, ends_us):
    return [packet for end_us in ends_us for packet in slicer.push(draw(), end_us, end_us)]


def test_each_picture_is_in_the_slice_of_its_end_and_comes_at_once():
    slicer = PictureSlicer(None, 4_000)
    ends_us = [1_000, 9_300, 9_900, 41_000]
    last_us = None
    for end_us in ends_us:
        packets = list(slicer.push(draw(), end_us - 500, end_us))
        if packets:
            newest = packets[-1]
            assert newest.t_begin_us <= end_us < newest.t_end_us
            assert newest.frames[-1].exposure_end_us == end_us
            assert newest.frames[-1].exposure_begin_us == end_us - 500
        for packet in packets:
            assert len(packet.events) == 0
            assert packet.t_end_us - packet.t_begin_us == 4_000
            assert last_us in (None, packet.t_begin_us)
            last_us = packet.t_end_us


def test_a_second_picture_of_a_slice_goes_into_the_next():
    slicer = PictureSlicer(None, 10_000)
    packets = play(slicer, [0, 3_000, 12_000])
    assert [[f.exposure_end_us for f in p.frames] for p in packets] == [[0], [3_000, 12_000]]


def test_slices_without_a_picture_come_as_time_goes_on():
    slicer = PictureSlicer(None, 10_000)
    packets = play(slicer, [0]) + list(slicer.reach(45_000))
    assert [(p.t_begin_us, len(p.frames)) for p in packets] == [
        (0, 1),
        (10_000, 0),
        (20_000, 0),
        (30_000, 0),
    ]


def test_without_a_gel_some_pictures_of_a_second_are_searched_and_shown():
    finder = Finder()
    slicer = PictureSlicer(finder, 10_000)
    packets = play(slicer, range(0, 5_000_000, 8_000))
    shown = np.array([frame.exposure_end_us for packet in packets for frame in packet.frames])
    usual_us, eager_us = SEARCH_US
    assert (np.diff(shown[:11]) < eager_us + 8_000).all()
    assert (np.diff(shown) >= eager_us).all()
    assert (np.diff(shown[11:]) >= usual_us).all()
    assert len(shown) >= 18
    assert not slicer.is_found
    assert slicer.view.scale == min(346 / 640, 260 / 480)
    assert finder.n_asked <= 11 * 18 + 8 * 6


def test_a_new_size_of_pictures_is_a_new_view():
    slicer = PictureSlicer(None, 10_000)
    list(slicer.push(draw(), 0, 0))
    (packet,) = slicer.push(np.full((240, 320), 200, np.uint8), 10_000, 10_000)
    assert (packet.frames[0].pixels == 200).all()


def test_a_picture_that_came_twice_is_one_frame():
    slicer = PictureSlicer(None, 10_000)
    pictures = [draw() for _ in range(5)]
    packets = [
        packet for k in range(10) for packet in slicer.push(pictures[k // 2], k * 8_000, k * 8_000)
    ]
    shown = [frame.exposure_end_us for packet in packets for frame in packet.frames]
    assert shown == [0, 16_000, 32_000, 48_000, 64_000]
    assert slicer.n_doubled == 5


def test_a_still_picture_without_noise_goes_on():
    slicer, picture = PictureSlicer(None, 10_000), draw()
    packets = [p for k in range(9) for p in slicer.push(picture, k * 10_000, k * 10_000)]
    assert [len(packet.frames) for packet in packets] == [1, 0, 0, 0, 1, 0, 0, 0, 1]
