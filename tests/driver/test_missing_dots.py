"""A person is told of missing dots once: at the first start, and again only of further ones."""

import json
import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from neurotouch_hid.driver import Driver, DriverOptions
from neurotouch_hid.driver.gel_settings import GelSettings
from neurotouch_hid.driver.last_gel import LastGel, find_last_gel
from neurotouch_hid.driver.missing_dots import LOOK_US, MissingDots
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    EventPacket,
    GamepadState,
    GelState,
    MarkerField,
    Step,
    no_gesture,
)
from neurotouch_hid.source.simulator import Simulator, find_scene
from neurotouch_hid.source.simulator.config import SimulatorConfig

EMPTY = np.empty(0, EVENT_DTYPE)
OPTIONS = DriverOptions(source="davis:", device="memory", speed="max")
HEX = GelSettings.model_validate(
    {"layout": {"kind": "hex", "pitch_mm": 4.65, "radius_mm": 30.0}}
).make()


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    return tmp_path


class Camera(Simulator):
    """A gel that lacks dots, before what says that it is a camera."""

    is_live, is_simulated = True, False

    def __init__(self, percent: float, name: str) -> None:
        super().__init__(
            find_scene("rest"), SimulatorConfig(), nuisances={"missing": percent}, seed=3
        )
        self.name = name


def start(percent: float, name: str = "davis:00000001", **others) -> list[str]:
    """Returns what a driver says of dots within the first two seconds."""
    said: list[str] = []
    options = replace(OPTIONS, **others)
    make = lambda: Camera(percent, name)  # noqa: E731
    with Driver(options, announce=said.append, make_source=make) as driver:
        driver.run(seconds=2.0)
    return [sentence for sentence in said if "not seen" in sentence]


def test_missing_dots_are_told_at_the_first_start_only(home):
    (said,) = start(10.0)
    assert said.startswith("18 of 177 dots are not seen: row 2: 4; row 4: 7; ")
    picture = home / "cache/neurotouch/missing-dots.png"
    assert said.endswith(f"Gestures count without them. Red boxes mark them in {picture}.")
    blue, green, red = cv2.split(cv2.imread(str(picture)))
    boxes = ((red == 255) & (green == 0) & (blue == 0)).astype("uint8")
    n, _, stats, _ = cv2.connectedComponentsWithStats(boxes)
    assert n - 1 <= 18
    assert stats[1:, cv2.CC_STAT_AREA].sum() > 18 * 60
    picture.unlink()
    assert start(10.0) == []
    assert not picture.exists()
    assert len(start(10.0, "davis:00000002")) == 1  # of another camera nothing is known


def test_the_turn_is_kept_beside_the_dots():
    LastGel().remember(GelState(rotation_deg=33.0))
    start(10.0)
    kept = json.loads(find_last_gel().read_text())
    assert len(kept["gels"][0]["told"]) == 18
    assert set(kept["gels"][0]["starts"]) == {0}
    LastGel().remember(GelState(rotation_deg=44.0))
    assert json.loads(find_last_gel().read_text())["gels"] == kept["gels"]
    assert LastGel().rotation_rad == pytest.approx(math.radians(44.0))


def test_a_file_of_an_older_version_is_read():
    find_last_gel().parent.mkdir(parents=True)
    find_last_gel().write_text('{"version":1,"rotation_deg":12.5}')
    assert LastGel().rotation_rad == pytest.approx(math.radians(12.5))


def learn(*missing: int, gel=PAPER_GEL, camera="video:usb-1") -> set[int]:
    """Returns what a new driver tells of dots that are missing."""
    return set(LastGel().learn_missing(frozenset(missing), camera, gel))


def test_a_further_dot_is_told_when_it_is_missing_twice_in_a_row():
    assert learn(1, 2) == {1, 2}
    assert learn(1, 2, 7) == set()  # it may be dust
    assert learn(1, 2, 7) == {7}
    assert learn(1, 2, 7) == set()


