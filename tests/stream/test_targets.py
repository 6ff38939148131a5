"""Streams to other programs: heard by the libraries that those programs use."""

import json
import socket
import struct
import sys
import time

import numpy as np
import pylsl
import pytest
from pythonosc.osc_packet import OscPacket
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from neurotouch_hid.errors import StreamError
from neurotouch_hid.stream import Reading, open_target, read_address
from neurotouch_hid.stream.lsl import CHANNELS
from neurotouch_hid.stream.target import Address
from neurotouch_hid.stream.web_socket import describe
from neurotouch_hid.vocabulary import Axis, Button

LIMIT_S = 60.0
AT_REST = Reading()
PINCH = Reading(
    t_us=2_500_000,
    state="running",
    simulated=True,
    kind="pinch",
    intensity_mm=3.25,
    confidence=0.75,
    movement="pinch",
    moved_mm=(0.5, -1.5),
    turned_rad=0.25,
    scale=0.875,
    contacts_mm=((-10.0, 1.0), (10.0, 2.0)),
    axes=AT_REST.axes | {"left_trigger": 0.5},
    buttons=AT_REST.buttons | {"a": True},
    markers_mm=np.array([[0.5, -0.25], [1.0, 2.0]], np.float32),
)


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("osc://127.0.0.1:9001", Address("osc", "127.0.0.1", 9001)),
        ("osc://studio", Address("osc", "studio", 9000)),
        ("osc", Address("osc", "127.0.0.1", 9000)),
        ("osc://[::1]:9001/", Address("osc", "::1", 9001)),
        ("websocket", Address("websocket", "127.0.0.1", 8765)),
        ("ws://127.0.0.1:0", Address("websocket", "127.0.0.1", 0)),
        ("lsl", Address("lsl")),
        ("ros2", Address("ros2")),
    ],
)
def test_an_address_is_understood(text, meaning):
    assert read_address(text) == meaning


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("midi", "is no address to stream to"),
        ("", "is no address to stream to"),
        ("osc://host:0x10", "needs a port"),
        ("osc://host:70000", "needs a port"),
        ("osc://127.0.0.1:0", "needs a port"),
        ("osc://[::1:9000", "is no address to stream to"),
        ("osc:9000", "is no address to stream to"),
        ("osc://host:9000/path", "more than a host and a port"),
        ("osc://me@host:9000", "more than a host and a port"),
        ("lsl://host", "is no address to stream to"),
        ("http://127.0.0.1", "is no address to stream to"),
    ],
)
def test_what_is_no_address_is_refused(text, why):
    with pytest.raises(ValueError, match=why):
        read_address(text)


def hear_osc(heard):
    return {each.message.address: each.message.params for each in OscPacket(heard).messages}


def test_osc_has_all_of_a_state():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.bind(("127.0.0.1", 0))
        ear.settimeout(LIMIT_S)
        address = Address("osc", "127.0.0.1", ear.getsockname()[1])
        with open_target(address, markers=True) as target:
            assert target.name == f"osc://127.0.0.1:{address.port}"
            target.send(PINCH)
            heard = hear_osc(ear.recv(65536))
            target.send(AT_REST)
            at_rest = hear_osc(ear.recv(65536))
    assert heard["/neurotouch/gesture"] == ["pinch", 3.25, 0.75]
    assert heard["/neurotouch/state"] == ["running"]
    assert heard["/neurotouch/simulated"] == [1]
    assert heard["/neurotouch/time"] == [2.5]
    assert heard["/neurotouch/movement"] == ["pinch"]
    assert heard["/neurotouch/moved"] == [0.5, -1.5]
    assert heard["/neurotouch/turned"] == [0.25]
    assert heard["/neurotouch/scale"] == [0.875]
    assert heard["/neurotouch/contacts"] == [-10.0, 1.0, 10.0, 2.0]
    assert heard["/neurotouch/pad/left_trigger"] == [0.5]
    assert heard["/neurotouch/pad/a"] == [1]
    assert heard["/neurotouch/pad/b"] == [0]
    assert heard["/neurotouch/markers"] == [0.5, -0.25, 1.0, 2.0]
    assert at_rest["/neurotouch/gesture"] == ["none", 0.0, 0.0]
    assert at_rest["/neurotouch/contacts"] == []
    for control in (*Axis, *Button):
        assert at_rest[f"/neurotouch/pad/{control}"] == [0]


def test_osc_that_nobody_hears_does_not_matter():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    with open_target(Address("osc", "127.0.0.1", port), markers=False) as target:
        for _ in range(100):  # the second one gets "connection refused" for the first
            target.send(PINCH)


def test_osc_to_an_unknown_host_is_refused():
    with pytest.raises(StreamError, match=r"'no\.such\.invalid' cannot be reached"):
        open_target(Address("osc", "no.such.invalid", 9000), markers=False)


@pytest.fixture
def server():
    with open_target(Address("websocket", "127.0.0.1", 0), markers=True) as made:
        yield made


def send_until(target, reading, hears):
    """Sends a state again and again, as a driver does, until ``hears`` returns something."""
    deadline = time.monotonic() + LIMIT_S
    while True:
        target.send(reading)
        try:
            return hears()
        except TimeoutError:
            assert time.monotonic() < deadline


