"""A process that has gone blind ends, so that a new one can see."""

import pytest

from neurotouch_hid.driver.camera_watchdog import PATIENCE_S, CameraWatchdog
from neurotouch_hid.errors import CameraError
from neurotouch_hid.source import open_source


class Looking:
    """A source that looks for a camera; only what the watchdog asks about."""

    is_blind = False


def test_it_ends_what_stays_blind():
    source, now_s = Looking(), [0.0]
    watchdog = CameraWatchdog(source, lambda: now_s[0])
    source.is_blind = True
    while now_s[0] < PATIENCE_S:
        watchdog.check()
        now_s[0] += 0.5
    now_s[0] = PATIENCE_S
    watchdog.check()
    now_s[0] = PATIENCE_S + 0.1
    with pytest.raises(CameraError, match="cannot find it"):
        watchdog.check()


def test_it_counts_from_the_last_time_all_was_well():
    source, now_s = Looking(), [0.0]
    watchdog = CameraWatchdog(source, lambda: now_s[0])
    for k in range(100):  # blind at every second look: plugged and pulled again and again
        source.is_blind = bool(k % 2)
        watchdog.check()
        now_s[0] += PATIENCE_S / 2


def test_other_sources_never_go_blind():
    with open_source("sim:push", speed="max") as source:
        now_s = [0.0]
        watchdog = CameraWatchdog(source, lambda: now_s[0])
        now_s[0] = 10 * PATIENCE_S
        watchdog.check()


def test_a_camera_source_is_watched():
    with open_source("davis:", wait=True) as source:
        assert not source.is_blind
        assert CameraWatchdog(source)._source is source
