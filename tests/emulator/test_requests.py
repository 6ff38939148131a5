"""Endpoint 0: what each request is answered."""

import struct

import pytest
from neurotouch_devtools.emulator import CameraConfig, Identity

from tests.emulator.host import IN, OUT, Host

STALL = -32


@pytest.fixture
def host():
    return Host([])


READ_ONLY = {
    **{(0, p): v for p, v in {80: 1, 81: 0, 82: 0, 83: 0, 84: 0}.items()},
    **{(1, p): v for p, v in {0: 260, 1: 346, 2: 4}.items()},
    **{(1, p): 1 for p in (10, 30, 40, 50, 60, 80)},
    **{(1, p): 0 for p in range(81, 93)},
    **{(2, p): v for p, v in {0: 260, 1: 346, 2: 4, 3: 0, 6: 1}.items()},
    (3, 0): 1,
    (4, 10): 1,
    **{(6, p): v for p, v in enumerate((18, 5, 1, 120, 30, 80, 1008, 1))},
}


@pytest.mark.parametrize(("address", "value"), READ_ONLY.items())
def test_what_is_read_only_stays(host, address, value):
    assert host.read(*address) == value
    assert host.write(*address, 0xABCD).status == 0
    assert host.read(*address) == value


POWER_UP = {(2, 5): 1, (2, 7): 1, (2, 10): 345, (2, 11): 259, (9, 0): 1, (1, 43): 345, (1, 44): 259}


@pytest.mark.parametrize(("address", "value"), POWER_UP.items())
def test_after_power_up(host, address, value):
    assert host.read(*address) == value


@pytest.mark.parametrize("address", [(5, 10), (4, 14), (1, 3), (2, 12), (0, 4), (9, 1)])
def test_what_is_written_is_read_back(host, address):
    assert host.write(*address, 0x12345678).length == 4
    assert host.read(*address) == 0x12345678


def test_what_does_not_exist_is_nothing(host):
    assert host.read(7, 3) == 0
    assert host.read(1, 200) == 0


def test_many_are_written_in_order(host):
    data = bytes([5, 10, 0, 0, 1, 2, 5, 11, 0, 0, 3, 4, 5, 10, 0, 0, 5, 6])
    assert host.request(OUT, 0xC2, 3, 0, data).length == 18
    assert (host.read(5, 10), host.read(5, 11)) == (0x0506, 0x0304)
    assert host.request(OUT, 0xC2, 2, 0, data).status == STALL


@pytest.mark.parametrize(("request_code", "value"), [(0xB1, 4), (0xC6, 0)])
def test_the_vendor_s_own_requests_are_acknowledged(host, request_code, value):
    assert host.request(OUT, request_code, value, 0).status == 0


@pytest.mark.parametrize("kind", [IN, OUT])
@pytest.mark.parametrize("request_code", [0xB0, 0xB9, 0xBB, 0xC0, 0xC9])
def test_everything_else_stalls(host, kind, request_code):
    assert host.request(kind, request_code, 0, 0, length=4).status == STALL


def test_a_write_of_the_wrong_length_stalls(host):
    assert host.request(OUT, 0xBF, 5, 10, b"\0\0").status == STALL


def test_wrong_versions_and_chips_can_be_had():
    host = Host([], CameraConfig(logic=(17, 0), chip=2, colour=1, identity=Identity(firmware=5)))
    assert [host.read(6, 0), host.read(6, 7), host.read(6, 1), host.read(2, 3)] == [17, 0, 2, 1]
    assert host.request(0x80, 6, 0x0100, 0, length=18).data[12:14] == b"\x05\x03"


def test_the_device_descriptor(host):
    data = host.request(0x80, 6, 0x0100, 0, length=64).data
    assert struct.unpack("<BBHBBBBHHHBBBB", data) == (
        *(18, 1, 0x0300, 0xFF, 0, 0, 9, 0x152A, 0x841A, 0x0306, 1, 2, 3, 1),
    )
    assert host.request(0x80, 6, 0x0100, 0, length=8).data == data[:8]


@pytest.mark.parametrize(("super_speed", "size", "packet"), [(True, 44, 1024), (False, 32, 512)])
def test_the_configuration(super_speed, size, packet):
    host = Host([], CameraConfig(identity=Identity(super_speed=super_speed)))
    data = host.request(0x80, 6, 0x0200, 0, length=255).data
    assert len(data) == size == int.from_bytes(data[2:4], "little")
    endpoints, rest = {}, data
    while rest:
        if rest[1] == 5:
            endpoints[rest[2]] = (rest[3], int.from_bytes(rest[4:6], "little"))
        rest = rest[rest[0] :]
    assert endpoints == {0x81: (3, 64), 0x82: (2, packet)}


def test_strings(host):
    texts = [host.request(0x80, 6, 0x0300 | k, 0x409, length=255).data for k in range(4)]
    assert texts[0] == b"\x04\x03\x09\x04"
    assert [text[2:].decode("utf-16-le") for text in texts[1:]] == [
        "iniVation",
        "DAVIS 346",
        "00000001",
    ]
    assert host.request(0x80, 6, 0x0304, 0x409, length=255).status == STALL
    mute = Host([], CameraConfig(identity=Identity(serial=None)))
    assert mute.request(0x80, 6, 0x0100, 0, length=18).data[16] == 0
    assert mute.request(0x80, 6, 0x0303, 0x409, length=255).status == STALL


def test_each_speed_has_its_own_descriptors(host):
    high = Host([], CameraConfig(identity=Identity(super_speed=False)))
    assert host.request(0x80, 6, 0x0F00, 0, length=255).data[4] == 2
    assert high.request(0x80, 6, 0x0F00, 0, length=255).status == STALL
    assert high.request(0x80, 6, 0x0600, 0, length=10).length == 10
    assert host.request(0x80, 6, 0x0600, 0, length=10).status == STALL


def test_standard_requests(host):
    assert host.request(0x00, 9, 1, 0).status == 0
    assert host.request(0x80, 8, 0, 0, length=1).data == b"\x01"
    assert host.request(0x81, 10, 0, 0, length=1).data == b"\0"
    assert host.request(0x80, 0, 0, 0, length=2).data == b"\0\0"
    assert host.request(0x01, 11, 0, 0).status == 0
    assert host.request(0x80, 0x55, 0, 0, length=2).status == STALL
