"""The order in which a driver opens what it needs."""

import pytest

from neurotouch_hid.driver import Driver, DriverOptions, driver
from neurotouch_hid.driver.gel_file import ChosenGel
from neurotouch_hid.errors import DeviceError, NotRunningError, SourceError
from neurotouch_hid.geometry import PAPER_GEL


@pytest.fixture
def order(monkeypatch):
    """What has been done, in its order; no kernel is loaded."""
    done = []
    monkeypatch.setattr(driver, "ask_status", lambda: done.append("driver found"))
    monkeypatch.setattr(driver, "choose_gel", lambda *_, **__: ChosenGel(PAPER_GEL, b""))
    monkeypatch.setattr(driver, "load_kernels", lambda *_: done.append("kernels loaded"))
    return done


def enter(order, **options):
    def open_source():
        order.append("source opened")
        raise SourceError("It ends here.")

    chosen = DriverOptions(device="memory", speed="max", **options)
    with pytest.raises(SourceError), Driver(chosen, make_source=open_source):
        pass
    return order


def test_another_drivers_packets_are_taken_from_the_moment_they_come(order):
    """It gives up a reader that takes none for 10 s, and loading can take longer."""
    done = enter(order, source="driver:")
    assert done == ["driver found", "kernels loaded", "source opened"]


def test_other_sources_are_opened_before_anything_is_loaded(order):
    assert enter(order, source="sim:rest") == ["source opened"]


def test_another_driver_that_does_not_run_is_told_at_once(order, monkeypatch):
    def ask():
        raise NotRunningError("No driver is running.")

    monkeypatch.setattr(driver, "ask_status", ask)
    options = DriverOptions(source="driver:", device="memory", speed="max")
    with pytest.raises(NotRunningError), Driver(options):
        pass
    assert order == []


def test_missing_copilot_is_told_before_anything_is_loaded(order):
    options = DriverOptions(source="sim:rest", device="memory", copilot="nosuch")
    with pytest.raises(DeviceError, match="'nosuch'"), Driver(options):
        pass
    assert order == []


def test_without_pads_no_profile_is_loaded():
    options = DriverOptions(source="sim:tour", profile="nosuch", device="memory", speed="max")
    with Driver(options, pads=False) as opened:
        steps = [*opened.steps(seconds=1.0)]
    assert len(steps) == 100
    assert all(step.pad.is_neutral for step in steps)
