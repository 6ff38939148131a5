"""Things that many tests share: one simulated push, made once; folders that are not the user's."""

import os
import signal
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling

from neurotouch_hid.messages import EventPacket, GestureKind, Truth
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence
from tests.kernel.machine import choose_machine

KERNEL = "tests/kernel/"
SLOW = KERNEL, "tests/page/", "tests/tracker/", "tests/cli/"
"""Folders with slow files, the slowest first. Each process begins with a kernel."""

# No test is timed, compiled kernels take their time at the first call; the same examples each time.
settings.register_profile("steady", deadline=None, derandomize=True)
settings.load_profile("steady")


def pytest_configure(config: pytest.Config) -> None:
    """No test meets the driver, the profiles or the settings of who runs it, nor each other's.

    Set before any test is collected: some read the shipped profiles when they are imported.
    """
    for signum in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT):
        # Who runs in the background ignores them, and so would every program that the tests start.
        if signal.getsignal(signum) is signal.SIG_IGN:
            signal.signal(signum, signal.SIG_DFL)
    patch = pytest.MonkeyPatch()
    config.add_cleanup(patch.undo)
    # Hypothesis draws the numbers that stand in our modules, too, of those that are loaded: which
    # these are depends on the tests that this process has run before.
    patch.setattr(providers, "_get_local_constants", providers.Constants, raising=False)
    own = TemporaryDirectory(prefix="nt-", ignore_cleanup_errors=True)
    config.add_cleanup(own.cleanup)
    for name in ("XDG_RUNTIME_DIR", "XDG_CONFIG_HOME"):
        home = Path(own.name) / name.lower()
        home.mkdir(mode=0o700)
        patch.setenv(name, str(home))
    patch.setenv("CONFIGURATION_DIRECTORY", f"{own.name}/machine")
    # Only here: a driver that runs for root on this machine would be asked otherwise.
    patch.setenv("RUNTIME_DIRECTORY", f"{own.name}/neurotouch")


class _ByFile(LoadFileScheduling):
    """Shares the work by files, whose fixtures are made once; a kernel boots once for its files."""

    def _split_scope(self, nodeid: str) -> str:
        path = super()._split_scope(nodeid)
        if not path.startswith(KERNEL):
            return path
        return choose_machine(path.removeprefix(KERNEL))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The slow files come first, so that all processes end at about the same time."""
    items.sort(key=lambda item: [not item.nodeid.startswith(folder) for folder in SLOW])


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """How many processes ``-n auto`` starts: kernels and browsers wait for a part of the time."""
    return (os.cpu_count() or 1) + 1


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> _ByFile:
    """Work for several processes; groups by mark do not work with this pytest."""
    return _ByFile(config, log)


@dataclass(frozen=True)
class Played:
    """What a simulated camera saw, and the truth at the end of each packet."""

    packets: tuple[EventPacket, ...]
    truths: tuple[Truth, ...]


@pytest.fixture(scope="session")
def push() -> Played:
    """2.5 s: rest, a push of 7 mm to the right, rest."""
    stroke = Stroke(GestureKind.PUSH, (Finger((2.0, 3.0), (7.0, 0.0)),))
    simulator = Simulator(sequence("push", stroke), seed=1)
    pairs = [(packet, simulator.truth(packet.t_end_us)) for packet in simulator]
    packets, truths = zip(*pairs, strict=True)
    return Played(packets, truths)
