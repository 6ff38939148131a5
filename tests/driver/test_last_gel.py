"""The turn of the gel is remembered: a start near 45° does not choose another one of four."""

import math
from dataclasses import replace

import pytest

from neurotouch_hid.driver import Driver, DriverOptions
from neurotouch_hid.driver.last_gel import LastGel, find_last_gel
from neurotouch_hid.geometry import Rig, fit_rig
from neurotouch_hid.messages import GelState
from neurotouch_hid.players import find_user_file
from neurotouch_hid.source.simulator import Simulator, find_scene
from neurotouch_hid.source.simulator.config import SimulatorConfig

OPTIONS = DriverOptions(source="davis:", device="memory", listens=False)


class Camera(Simulator):
    """A gel that is turned in the picture of what says that it is a camera."""

    is_live, is_simulated = True, False

    def __init__(self, turned_deg: float) -> None:
        config = SimulatorConfig()
        rig = Rig((172.5, 129.5), 2.5, math.radians(turned_deg))
        config = replace(config, camera=replace(config.camera, rig=rig))
        super().__init__(find_scene("rest"), config)


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    return tmp_path


def start(turned_deg: float) -> float:
    """Returns the turn, in degrees, that a driver finds."""
    with Driver(OPTIONS, make_source=lambda: Camera(turned_deg)) as driver:
        for step in driver.steps(seconds=2.0):
            if step.rest is not None:
                return math.degrees(fit_rig(step.rest.position_px).rotation_rad)
    raise AssertionError("the gel was not found")


def test_a_start_near_45_degrees_takes_the_last_turn():
    assert start(44.0) == pytest.approx(44.0, abs=1.0)
    assert start(46.0) == pytest.approx(46.0, abs=1.0)
    assert start(50.0) == pytest.approx(50.0, abs=1.0)
    find_last_gel().unlink()
    assert start(50.0) == pytest.approx(-40.0, abs=1.0)


def test_the_turn_in_the_cameras_settings_goes_before_the_last_one():
    LastGel().remember(GelState(rotation_deg=10.0))
    find_user_file().with_name("camera.yaml").write_text("version: 1\nrotation_deg: 90\n")
    assert start(3.0) == pytest.approx(93.0, abs=1.0)


@pytest.mark.parametrize("content", ["", "{", '{"version":1,"rotation_deg":"x"}', "[]", "NaN"])
def test_a_damaged_file_is_no_fault(content):
    find_last_gel().parent.mkdir(parents=True, exist_ok=True)
    find_last_gel().write_text(content)
    assert LastGel().rotation_rad == 0.0


def test_a_service_remembers_in_its_own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("STATE_DIRECTORY", str(tmp_path / "state"))
    LastGel(2).remember(GelState(rotation_deg=44.0))
    assert (tmp_path / "state/last-gel-2.json").exists()
    assert LastGel(2).rotation_rad == pytest.approx(math.radians(44.0))
