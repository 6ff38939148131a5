"""Every fault happens when it should, as often as it should, and what comes after is right."""

import errno
from itertools import pairwise

import pytest
from neurotouch_devtools.emulator import CameraConfig, Fault, FaultKind, Stage
from neurotouch_devtools.emulator.port import UnpluggedError

from neurotouch_hid.errors import SourceError
from tests.emulator.host import Host, list_events, make_scene


def watch(*faults, us=400_000, strict=True, **config):
    """A host after all of the scene; its listener has heard everything."""
    host = Host(make_scene(), CameraConfig(**config), [Fault.parse(text) for text in faults])
    host.listener.strict = strict
    host.write(0, 5, 1)
    host.read_part()
    host.switch_on()
    host.reset_time()
    host.wait(us)
    return host


def heard_events(host):
    return [event[1:] for event in host.listener.events]


SHOWN = [event[1:] for event in list_events(make_scene())]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("unplug", Fault(FaultKind.UNPLUG)),
        ("stall@open", Fault(FaultKind.STALL, Stage.OPEN)),
        ("timeout@configure+3", Fault(FaultKind.TIMEOUT, Stage.CONFIGURE, 3)),
        ("short@stream+10x4", Fault(FaultKind.SHORT, Stage.STREAM, 10, 4)),
    ],
)
def test_faults_have_a_short_form(text, fault):
    assert Fault.parse(text) == fault


@pytest.mark.parametrize(
    "text", ["", "smoke", "stall@lunch", "stall+", "odd@open", "stall@open x2"]
)
def test_what_is_no_fault_is_refused(text):
    with pytest.raises(SourceError):
        Fault.parse(text)


@pytest.mark.parametrize("text", ["stall@open+1x2", "protocol@open+1x2"])
def test_requests_fail_and_then_work_again(text):
    host = Host([], faults=[Fault.parse(text)])
    ends = [host.request(0xC0, 0xBF, 6, 0, length=4) for _ in range(4)]
    code = errno.EPIPE if "stall" in text else errno.EPROTO
    assert [end.status for end in ends] == [0, -code, -code, 0]


def test_a_request_is_answered_by_half():
    host = Host([], faults=[Fault.parse("short@open")])
    assert host.request(0xC0, 0xBF, 6, 0, length=4).data == b"\0\0"
    assert host.read(6, 0) == 18


def test_a_request_is_never_answered_but_can_be_cancelled():
    host = Host([], faults=[Fault.parse("timeout@configure")])
    assert host.write(5, 10, 1) is None
    assert host.read(5, 10) == 0
    assert host.port.cancel(1)
    assert not host.port.cancel(1)


@pytest.mark.parametrize("stage", [stage for stage in Stage if stage is not Stage.PICTURE])
def test_it_can_be_unplugged_at_every_stage(stage):
    host = Host(make_scene(), faults=[Fault(FaultKind.UNPLUG, stage)])
    steps = {
        Stage.PLUGGED: lambda: host.request(0x80, 6, 0x0100, 0, length=18),
        Stage.OPEN: lambda: host.read(6, 0),
        Stage.CONFIGURE: host.switch_on,
        Stage.STREAM: lambda: host.wait(200_000),
        Stage.STOP: lambda: host.write(1, 3, 0),
    }
    for reached, step in steps.items():
        if reached is stage:
            with pytest.raises(UnpluggedError):
                step()
            break
        step()


def test_stopping_is_told_from_configuring():
    host = Host(make_scene(), faults=[Fault.parse("stall@stop+1")])
    host.switch_on()
    host.wait(100_000)
    assert host.write(5, 10, 7).status == 0
    assert host.write(1, 3, 0).status == 0
    assert host.write(2, 4, 0).status == -errno.EPIPE


def test_a_stalled_stream_stays_stalled_until_the_halt_is_cleared():
    host = watch("stall@stream+5")
    ends = [answer.status for answer in host.answers]
    assert ends[:5] == [0] * 5
    assert set(ends[5:]) == {-errno.EPIPE}
    n = len(host.answers)
    host.request(0x02, 1, 0, 0x82)
    host.wait(100_000)
    assert {answer.status for answer in host.answers[n:]} == {0}
    assert host.listen().wraps


