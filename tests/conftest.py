"""Things that many tests share: one simulated push, made once; folders that are not the user's."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import settings

from neurotouch_hid.messages import EventPacket, GestureKind, Truth
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import Finger, Stroke, sequence

# No test is timed, compiled kernels take their time at the first call; the same examples each time.
settings.register_profile("steady", deadline=None, derandomize=True)
settings.load_profile("steady")


@pytest.fixture(autouse=True, scope="session")
def _own_folders() -> Iterator[None]:
    """No test meets the driver, the profiles or the settings of who runs it, nor each other's."""
    with TemporaryDirectory(prefix="nt-") as folder, pytest.MonkeyPatch.context() as patch:
        for name in ("XDG_RUNTIME_DIR", "XDG_CONFIG_HOME"):
            home = Path(folder) / name.lower()
            home.mkdir(mode=0o700)
            patch.setenv(name, str(home))
        # Only here: a driver that runs for root on this machine would be asked otherwise.
        patch.setenv("RUNTIME_DIRECTORY", f"{folder}/neurotouch")
        yield


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
