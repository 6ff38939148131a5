"""The driver in a real kernel, on emulated cameras: sound, with every fault, and many plugs."""

import pytest

from tests.kernel.guest.davis import FAULTS, LOSING, N_PLUGS

LOST_NOTHING = ("timeout+5x64", "unplug@stop+1")
ONE_CONNECT = (*LOST_NOTHING, "stall+9", "babble+9")
UNPLUGGED = [fault for fault in FAULTS if fault.startswith("unplug") and "stop" not in fault]


def test_a_camera_is_listed_and_identified(guest):
    saw = guest("davis_stream")
    assert saw["info"] == ["00000001", 5000, 6, ""]
    for words in ("firmware=6", "logic=18", "logic_patch=1", "chip='DAVIS346B'", "color=0"):
        assert words in saw["versions"]
    assert saw["log"] == []


@pytest.mark.parametrize("library", ["libusb1", "pyusb"])
def test_every_event_and_frame_arrives(guest, library):
    saw = guest("davis_stream")[library]
    assert saw["same"], saw
    assert (saw["n_shifts"], saw["gap"], saw["n_faults"], saw["n_connects"]) == (1, 0, 0, 1)
    assert saw["sound"]


def test_closing_switches_the_camera_off(guest):
    assert guest("davis_stream")["stopped"]


@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_is_survived(guest, fault):
    saw = guest("davis_faults")[fault]
    assert saw["ordered"]
    assert saw["sound"]
    assert saw["end"], saw
    if fault in ONE_CONNECT:
        assert saw["n_connects"] == 1
    if fault in LOST_NOTHING:
        assert saw["same"], saw
        assert saw["gap"] == 0
    elif fault in LOSING:
        assert saw["gap"] >= 1
    assert saw["n_cables"] == 1 + (fault in UNPLUGGED)


def test_a_serial_chooses_among_cameras_and_usb_2_is_warned_about(guest):
    saw = guest("davis_choice")
    assert (saw["serials"], saw["speeds"]) == (["00000001", "00000002"], [5000, 480])
    assert saw["name"] == "davis:00000002"
    assert saw["same"], saw
    assert "00000002 runs at the speed of USB 2" in saw["log"][0]
    assert saw["unknown"] == "No camera 7 is plugged in."


def test_a_camera_that_another_program_holds_is_refused_by_its_number(guest):
    saw = guest("davis_choice")
    assert saw["refused"] == f"The camera 00000002 is in use by PID {saw['holder']}."
    assert saw["exit_code"] == 75
    assert saw["listed"] == [f"in use by PID {saw['holder']}"]


def test_plugs_and_a_switched_off_camera_leave_nothing_behind(guest):
    saw = guest("davis_plugs")
    assert saw["n_connects"] == N_PLUGS + 2
    first, *after = saw["counts"]
    assert all(n <= m for count in after for n, m in zip(count, first, strict=True)), saw


def test_a_killed_driver_leaves_a_camera_that_the_next_one_starts_anew(guest):
    saw = guest("davis_killed")
    assert saw["refused"] == f"The camera 00000001 is in use by PID {saw['holder']}."
    assert saw["exit_code"] == 75
    assert saw["still_runs"]
    assert saw["begins_us"] == [10_000 * k for k in range(30)]
    assert saw["n_connects"] == 1
