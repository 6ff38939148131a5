"""A hand led from outside: what it does on the gel, and what nobody can make it do."""

import json
import math
import os
import socket
import subprocess
import time
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.geometry import PAPER_GEL, make_gel, place_square
from neurotouch_hid.ipc import HAND, connect_to
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.mouse_gel import MouseSource
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.gel.motion import KNOT_US
from neurotouch_hid.source.simulator.hand_model import (
    PUSH_MM,
    SILENCE_KNOTS,
    SPEED_MM_S,
    GuidedHand,
    HandCommand,
    read_hand_command,
)
from neurotouch_hid.source.simulator.script import FINGERTIP_RADIUS_MM


class Leader:
    """Leads a hand knot by knot."""

    def __init__(self, gel=PAPER_GEL):
        self.wish = None
        self.noticed = []
        self.hand = GuidedHand(self._ask, lambda wish, t_us: self.noticed.append((wish, t_us)), gel)
        self._t_us = 0

    def lead(self, n, **wish):
        """So many knots on; the last answer."""
        found = None
        for _ in range(n):
            self.wish = HandCommand(**wish) if wish else None
            found = self.hand.find(self._t_us)
            self._t_us += KNOT_US
        return None if found is None else (found[0], found[0].move(found[1]))

    def _ask(self):
        wish, self.wish = self.wish, None
        return wish


def test_nothing_is_wished_nothing_is_done():
    assert Leader().lead(10) is None


def test_a_push_is_followed_at_the_speed_of_a_hand_and_let_go():
    leader = Leader()
    hold, state = leader.lead(1, down=True, x_mm=5.0, push_x_mm=8.0)
    assert hold.kind == GestureKind.PUSH
    assert [finger.contact_mm for finger in hold.fingers] == [(5.0, 0.0)]
    assert state[0, 0] == pytest.approx(SPEED_MM_S * KNOT_US * 1e-6)
    _, state = leader.lead(20, down=True, x_mm=5.0, push_x_mm=8.0)
    assert state[0, :3] == pytest.approx([8.0, 0.0, 0.0])
    assert state[0, 3] > 1.0
    again, _ = leader.lead(5, down=True, x_mm=5.0, push_x_mm=6.0)
    assert again is hold  # the same fingers go on
    assert leader.lead(60, down=False) is None


@pytest.mark.parametrize(
    ("wish", "kind"),
    [
        ({"spread_mm": 5.0}, GestureKind.ZOOM),
        ({"spread_mm": -5.0}, GestureKind.PINCH),
        ({"twist_rad": 0.4}, GestureKind.TWIST_CW),
        ({"twist_rad": -0.4}, GestureKind.TWIST_CCW),
    ],
)
def test_two_fingers_open_close_and_turn(wish, kind):
    hold, state = Leader().lead(40, down=True, **wish)
    assert hold.kind == kind
    places = np.array([finger.contact_mm for finger in hold.fingers])
    after = places + state[:, :2]
    grown = np.hypot(*(after[0] - after[1])) - np.hypot(*(places[0] - places[1]))
    assert grown == pytest.approx(2 * wish.get("spread_mm", 0.0), abs=1e-6)
    turned = np.angle(complex(*(after[0] - after[1])) / complex(*(places[0] - places[1])))
    assert turned == pytest.approx(wish.get("twist_rad", 0.0))


@pytest.mark.parametrize("radius_mm", [8.0, 12.0, 20.0, 30.0])
@pytest.mark.parametrize("wish", [{}, {"spread_mm": 5.0}, {"spread_mm": -10.0}, {"twist_rad": 0.4}])
def test_fingers_are_laid_on_a_gel_of_any_size(wish, radius_mm):
    gel = make_gel("g", place_square(2.5, radius_mm), pitch_mm=2.5, radius_mm=radius_mm, dot_mm=0.7)
    for at_mm in ((22.0, 0.0), (-22.0, 22.0), (1.0, -22.0)):
        x_mm, y_mm = at_mm
        leader = Leader(gel)
        hold, state = leader.lead(
            40, down=True, x_mm=x_mm, y_mm=y_mm, resting=True, push_x_mm=0.5, **wish
        )
        laid_mm = np.array([finger.contact_mm for finger in hold.fingers])
        far_mm = np.hypot(*laid_mm.T)
        assert (far_mm <= gel.rim_mm - FINGERTIP_RADIUS_MM + 1e-6).all()
        if wish:
            before, after = (
                np.diff(laid_mm[:2], axis=0),
                np.diff((laid_mm + state[:, :2])[:2], axis=0),
            )
            assert (before * after).sum() > 0.0  # fingers that close do not cross
        assert leader.lead(1, down=True, x_mm=x_mm, y_mm=y_mm, resting=True, **wish)[0] is hold


def test_one_finger_is_lifted_before_two_are_laid():
    leader = Leader()
    one, _ = leader.lead(20, down=True, push_x_mm=5.0)
    kinds = [leader.lead(1, down=True, spread_mm=5.0)[0] for _ in range(60)]
    assert kinds[0] is one
    assert kinds[-1].kind == GestureKind.ZOOM
    assert len({id(each) for each in kinds}) == 2