def test_a_web_socket_has_all_of_a_state(server):
    with connect(server.name) as ear:
        heard = json.loads(send_until(server, PINCH, lambda: ear.recv(timeout=0.1)))
    assert heard["kind"] == "pinch"
    assert heard["intensity_mm"] == 3.25
    assert heard["contacts_mm"] == [[-10.0, 1.0], [10.0, 2.0]]
    assert heard["axes"]["left_trigger"] == 0.5
    assert heard["buttons"] == AT_REST.buttons | {"a": True}
    assert heard["markers_mm"] == [[0.5, -0.25], [1.0, 2.0]]
    assert heard.keys() == set(Reading.__slots__)


@pytest.mark.parametrize("origin", ["https://elsewhere.example", "null", "http://localhost.evil"])
def test_pages_of_other_sites_may_not_listen(server, origin):
    with pytest.raises(InvalidStatus, match="403"):
        connect(server.name, origin=origin)


@pytest.mark.parametrize("origin", ["http://localhost:8080", "http://127.0.0.1"])
def test_pages_of_this_machine_may_listen(server, origin):
    with connect(server.name, origin=origin) as ear:
        assert send_until(server, PINCH, lambda: ear.recv(timeout=0.1))


def test_one_who_stops_hearing_does_not_hold_up_the_others(server):
    with connect(server.name) as ear, connect(server.name, max_queue=1) as sleeper:
        many = Reading(markers_mm=np.ones((177, 2), np.float32))
        send_until(server, many, lambda: sleeper.recv(timeout=0.1))
        for n in range(4000):  # 10 MB
            server.send(Reading(t_us=n, markers_mm=many.markers_mm))
            if n % 10 == 0:
                last = json.loads(ear.recv(timeout=LIMIT_S))
        sent = PINCH
        while last["kind"] != "pinch":
            last = json.loads(send_until(server, sent, lambda: ear.recv(timeout=1.0)))
        waiting = max(each.transport.get_write_buffer_size() for each in server._server.connections)
    assert waiting < 128 * 1024


def test_one_who_goes_without_a_goodbye_is_no_error(server, caplog):
    for _ in range(2):
        with connect(server.name) as line:
            server.send(PINCH)
            line.recv(5.0)
            line.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            line.socket.shutdown(socket.SHUT_RDWR)
    with connect(server.name) as line:
        server.send(PINCH)
        line.recv(5.0)
    assert [record.getMessage() for record in caplog.records if record.levelname == "ERROR"] == []


def test_a_port_that_is_taken_is_refused(server):
    port = int(server.name.rpartition(":")[2])
    with pytest.raises(StreamError, match=f"at 127.0.0.1:{port}: Address already in use\\.$"):
        open_target(Address("websocket", "127.0.0.1", port), markers=False)


def test_lsl_has_all_of_a_state():
    with open_target(Address("lsl"), markers=True) as target:
        inlets = {}
        for name in ("neurotouch", "neurotouch-gesture"):
            (info,) = pylsl.resolve_byprop("name", name, 1, LIMIT_S)
            inlets[name] = pylsl.StreamInlet(info)
            inlets[name].open_stream(LIMIT_S)
        target.send(PINCH)
        values, stamp = inlets["neurotouch"].pull_sample(LIMIT_S)
        gesture, at = inlets["neurotouch-gesture"].pull_sample(LIMIT_S)
        (info,) = pylsl.resolve_byprop("name", "neurotouch-markers", 1, LIMIT_S)
        assert info.channel_count() == 4
        whole = inlets["neurotouch"].info(LIMIT_S)  # its channels are freed with it
        channel = whole.desc().child("channels").child("channel")
        labels = []
        while not channel.empty():
            labels.append(channel.child_value("label"))
            channel = channel.next_sibling()
    assert labels == [name for name, _ in CHANNELS]
    found = dict(zip(labels, values, strict=True))
    assert found["kind"] == 2.0
    assert found["intensity"] == 3.25
    assert (found["contact_2_x"], found["contact_2_y"]) == (10.0, 2.0)
    assert np.isnan(found["contact_3_x"])
    assert found["left_trigger"] == 0.5
    assert gesture == ["pinch"]
    assert at == stamp


def test_lsl_streams_of_another_player_have_names_of_their_own(monkeypatch):
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "2")
    with open_target(Address("lsl"), markers=True) as target:
        target.send(PINCH)
        assert target.name == "LSL streams 'neurotouch-2' and 'neurotouch-2-gesture'"
        for name in ("neurotouch-2", "neurotouch-2-gesture", "neurotouch-2-markers"):
            (info,) = pylsl.resolve_byprop("source_id", name, 1, LIMIT_S)
            assert info.name() == name


@pytest.mark.parametrize(("kind", "module"), [("osc", "pythonosc"), ("lsl", "pylsl")])
def test_a_missing_library_is_named_with_the_command_that_installs_it(monkeypatch, kind, module):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(StreamError) as refusal:
        open_target(read_address(kind), markers=False)
    assert refusal.value.hint == f"Install it: pip install 'neurotouch-hid[{kind}]'"


def test_a_library_that_cannot_be_loaded_is_not_said_to_be_missing(tmp_path, monkeypatch):
    (tmp_path / "pylsl.py").write_text(
        "raise RuntimeError('LSL binary library file was not found')"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "pylsl")
    with pytest.raises(StreamError, match="needs the library liblsl") as refusal:
        open_target(read_address("lsl"), markers=False)
    assert "PYLSL_LIB" in refusal.value.hint


def test_the_numbers_of_markers_are_short():
    reading = Reading(markers_mm=np.array([[-0.03, 1.1]], np.float32))
    assert json.dumps(describe(reading, markers=True)["markers_mm"]) == "[[-0.03, 1.1]]"
