"""What the doctor says of what the camera sees, on drawn gels."""

from contextlib import ExitStack
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from neurotouch_hid.doctor import gel as doctor_gel
from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.doctor.gel import GelView
from neurotouch_hid.geometry import NOMINAL_PX_PER_MM, PAPER_GEL, Rig
from neurotouch_hid.messages import EVENT_DTYPE, Frame
from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.source import open_source

CENTRE = (172.5, 129.5)


def draw(position_px, light=180.0):
    y, x = np.mgrid[:260, :346]
    picture = np.full(y.shape, 20.0)
    for cx, cy in position_px:
        near = np.s_[max(int(cy) - 4, 0) : int(cy) + 6, max(int(cx) - 4, 0) : int(cx) + 6]
        picture[near] += light * np.exp(-((x[near] - cx) ** 2 + (y[near] - cy) ** 2) / 2)
    return np.clip(picture, 0, 255).astype(np.uint8)


def gel(centre=CENTRE):
    return Rig(centre, NOMINAL_PX_PER_MM).to_px(PAPER_GEL.points_mm)


@pytest.fixture
def view(tmp_path):
    """A view of a gel that looks so and so in each tenth of five seconds."""

    def look(*pictures, frames_hz=25, events_hz=10_000):
        path = tmp_path / "a.aedat4"
        events = np.zeros(5 * events_hz + 1, EVENT_DTYPE)
        events["t"] = np.linspace(1_000, 5_011_000, len(events))
        with RecordingWriter(path) as writer:
            for k, part in enumerate(np.array_split(events, 50)):
                if events_hz:
                    writer.write_events(part)
                elif k in (0, 49):
                    writer.write_events(part[:1])
            for k in range(5 * frames_hz):
                t_us = 1_000 + k * 1_000_000 // frames_hz
                picture = pictures[k * len(pictures) // (5 * frames_hz)]
                writer.write_frame(Frame(picture, t_us, t_us + 5_000))
        return GelView(tmp_path / "cache/gel.png", f"file:{path}")

    return look


def colours(path):
    """How many pixels of the saved picture are green and red."""
    _, green, red = cv2.imread(str(path)).astype(int).transpose(2, 0, 1)
    return int(((green > 150) & (red < 50)).sum()), int(((red > 200) & (green < 50)).sum())


def test_a_gel_at_rest_in_the_middle(view, tmp_path):
    found = view(draw(gel()))
    assert found.check_stream().status is CheckStatus.OK
    assert "25 frames/s" in found.check_stream().sentence
    markers = found.check_markers()
    assert markers.status is CheckStatus.OK
    assert markers.sentence.startswith("177 of 177 markers, contrast ")
    assert found.check_rest().status is CheckStatus.OK
    green, red = colours(tmp_path / "cache/gel.png")
    assert green > 177 * 30
    assert red == 0


def test_too_few_frames(view):
    assert view(draw(gel()), frames_hz=10).check_stream().status is CheckStatus.WARNING


def test_no_frames(view):
    found = view(draw(gel()), frames_hz=0)
    assert found.check_stream().status is CheckStatus.FAILED
    assert found.check_markers().status is CheckStatus.SKIPPED
    assert found.check_rest().status is CheckStatus.SKIPPED


def test_too_many_events_for_a_gel_at_rest(view):
    finding = view(draw(gel()), events_hz=600_000).check_stream()
    assert finding.status is CheckStatus.WARNING
    assert "flicker" in finding.fix


def test_the_lamp_is_off(view):
    finding = view(draw(gel(), light=0.0)).check_markers()
    assert finding.status is CheckStatus.FAILED
    assert "LED ring" in finding.fix


def test_many_bright_dots_are_no_gel(view):
    dots = np.random.default_rng(3).uniform((20, 20), (320, 240), (300, 2))
    finding = view(draw(dots)).check_markers()
    assert finding.status is CheckStatus.FAILED
    assert finding.sentence.startswith("No gel can be found, ")


def test_the_gel_is_faint(view):
    finding = view(draw(gel(), light=50.0)).check_markers()
    assert finding.status is not CheckStatus.OK


def test_the_gel_is_off_the_middle(view):
    finding = view(draw(gel((205.0, 129.5)))).check_markers()
    assert finding.status is CheckStatus.WARNING
    assert "+32 px, -0 px off the middle" in finding.sentence.replace("+0", "-0")


def test_a_hand_covers_a_part(view, tmp_path):
    seen = gel()
    found = view(draw(seen), draw(seen[seen[:, 0] > 140]))
    finding = found.check_markers()
    assert finding.status is CheckStatus.WARNING
    assert found.check_rest().status is CheckStatus.WARNING
    _, red = colours(tmp_path / "cache/gel.png")
    assert red > 100  # where markers should be


def test_a_lamp_beside_the_gel_is_no_marker(view, tmp_path):
    picture = draw([*gel(), (30.0, 40.0)])
    found = view(picture)
    assert found.check_markers().status is CheckStatus.OK
    _, green, red = cv2.imread(str(tmp_path / "cache/gel.png")).transpose(2, 0, 1)
    yellow = np.argwhere((green > 200) & (red > 200))
    assert len(yellow) > 50
    assert np.abs(yellow.mean(0) - (3 * 40 + 1, 3 * 30 + 1)).max() < 2


def test_a_hand_on_the_gel_from_the_start(view):
    seen = gel()
    pushed = seen + 12.0 * np.exp(-(((seen - (150, 110)) / 30) ** 2).sum(1, keepdims=True))
    found = view(draw(pushed))
    assert found.check_rest().status is CheckStatus.WARNING
    assert "resting" in found.check_rest().fix


def test_a_gel_that_slides(view):
    pictures = [draw(gel((172.5 + shift, 129.5))) for shift in np.linspace(0.0, 1.2, 10)]
    found = view(*pictures)
    assert found.check_rest().status is CheckStatus.WARNING


def test_without_camera_and_driver_nothing_can_be_said(tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    found = GelView(tmp_path / "gel.png")
    looks = (found.check_stream, found.check_markers, found.check_rest)
    assert {look().status for look in looks} == {CheckStatus.SKIPPED}


def test_what_compiles_before_the_first_packet_takes_nothing_from_the_look(view, monkeypatch):
    now_s = [0.0]

    class Compiling(ExitStack):
        is_simulated = False

        def __iter__(self):
            now_s[0] += 30.0
            yield from packets

    found = view(draw(gel()))
    with open_source(found._source, speed="max") as packets:
        monkeypatch.setattr(doctor_gel, "time", SimpleNamespace(monotonic=lambda: now_s[0]))
        monkeypatch.setattr(doctor_gel, "open_source", lambda *_, **__: Compiling())
        assert found.check_stream().status is CheckStatus.OK
