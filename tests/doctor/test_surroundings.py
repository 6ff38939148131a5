"""The page's port and secret."""

import os
import socket

import pytest

from neurotouch_hid.doctor import surroundings
from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.page.address import Address, find_address_file, write_address


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    return tmp_path / "run"


@pytest.fixture
def port(monkeypatch):
    """A port of our own instead of the usual one, which somebody may use just now.

    Linux gives whoever asks for any port none of these.
    """
    number = next(filter(is_free, range(21_000, 32_000)))
    monkeypatch.setattr(surroundings, "PORT", number)
    return number


def is_free(number):
    with socket.socket() as probe:
        try:
            probe.bind(("127.0.0.1", number))
        except OSError:
            return False
    return True


def test_a_free_port(folder, port):
    assert surroundings.check_page().status is CheckStatus.OK


def test_a_port_that_another_has(folder, port):
    with socket.socket() as other:
        other.bind(("127.0.0.1", port))
        other.listen()
        finding = surroundings.check_page()
    assert finding.status is CheckStatus.WARNING
    assert str(port) in finding.sentence


def test_a_page_that_is_served(folder, port):
    write_address(Address("http://127.0.0.1:1/", "secret", os.getpid()))
    finding = surroundings.check_page()
    assert finding.status is CheckStatus.OK
    assert "secret" not in finding.sentence


def test_a_secret_that_others_can_read(folder, port):
    write_address(Address("http://127.0.0.1:1/", "secret", os.getpid()))
    find_address_file().chmod(0o644)
    finding = surroundings.check_page()
    assert finding.status is CheckStatus.FAILED
    assert finding.commands == (f"chmod 600 {find_address_file()}",)


@pytest.mark.parametrize("variable", [{"NT_ACCESSIBLE": "1"}, {"TERM": "dumb"}, {}])
def test_the_terminal(variable, monkeypatch):
    for name, value in variable.items():
        monkeypatch.setenv(name, value)
    assert surroundings.check_terminal().status is CheckStatus.OK
