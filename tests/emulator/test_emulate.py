"""``neurotouch emulate`` as a user meets it."""

import sys

import pytest
from neurotouch_devtools.emulator import FaultKind
from neurotouch_devtools.emulator.usbip import VHCI

from tests.processes import run_command


def emulate(*arguments):
    command = [sys.executable, "-m", "neurotouch_hid", "emulate", *arguments]
    return run_command(*command, code=None)


def test_it_explains_itself():
    done = emulate("--help")
    assert done.returncode == 0
    assert "Examples:" in done.stdout


def test_it_lists_what_can_go_wrong():
    done = emulate("--list-faults")
    assert done.returncode == 0
    assert all(kind in done.stdout for kind in FaultKind)


@pytest.mark.skipif(VHCI.exists(), reason="this kernel has virtual USB ports")
def test_without_virtual_ports_it_says_how_to_get_them():
    done = emulate()
    assert done.returncode == 3
    assert "modprobe vhci-hcd" in done.stderr


def test_a_fault_it_does_not_know_is_refused():
    done = emulate("--fault", "smoke")
    assert done.returncode == 3
    assert "'smoke' is not a fault" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--without", "gain"], "Only a webcam can lack a setting"),
        (["--camera", "ps3"], "Choices: davis, uvc"),
    ],
)
def test_what_does_not_fit_together_is_refused(arguments, words):
    done = emulate(*arguments)
    assert done.returncode == 2
    assert words in done.stderr
