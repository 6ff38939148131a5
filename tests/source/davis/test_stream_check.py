"""A stream that is out of step is told from a sound one, whatever the camera sees."""

import numpy as np
import pytest
from neurotouch_devtools.emulator import registers as reg

from neurotouch_hid.evaluation.speed.workload import load_scene
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.source.davis.decoder import Decoder
from neurotouch_hid.source.davis.stream_check import (
    MAX_IMPOSSIBLE,
    MAX_JUMP_US,
    OutOfStepError,
    StreamCheck,
)
from tests.source.davis.cable import emulate

STEP_US = 1_000
LENGTH_US = 1_600_000
SWITCHES = (reg.CHIP_RUN, reg.USB_RUN, reg.TIMESTAMP_RUN, reg.MUX_RUN, reg.DVS_RUN, reg.APS_RUN)


def see_nothing(grey=None):
    """No events; without a grey value no frames, as a camera sees a lens cap."""
    for begin_us in range(0, LENGTH_US, 10_000):
        frames = ()
        if grey is not None and begin_us % 40_000 == 0:
            pixels = np.full((260, 346), grey, np.uint8)
            frames = (Frame(pixels, begin_us + 2_000, begin_us + 6_000),)
        yield EventPacket(begin_us, begin_us + 10_000, np.empty(0, EVENT_DTYPE), frames)


def see_gel(name):
    return load_scene(name, 10_000, LENGTH_US).packets


SCENES = {
    "nothing": see_nothing,
    "black": lambda: see_nothing(0),
    "grey": lambda: see_nothing(128),
    "white": lambda: see_nothing(255),
    "rest": lambda: see_gel("rest"),
    "push": lambda: see_gel("push"),
}


@pytest.fixture(scope="module", params=SCENES)
def reads(request):
    """What the driver reads in each millisecond of a scene."""
    now = [0]
    camera = emulate(SCENES[request.param](), clock_ns=lambda: now[0])
    for switch in SWITCHES:
        camera.write(switch, 1)
    camera.write(reg.EARLY_PACKET_DELAY, 1)
    found = []
    for t_us in range(STEP_US, LENGTH_US, STEP_US):
        now[0] = 1_000 * t_us
        data = b""
        while (more := camera.read(8_192)) is not None:
            data += more
        found.append(data)
    return found


def judge(reads):
    """Reads all; what the decoder says, and after how many ms the stream was refused."""
    decoder, check = Decoder(synced=True), StreamCheck(0, 0.0)
    for k, data in enumerate(reads):
        decoder.decode(data)
        n_impossible = decoder.stats().n_impossible
        try:
            check.check(len(data) // 2, n_impossible, decoder.now_us, 1e-6 * STEP_US * (k + 1))
        except OutOfStepError:
            return decoder.stats(), k
    return decoder.stats(), None


def test_a_sound_stream_is_believed(reads):
    stats, refused = judge(reads)
    assert (stats.n_impossible, stats.n_lost, refused) == (0, 0, None)


@pytest.mark.parametrize("at", [0.1, 0.2, 0.3])
def test_a_stream_that_lacks_a_byte_is_refused(reads, at):
    """Within a tenth of a second; a camera that sees nothing has nothing to say, and a second."""
    n = next(k for k in range(int(at * len(reads)), len(reads)) if reads[k])
    _, refused = judge([*reads[:n], reads[n][1:], *reads[n + 1 :]])
    assert refused is not None
    is_dead = sum(map(len, reads)) < 1_000
    assert refused - n < (1_100 if is_dead else 100)


def test_a_transfer_of_nonsense_is_refused_at_once(reads):
    n = len(reads) // 2
    nonsense = np.random.default_rng(1).bytes(8_192)
    assert judge([*reads[:n], reads[n] + nonsense, *reads[n + 1 :]])[1] == n


def test_so_many_impossible_words_are_no_stray_ones():
    check = StreamCheck(0, 0.0)
    check.check(0, MAX_IMPOSSIBLE - 1, 0, 0.0)
    with pytest.raises(OutOfStepError, match="makes no sense"):
        check.check(0, MAX_IMPOSSIBLE, 0, 0.0)


def test_stray_words_are_forgotten():
    check, n = StreamCheck(0, 0.0), 0
    for _ in range(1_000):
        n += 10
        check.check(100_000, n, 0, 0.0)  # nothing is left of them, and no credit
    check.check(0, n + MAX_IMPOSSIBLE - 1, 0, 0.0)
    with pytest.raises(OutOfStepError, match="makes no sense"):
        check.check(0, n + MAX_IMPOSSIBLE, 0, 0.0)


def test_the_camera_s_clock_may_drift():
    check = StreamCheck(5_000_000, 100.0)
    for k in range(240):  # a fast one, for a day: 300 ppm
        check.check(0, 0, 5_000_000 + 360_108_000 * k, 100.0 + 360.0 * k)


def test_the_camera_s_clock_may_lag_and_catch_up_but_not_leap():
    check = StreamCheck(5_000_000, 100.0)
    for k in range(30):  # nobody reads for half a minute, then all comes at once
        check.check(0, 0, 5_000_000, 101.0 + k)
    check.check(0, 0, 35_000_000 + MAX_JUMP_US, 130.0)
    with pytest.raises(OutOfStepError, match="jumped ahead by 1 s"):
        check.check(0, 0, 35_000_001 + 2 * MAX_JUMP_US, 130.0)
    with pytest.raises(OutOfStepError, match="jumped ahead by 1 s"):
        StreamCheck(0, 100.0).check(0, 0, MAX_JUMP_US + 1, 100.0)