def test_glare_and_dust_are_never_told_however_often_one_starts():
    assert learn(1, 2) == {1, 2}
    for k in range(40):
        assert learn(1, 2, 10 + k % 7, 30 + k % 5) == set()


def test_a_dot_that_comes_and_goes_is_told_once():
    assert learn(1, 2) == {1, 2}
    for k in range(40):
        assert learn(*((1, 2) if k % 5 == 0 else (2,))) == set()


def test_a_dot_that_was_painted_again_and_falls_off_again_is_told_again():
    assert learn(1, 2) == {1, 2}
    for _ in range(11):
        assert learn(2) == set()
    assert learn(1, 2) == set()
    assert learn(1, 2) == {1}


def test_each_gel_and_each_camera_has_its_own_dots():
    assert learn(1) == {1}
    assert learn(1, gel=HEX) == {1}
    assert learn(1, camera="video:usb-2") == {1}
    assert learn(1) == learn(1, gel=HEX) == learn(1, camera="video:usb-2") == set()
    for k in range(30):
        learn(1, camera=f"video:usb-{k + 3}")
    assert len(json.loads(find_last_gel().read_text())["gels"]) == 16


@pytest.mark.parametrize(
    "gels",
    [
        '[{"camera":"a","layout":"b","told":[1],"starts":[]}]',
        '[{"camera":"a","layout":"b","told":[400],"starts":[0]}]',
        '[{"camera":"a","layout":"b","told":[-1],"starts":[0]}]',
        '[{"camera":1,"layout":"b"}]',
        "{}",
    ],
)
def test_a_damaged_file_is_as_none(gels):
    find_last_gel().parent.mkdir(parents=True)
    find_last_gel().write_text(f'{{"version":1,"gels":{gels}}}')
    assert learn(5) == {5}
    assert learn(5) == set()


def test_a_place_where_nothing_can_be_written_costs_only_the_memory(home):
    home.joinpath("config").write_text("a file where the folder should be")
    assert learn(5) == {5}
    assert learn(5) == {5}


def step(t_us: int, *missing: int, is_found: bool = True) -> Step:
    places = tuple((10.0 * dot, 20.0) for dot in missing)
    gel = GelState(is_found=is_found, missing=missing, missing_px=places)
    packet, empty = EventPacket(t_us - 1000, t_us, EMPTY), MarkerField(0, None, None, None)
    return Step(packet, None, empty, no_gesture(t_us), GamepadState(t_us), gel)


def test_a_dot_that_is_seen_once_within_the_look_is_not_missing():
    asked: list[frozenset[int]] = []
    with MissingDots(print, lambda missing: asked.append(missing) or frozenset(), None) as tap:
        tap(step(5_000, 1, 2, 3, is_found=False))
        tap(step(10_000, 1, 2, 3))
        tap(step(510_000, 1, 3))
        tap(step(10_000 + LOOK_US - 1, 1, 2, 3))
        assert not asked
        tap(step(10_000 + LOOK_US, 1, 2, 3))
        tap(step(20_000 + LOOK_US))
    assert asked == [{1, 3}]


def test_a_gel_that_is_lost_meanwhile_is_looked_at_again():
    asked: list[frozenset[int]] = []
    with MissingDots(print, lambda missing: asked.append(missing) or frozenset(), None) as tap:
        tap(step(10_000, 1, 2))
        tap(step(500_000, is_found=False))
        tap(step(600_000, 1, 3))
        tap(step(10_000 + LOOK_US, 1, 3))
        tap(step(600_000 + LOOK_US, 1, 3))
    assert asked == [{1, 3}]


def test_without_a_picture_the_doctor_is_named():
    said: list[str] = []
    with MissingDots(said.append, lambda missing: missing & {3}, None) as tap:
        tap(step(10_000, 1, 3))
        tap(step(10_000 + LOOK_US, 1, 3))
    assert said == [
        "1 more dot is not seen: row 1: 4; 2 of 177 in all. Gestures count without them. "
        "To see them: neurotouch doctor"
    ]