def test_an_impaired_hand_trembles_opens_weakly_and_rests():
    leader = Leader()
    states = [
        leader.lead(1, down=True, push_x_mm=5.0, tremor_mm=2.0, tremor_hz=5.0)[1][0, 0]
        for _ in range(150)
    ]
    assert np.ptp(states[50:]) == pytest.approx(4.0, abs=0.1)
    _, state = Leader().lead(40, down=True, spread_mm=8.0, weak_zoom=0.5)
    assert np.hypot(*state[0, :2]) == pytest.approx(4.0)
    _, state = Leader().lead(40, down=True, spread_mm=-8.0, weak_zoom=0.5)
    assert np.hypot(*state[0, :2]) == pytest.approx(8.0)
    leader = Leader()
    hold, _ = leader.lead(20, resting=True)
    assert (hold.kind, len(hold.fingers)) == (GestureKind.NONE, 2)
    hold, state = leader.lead(30, resting=True, down=True, push_x_mm=6.0)
    assert (hold.kind, len(hold.fingers)) == (GestureKind.PUSH, 3)
    assert state[1, 3] == pytest.approx(1.5)  # the others stay where they are
    hold, _ = leader.lead(80, resting=True)
    assert (hold.kind, len(hold.fingers)) == (GestureKind.NONE, 2)
    assert leader.lead(80, resting=False) is None


def test_a_hand_that_nobody_leads_any_more_lets_go():
    leader = Leader()
    leader.lead(20, down=True, push_x_mm=5.0)
    assert leader.lead(SILENCE_KNOTS - 30) is not None
    assert leader.lead(100) is None


@given(st.binary(max_size=300) | st.text().map(str.encode))
def test_any_bytes_are_a_wish_or_none(text):
    assert read_hand_command(text) is None or isinstance(read_hand_command(text), HandCommand)


@given(
    st.dictionaries(
        st.sampled_from(list(HandCommand.__slots__)),
        st.floats() | st.booleans() | st.none() | st.integers() | st.text(max_size=3),
    )
)
def test_no_wish_leads_the_hand_out_of_bounds(said):
    wish = read_hand_command(json.dumps(said).encode())
    if wish is None:
        return
    leader = Leader()
    values = {name: getattr(wish, name) for name in HandCommand.__slots__}
    for _ in range(40):
        found = leader.lead(1, **values)
        if found is not None:
            assert np.isfinite(found[1]).all()
            assert np.abs(found[1][:, :2]).max() < 2.5 * PUSH_MM + 8.0


def test_too_much_is_cut_and_nonsense_is_none():
    assert read_hand_command(b'{"down": true, "push_x_mm": 1e9}') == HandCommand(
        down=True, push_x_mm=PUSH_MM
    )
    assert read_hand_command(b'{"push_x_mm": NaN}') is None
    assert read_hand_command(b'{"push_x_mm": true}') is None
    assert read_hand_command(b"[]") is None
    assert read_hand_command(b'{"down": 1}') == HandCommand()


def test_the_gel_answers_as_it_answers_a_script():
    leader = Leader()
    leader.wish = None

    def ask():
        return HandCommand(down=True, push_x_mm=7.0)

    simulator = Simulator(GuidedHand(ask, lambda wish, t_us: None), seed=1, slice_us=4_000)
    packets = list(islice(simulator, 50))
    truth = simulator.truth(packets[-1].t_end_us)
    assert truth.kind == GestureKind.PUSH
    assert truth.intensity_mm == pytest.approx(7.0, rel=0.15)
    assert sum(len(packet.events) for packet in packets) > 1000


SEND_AS_NOBODY = """\
import contextlib, os, socket, sys
os.setgid(65534)
os.setuid(65534)
line = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
line.connect(sys.argv[1])
line.send(b'{"down": true, "push_x_mm": 9}')
print("sent", flush=True)
line.settimeout(60)
with contextlib.suppress(ConnectionResetError):  # what it sent was not read
    assert line.recv(1) == b""
print("turned away")
"""


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can be somebody else")
def test_a_hand_of_another_user_is_not_heard():
    with TemporaryDirectory() as top:
        Path(top).chmod(0o755)
        with MouseSource(Path(top)) as source:
            (Path(top) / HAND).chmod(0o777)
            program = ["/usr/bin/python3", "-c", SEND_AS_NOBODY, str(Path(top) / HAND)]
            with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as stranger:
                assert stranger.stdout.readline() == "sent\n"
                packets = iter(source)
                for _ in range(3):
                    next(packets)
                assert stranger.communicate(timeout=60)[0] == "turned away\n"
                assert not source._pending  # and nothing of it has reached the gel


def test_wishes_come_through_a_socket_and_their_way_is_timed(tmp_path):
    with MouseSource(tmp_path) as source:
        peer = connect_to(tmp_path / HAND)
        packets = iter(source)
        next(packets)
        peer.send(b"nonsense")
        deadline = time.monotonic() + 60
        while source.measure_lag() is None:  # what was wished for a second ago is not counted
            assert time.monotonic() < deadline
            at_ms = 1e3 * time.time()
            peer.send(json.dumps({"down": True, "push_x_mm": 9, "at_ms": at_ms}).encode())
            packet = next(packets)
            source.watch(type("Step", (), {"packet": packet})())
        assert 0.0 < source.measure_lag()[0] < 1e3
        peer.close()
        for _ in range(3):
            next(packets)
        assert math.isfinite(packet.t_end_us)
    assert not (tmp_path / HAND).exists()
    with pytest.raises(OSError, match=r".*"), socket.socket(socket.AF_UNIX) as line:
        line.connect(str(tmp_path / HAND))
