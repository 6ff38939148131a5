"""What the service tells systemd, and what it takes from it."""

import os
import socket

import pytest

from neurotouch_hid.driver import systemd as systemd_module
from neurotouch_hid.driver.systemd import ServiceManager


@pytest.fixture
def systemd(tmp_path):
    """The socket that systemd listens at."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as line:
        line.bind(str(tmp_path / "notify"))
        line.settimeout(5)
        yield line


def environment(systemd, **more):
    return {"NOTIFY_SOCKET": systemd.getsockname(), **more}


def test_systemd_hears_when_it_is_ready_what_it_does_and_that_it_ends(systemd):
    manager = ServiceManager(environment(systemd))
    manager.report_ready()
    manager.report_status("davis:7 drives the pad")
    manager.report_stopping()
    heard = [systemd.recv(1000).decode() for _ in range(3)]
    assert heard == ["READY=1", "STATUS=davis:7 drives the pad", "STOPPING=1"]


def test_an_address_in_the_abstract_namespace():
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as line:
        line.bind(f"\0neurotouch@test-{os.getpid()}")  # the second @ is a part of the name
        line.settimeout(5)
        address = line.getsockname().decode().replace("\0", "@", 1)
        ServiceManager({"NOTIFY_SOCKET": address}).report_ready()
        assert line.recv(1000) == b"READY=1"


def test_the_watchdog_is_fed_four_times_in_its_limit_however_often_the_loop_turns(systemd):
    now_s = [100.0]
    manager = ServiceManager(
        environment(systemd, WATCHDOG_USEC="2000000"), clock_s=lambda: now_s[0]
    )
    for _ in range(200):  # 2 s
        manager.report_alive()
        now_s[0] += 0.01
    manager.report_stopping()
    heard = [systemd.recv(1000) for _ in range(5)]
    assert heard == [b"WATCHDOG=1"] * 4 + [b"STOPPING=1"]


def test_the_watchdog_is_fed_as_soon_as_a_quarter_of_its_limit_has_passed(systemd):
    now_s = [100.0]
    manager = ServiceManager(
        environment(systemd, WATCHDOG_USEC=f"{4 * 10**12}"), clock_s=lambda: now_s[0]
    )
    for now_s[0] in (100.0, 1_000_099.5):
        manager.report_alive()
    manager.report_status("not yet")
    now_s[0] = 1_000_100.0
    manager.report_alive()
    heard = [systemd.recv(1000) for _ in range(3)]
    assert heard == [b"WATCHDOG=1", b"STATUS=not yet", b"WATCHDOG=1"]


def test_a_systemd_that_does_not_read_or_is_not_there_holds_nothing_up(systemd, tmp_path):
    now_s = [100.0]
    manager = ServiceManager(
        environment(systemd, WATCHDOG_USEC="2000000"), clock_s=lambda: now_s[0]
    )
    for _ in range(1000):  # more than its queue takes
        manager.report_alive()
        now_s[0] += 1.0
    (tmp_path / "notify").unlink()
    manager.report_alive()
    assert systemd.recv(1000) == b"WATCHDOG=1"


def test_a_watchdog_for_another_process_is_not_ours_to_feed(systemd):
    manager = ServiceManager(environment(systemd, WATCHDOG_USEC="2000000", WATCHDOG_PID="1"))
    manager.report_alive()
    manager.report_ready()
    assert systemd.recv(1000) == b"READY=1"


def test_without_systemd_it_is_silent():
    manager = ServiceManager({})
    manager.report_ready()
    manager.report_alive()
    assert manager.take_descriptor("uinput") is None


def test_no_child_inherits_what_systemd_said(systemd):
    told = environment(systemd, WATCHDOG_USEC="1", LISTEN_FDS="0", LISTEN_PID="1", HOME="/")
    ServiceManager(told)
    assert told == {"HOME": "/"}


@pytest.fixture
def handed_over(tmp_path, monkeypatch):
    """What systemd sets for three descriptors; 3 to 5, which it uses, are taken here."""
    assert systemd_module._FIRST_DESCRIPTOR == 3
    monkeypatch.setattr(systemd_module, "_FIRST_DESCRIPTOR", 203)
    for number in (203, 204, 205, 206):
        with (tmp_path / str(number)).open("w") as file:
            os.dup2(file.fileno(), number)
    yield {"LISTEN_PID": str(os.getpid()), "LISTEN_FDS": "3", "LISTEN_FDNAMES": "uinput:x:uinput"}
    for number in (203, 204, 205, 206):
        os.close(number)


def test_handed_over_descriptors_are_given_out_once_each_by_name(handed_over):
    manager = ServiceManager(handed_over)
    names = ("uinput", "uinput", "uinput", "x")
    assert [manager.take_descriptor(name) for name in names] == [203, 205, None, 204]
    inherited = [os.get_inheritable(number) for number in (203, 204, 205, 206)]
    assert inherited == [False, False, False, True]


def test_descriptors_for_another_process_are_not_ours(handed_over):
    manager = ServiceManager(handed_over | {"LISTEN_PID": "1"})
    assert manager.take_descriptor("uinput") is None
    assert os.get_inheritable(203)


def test_descriptors_without_their_names_are_an_error(handed_over):
    with pytest.raises(ValueError, match="zip"):
        ServiceManager(handed_over | {"LISTEN_FDNAMES": "uinput"})