def test_a_bad_cable_loses_no_data_here():
    host = watch("protocol+5x3")
    assert [a.status for a in host.answers[4:9]] == [0, *3 * [-errno.EPROTO], 0]
    host.listen()
    assert heard_events(host) == SHOWN


def test_babble_loses_its_data():
    host = watch("babble+5", strict=False)
    assert host.answers[5].status == -errno.EOVERFLOW
    n = len(host.listen().events)
    assert 0 < n <= len(SHOWN)


@pytest.mark.parametrize("text", ["short+5x200", "odd+5x40"])
def test_transfers_are_cut_anywhere_but_nothing_is_lost(text):
    host = watch(text)
    lengths = [answer.length for answer in host.answers]
    if "odd" in text:
        assert sum(length % 2 for length in lengths) >= 30
    else:
        cut = [a.data for a in host.answers[5:205] if a.data]
        assert sum(data[-1] & 0xF0 == 0x10 for data in cut) > 50
    host.listen()
    assert heard_events(host) == SHOWN
    assert len(host.listener.frames) == 3


def test_a_transfer_hangs_for_ever():
    host = watch("timeout+5")
    assert host.listen()
    assert heard_events(host) == SHOWN
    assert any(host.port.cancel(number) for number in range(1, 40))


def test_stale_words_come_before_everything():
    host = watch("stale", strict=False)
    assert host.data[:4] == b"\x23\x71\x34\x92"
    _, _, after = host.data.partition(b"\x01\x00")
    host.data = after
    assert [e[1:] for e in host.listen().events] == SHOWN


def test_events_are_lost_in_the_camera_and_counted_there():
    host = watch("overflow+5x5")
    host.listen()
    assert 0 < host.camera.n_dropped < len(SHOWN)
    assert len(host.listener.events) + host.camera.n_dropped == len(SHOWN)
    assert host.read(1, 86) == host.read(0, 84) == host.camera.n_dropped


@pytest.mark.parametrize("kind", ["range", "unknown", "backward"])
def test_garbled_words_spoil_nothing_but_themselves(kind):
    text = host_data(f"{kind}+5x4")
    assert text != host_data()
    host = watch(f"{kind}+5x4", strict=False)
    host.data = without_specials(host.data)
    kept = [e for e in [e[1:] for e in host.listen().events] if e[0] < 346 and e[1] < 260]
    extra = 4 if kind == "range" else 0
    assert len(SHOWN) <= len(kept) <= len(SHOWN) + extra
    assert [e for e in kept if e in set(SHOWN)] == SHOWN


def host_data(*faults):
    return watch(*faults, strict=False).data


def without_specials(data):
    """Without the words of no meaning, at which the listener would rightly stop."""
    words = [data[k : k + 2] for k in range(0, len(data), 2)]
    unknown = {b"\x00\x00", b"\x06\x00", b"\x20\x00", b"\x00\x5f", b"\x00\x6c"}
    return b"".join(word for word in words if word not in unknown)


def test_the_clock_jumps_over_what_31_bits_hold():
    host = watch("wrap+5")
    heard = host.listen()
    assert heard_events(host) == SHOWN
    assert heard.events[0][0] < 1 << 31 < heard.events[-1][0]
    assert max(heard.wraps) == 0xFFF


def test_the_clock_starts_again_in_mid_stream():
    host = watch("reset+5", strict=False)
    heard = host.listen()
    assert heard.resets == 2
    assert heard_events(host) == SHOWN
    assert heard.events[-1][0] < 200_000


def test_silence_is_silent_and_takes_time():
    host = watch("silence+5x3", us=1_000_000)
    lengths = [answer.length for answer in host.answers]
    assert lengths
    heard = host.listen()
    assert heard_events(host) == SHOWN
    times = [t for t, *_ in heard.events]
    assert max(b - a for a, b in pairwise(times)) >= 99_000


def test_after_a_suspend_all_is_as_after_power_up():
    host = watch("suspend+5")
    host.answers.clear()
    host.wait(200_000)
    assert not host.answers
    assert host.read(0, 0) == 0
    assert host.read(9, 0) == 1
    host.switch_on()
    host.wait(400_000)
    assert host.answers
