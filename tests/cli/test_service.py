"""``neurotouch service`` up to the pad; tests/system tries the rest in a whole Debian."""

import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.processes import make_environment, run_command

# As systemd does it: the program itself finds its number in LISTEN_PID.
HAND_OVER = """\
import os, sys
for descriptor in (3, 4, 5):
    os.dup2(os.open("/dev/null", os.O_RDWR), descriptor)
    os.set_inheritable(descriptor, True)
os.environ |= {
    "LISTEN_PID": str(os.getpid()), "LISTEN_FDS": "3", "LISTEN_FDNAMES": "uinput:uinput:uinput"
}
os.execv(sys.executable, [sys.executable, "-m", "neurotouch_hid", "service", *sys.argv[1:]])
"""

LIMIT_S = 300


@pytest.fixture
def folders(tmp_path) -> dict[str, str]:
    """What the unit sets."""
    (tmp_path / "etc/neurotouch").mkdir(parents=True)
    return make_environment(tmp_path) | {"XDG_CONFIG_HOME": str(tmp_path / "etc")}


def run(folders, *command: str) -> subprocess.CompletedProcess[str]:
    return run_command(sys.executable, *command, code=None, env=folders)


def test_it_takes_the_descriptors_that_systemd_hands_over(folders, tmp_path):
    """/dev/null is no /dev/uinput, and only the kernel can say so."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(str(tmp_path / "notify"))
        systemd.setblocking(False)
        folders["NOTIFY_SOCKET"] = str(tmp_path / "notify")
        said = run(folders, "-c", HAND_OVER, "--source", "sim:push")
        told = systemd.recv(1000)
        with pytest.raises(BlockingIOError):
            systemd.recv(1000)  # never that it is ready
    assert said.returncode == 7
    assert "The kernel refuses to create" in said.stderr
    assert told.startswith(b"STATUS=")


def test_a_mistake_in_its_settings_ends_it_with_the_place(folders):
    file = Path(folders["XDG_CONFIG_HOME"]) / "neurotouch/service.yaml"
    file.write_text("version: 1\ndevise: uinput\n")
    said = run(folders, "-m", "neurotouch_hid", "service")
    assert said.returncode == 6
    assert "service.yaml:2:1" in said.stderr
    assert "'device'" in said.stderr


def test_a_profile_that_is_not_there_ends_it(folders):
    file = Path(folders["XDG_CONFIG_HOME"]) / "neurotouch/service.yaml"
    file.write_text("version: 1\nprofile: racin\n")
    said = run(folders, "-m", "neurotouch_hid", "service")
    assert said.returncode == 6
    assert "racing" in said.stderr


@pytest.mark.parametrize("identity", ["xbox361", "/nowhere/pad.toml", r"a\0.toml"])
def test_an_identity_that_cannot_be_used_is_a_mistake_in_its_settings(folders, identity):
    file = Path(folders["XDG_CONFIG_HOME"]) / "neurotouch/service.yaml"
    file.write_text(f'version: 1\nidentity: "{identity}"\n')
    said = run(folders, "-m", "neurotouch_hid", "service")
    assert said.returncode == 6
    assert "service.yaml: identity: " in said.stderr
    assert "Traceback" not in said.stderr


def test_compiling_needs_neither_camera_nor_pad(folders):
    said = run(folders, "-m", "neurotouch_hid", "service", "--compile")
    assert said.returncode == 0, said.stderr


IN_MEMORY = """\
from neurotouch_hid.__main__ import main
from neurotouch_hid.cli import service
from neurotouch_hid.device import MemoryDevice
service._make_pad = lambda *_, **__: MemoryDevice()  # only the kernel can make the true one
main()
"""


def test_its_loop_feeds_the_watchdog_of_systemd(folders, tmp_path):
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(str(tmp_path / "notify"))
        systemd.settimeout(LIMIT_S)
        folders |= {"NOTIFY_SOCKET": str(tmp_path / "notify"), "WATCHDOG_USEC": "1000000"}
        with ThreadPoolExecutor(1) as pool:
            running = pool.submit(run, folders, "-c", IN_MEMORY, "service", "--source", "sim:press")
            told = [systemd.recv(1000).decode()]
            while told[-1] != "STOPPING=1":
                told.append(systemd.recv(1000).decode())
        done = running.result()
    assert done.returncode == 0, done.stderr
    told = [each for each in told if not each.startswith("STATUS=")]
    assert told[0] == "READY=1"
    assert told[-1] == "STOPPING=1"
    assert set(told[1:-1]) == {"WATCHDOG=1"}
