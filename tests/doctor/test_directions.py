"""One push to the right and one clockwise twist find a mirrored and a turned picture."""

import math
from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.doctor.directions import View, advise, find_view, judge_view, watch_view
from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.driver.camera_settings import load_camera_settings, save_camera_settings
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import SENSOR_WIDTH_PX, GestureKind, no_gesture
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.script import sequence
from neurotouch_hid.source.simulator.strokes import pinch, push, twist

NEVER = lambda: False  # noqa: E731


def mirror(packet):
    """The packet as a camera sees it through a mirror."""
    events = packet.events.copy()
    events["x"] = SENSOR_WIDTH_PX - 1 - events["x"]
    frames = tuple(
        replace(frame, pixels=np.ascontiguousarray(frame.pixels[:, ::-1]))
        for frame in packet.frames
    )
    return replace(packet, events=events, frames=frames)


def see(*strokes, turned_deg=0.0, mirrored=False):
    """Packets of strokes before a camera that is turned and looks into a mirror."""
    config = SimulatorConfig()
    rig = Rig((172.5, 129.5), 2.5, math.radians(turned_deg))
    config = replace(config, camera=replace(config.camera, rig=rig))
    packets = Simulator(sequence("two", *strokes), config)
    return map(mirror, packets) if mirrored else packets


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    return tmp_path


@pytest.mark.parametrize(
    ("turned_deg", "mirrored", "view"),
    [
        (0.0, False, View(False, 0, 0.0)),
        (90.0, False, View(False, 90, 90.0)),
        (80.0, True, View(True, 90, 80.0)),
    ],
)
def test_the_real_recogniser_sees_how_the_camera_looks_at_the_gel(turned_deg, mirrored, view):
    said = []
    packets = see(push(0.0, 7.0), twist(0.5), turned_deg=turned_deg, mirrored=mirrored)
    found = watch_view(packets, said.append, NEVER)
    assert found.is_mirrored == view.is_mirrored
    assert found.turned_deg == view.turned_deg
    assert found.rotation_deg == pytest.approx(view.rotation_deg, abs=1.5)
    assert [sentence.split()[0] for sentence in said] == ["Push", "Now"]


def look(push_deg, assumed_deg=0.0, *, clockwise=True):
    """What is found from a push that is seen in this direction in the picture."""
    seen = math.radians(push_deg - assumed_deg)
    pushed = replace(no_gesture(0), translation_mm=(math.cos(seen), math.sin(seen)))
    kind = GestureKind.TWIST_CW if clockwise else GestureKind.TWIST_CCW
    return find_view(pushed, replace(no_gesture(0), kind=kind), assumed_deg)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("true_deg", [-170.0, -95.0, -40.0, 0.0, 50.0, 130.0, 180.0])
def test_what_is_found_makes_the_next_look_right(true_deg, mirrored):
    lattice_deg = -true_deg if mirrored else true_deg
    assumed_deg = lattice_deg - 90.0 * round(lattice_deg / 90.0)
    push_deg = 180.0 - true_deg if mirrored else true_deg
    view = look(push_deg, assumed_deg, clockwise=not mirrored)
    assert view.is_mirrored == mirrored
    assert (view.rotation_deg - true_deg) % 360.0 == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("push_deg", [45.0, -50.0, 130.0])
def test_a_slanting_push_tells_nothing(push_deg):
    assert look(push_deg) is None


def test_a_hexagonal_gel_looks_the_same_after_a_sixth_of_a_turn():
    def look_at(push_deg):
        seen = math.radians(push_deg)
        pushed = replace(no_gesture(0), translation_mm=(math.cos(seen), math.sin(seen)))
        return find_view(pushed, replace(no_gesture(0), kind=GestureKind.TWIST_CW), 10.0, 6)

    assert look_at(-118.0) == View(is_mirrored=False, turned_deg=240, rotation_deg=-110.0)
    assert look_at(30.0) is None


def test_another_gesture_is_named_and_asked_for_again():
    said = []
    assert watch_view(see(pinch(6.0), push(0.0, 7.0)), said.append, NEVER) is None
    assert "That was a pinch. Once more." in said
    assert said[-1].startswith("Now")


def test_whoever_skips_gets_no_answer_and_so_does_a_source_that_ends():
    assert watch_view(see(push(0.0, 7.0)), str, NEVER) is None
    assert watch_view(see(push(0.0, 7.0), twist(0.5)), str, lambda: True) is None


def test_the_settings_that_are_found_can_be_saved_and_nothing_else_changes(home):
    path = home / "config/neurotouch/camera.yaml"
    path.parent.mkdir(parents=True)
    path.write_text("version: 1\nexposure_us: 8000  # dim\nmirrored: true\n")
    view = View(is_mirrored=True, turned_deg=90, rotation_deg=91.2)
    advice = advise(view)
    assert (advice.path, advice.is_own) == (path, True)
    finding = judge_view(view, advice)
    assert finding.status is CheckStatus.WARNING
    assert finding.sentence == "The camera sees the gel mirrored and turned by 90°."
    assert finding.fix.endswith("mirrored: false, rotation_deg: 91")
    save_camera_settings(path, advice.changes)
    saved = load_camera_settings()
    assert (saved.mirrored, saved.rotation_deg, saved.exposure_us) == (False, 91.0, 8000)
    assert "# dim" in path.read_text()


def test_settings_are_made_where_there_are_none(home):
    path = home / "config/neurotouch/camera.yaml"
    save_camera_settings(path, {"mirrored": True})
    assert load_camera_settings().mirrored


def test_a_right_view_needs_no_change():
    view = View(is_mirrored=False, turned_deg=0, rotation_deg=3.0)
    assert judge_view(view, advise(view)).status is CheckStatus.OK
    assert advise(view).changes == {}
