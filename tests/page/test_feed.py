"""The feed and its listener: a real line at one end, sockets of the kernel between."""

import json
import os
import select
import threading
import time

import numpy as np
import pytest

from neurotouch_hid.driver_state import read_head
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.ipc import FEED, connect_to
from neurotouch_hid.monitor.encoder import StateEncoder
from neurotouch_hid.monitor.publisher import MOST_SUBSCRIBERS, Publisher
from neurotouch_hid.page.text_view import LineWriter, draw_picture
from neurotouch_hid.profile import UserSettings
from neurotouch_hid.profile.reading.load import parse_profile
from neurotouch_hid.runtime import Pipeline, PipelineControl
from neurotouch_hid.subscriber import MOST_HZ, Subscriber
from tests.waiting import wait_until

LIMIT_S = 60.0
PROFILE = b"""\
version: 1
name: mine
bindings:
  - {when: push, do: {stick: left}}
  - {when: {gesture: push, direction: right, accept_ms: 5000}, do: {button: a}}
"""


class Line:
    """The line on a recorded push, with a feed in a folder."""

    def __init__(self, folder, packets):
        self.packets = packets
        profile = parse_profile(PROFILE, "mine.yaml")
        self.pipeline = Pipeline.build(profile, GestureConfig())
        self.control = PipelineControl(self.pipeline, UserSettings())
        facts = {"source": "sim:push", "simulated": True}
        self.observer = StateEncoder(self.control, lambda: facts)
        self.feed = Publisher(folder, self.observer)

    def play(self, n=None, pace_s=0.0):
        for packet in self.packets[:n]:
            step = self.pipeline.advance(packet)
            self.control.record(step)
            self.feed(step)
            time.sleep(pace_s)
        return step


@pytest.fixture
def line(tmp_path, push, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    made = Line(tmp_path, push.packets)
    yield made
    made.feed.close()
    made.feed.close()
    assert not (tmp_path / FEED).exists()


@pytest.fixture
def listener(line):
    made = Subscriber()
    yield made
    made.close()


def hear(listener, line, hz=MOST_HZ):
    """Connects, and waits until the line knows what is wanted."""
    listener.want(hz)
    assert listener.connect() is not None
    wait_until(lambda: line.feed._period_s == 1.0 / hz)


def look_on(line, listener):
    """Plays all; the number of a slice and the state of it, each time that one is due."""
    due, take = [], line.observer.take
    line.observer.take = lambda step: due.append(step) or take(step)
    for i, packet in enumerate(line.packets):
        line.feed(line.pipeline.advance(packet))
        if due:
            due.clear()
            yield i, wait_until(listener.take)
        time.sleep(0.004)


def test_nothing_is_made_while_nobody_listens(line, listener):
    made = []
    line.observer.take = made.append
    line.play(20)
    assert listener.connect() is not None  # one that wants nothing is nobody either
    line.play(20)
    assert made == []
    assert listener.take() is None


def test_a_state_tells_what_the_line_does(line, listener):
    hear(listener, line)
    states = [state for _, state in look_on(line, listener)]
    heads = list(map(read_head, states))
    pushing = [head for head in heads if head["gesture"]["movement"] == "push_right"]
    assert len(pushing) > 10
    best = max(pushing, key=lambda head: head["gesture"]["felt_mm"])
    assert best["gesture"]["felt_mm"] == pytest.approx(7.0, abs=0.7)
    assert best["say"].startswith("Push right ")
    assert "left stick right" in best["say"]
    assert best["pad"]["axes"]["left_x"] > 0.7
    assert best["slow"]["source"] == "sim:push"
    assert best["slow"]["window_ms"] == 10.0
    assert (best["state"], best["layer"]) == ("running", "base")
    assert [head["n"] for head in heads] == sorted({head["n"] for head in heads})
    actions = heads[-1]["actions"]
    assert [each[1] for each in actions] == ["ignored"]
    assert "< 5000 ms" in actions[0][3]
    state = states[heads.index(best)]
    length = int.from_bytes(state[:4], "little")
    assert len(state) == 8 + length + 9 * 177
    moved = np.frombuffer(state, "<i2", 354, 8 + length + 708).reshape(177, 2) / 100
    assert moved[:, 0].max() == pytest.approx(7.0, abs=0.8)
    assert np.abs(moved[:, 1]).max() < 3.0
    valid = np.frombuffer(state, np.uint8, 177, 8 + length + 1416)
    assert valid.sum() > 150


def test_before_the_gel_is_found_a_state_is_whole_too(line, listener, push):
    hear(listener, line)
    packet = push.packets[0]
    step = line.pipeline.advance(type(packet)(0, 10_000, packet.events[:0]))
    wait_until(lambda: (line.feed(step), listener.take())[1])


def test_a_frozen_listener_holds_nobody_up_and_catches_up_at_once(line, listener):
    hear(listener, line)
    made = []
    encode = line.observer.encode
    line.observer.encode = lambda shot: made.append(shot) or encode(shot)
    step = line.play(pace_s=0.005)  # nobody reads meanwhile
    wait_until(lambda: (line.feed(step), len(made) > 40)[1])
    states = []
    while select.select([listener.peer], [], [], 0.2)[0]:
        states.append(listener.peer.recv(65536))
    assert 1 <= len(states) < 25  # what the kernel keeps; the others were dropped
    line.feed(line.play(1))
    time.sleep(0.05)
    line.play(30, pace_s=0.005)
    wait_until(listener.take)


def test_no_more_states_than_are_wanted_whatever_is_asked(line, listener):
    listener.want(1_000_000)
    listener.connect()
    wait_until(lambda: line.feed._period_s == 1.0 / MOST_HZ)
    listener.want(7)
    wait_until(lambda: line.feed._period_s == pytest.approx(1.0 / 7))
    listener.want(0)
    wait_until(lambda: line.feed._period_s == 0.0)


@pytest.mark.parametrize("nonsense", [b"x", b"-1", b"1.5", b"\xff" * 16])
def test_nonsense_ends_a_listener_and_nothing_else(line, listener, tmp_path, nonsense):
    hear(listener, line)
    with connect_to(tmp_path / FEED) as peer:
        peer.send(nonsense)
        peer.setblocking(True)
        peer.settimeout(LIMIT_S)
        assert peer.recv(100) == b""
    line.play(10, pace_s=0.01)
    wait_until(listener.take)


def test_a_listener_that_goes_is_forgotten(line, listener):
    hear(listener, line)
    listener.close()
    wait_until(lambda: line.feed._period_s == 0.0)
    line.play(5)


def test_a_listener_that_goes_while_it_is_sent_to_ends_nothing_else(line, listener, tmp_path):
    leaving = Subscriber()
    hear(leaving, line)
    asked, answer = threading.Event(), threading.Event()
    line.feed._admits = lambda _uid: (asked.set(), answer.wait(LIMIT_S))[1]
    hear_later = connect_to(tmp_path / FEED)
    assert asked.wait(LIMIT_S)  # the feed's thread is busy: it learns both of the next at once
    line.play(1)
    leaving.close()
    answer.set()
    wait_until(lambda: line.feed._period_s == 0.0)
    hear(listener, line)
    line.play(10, pace_s=0.02)
    wait_until(listener.take)
    hear_later.close()


def test_guests_are_admitted_one_by_one(tmp_path, line):
    asked = []

    def admits(uid):
        asked.append(uid)
        return len(asked) > 1

    (tmp_path / "service").mkdir()
    feed = Publisher(tmp_path / "service", line.observer, admits)
    path = tmp_path / "service" / FEED
    assert path.stat().st_mode & 0o777 == 0o666
    with connect_to(path) as refused, connect_to(path) as welcome:
        for peer in (refused, welcome):
            peer.setblocking(True)
            peer.settimeout(LIMIT_S)
        assert refused.recv(100) == b""
        welcome.send(b"30")
        wait_until(lambda: feed._period_s == 1 / 30)
    assert asked == [os.geteuid()] * 2
    feed.close()


def test_a_guest_who_leaves_the_seat_is_turned_away(tmp_path, line, monkeypatch):
    monkeypatch.setattr("neurotouch_hid.monitor.publisher.AGAIN_S", 0.0)
    (tmp_path / "service").mkdir()
    seated = [os.geteuid()]
    feed = Publisher(tmp_path / "service", line.observer, lambda uid: uid in seated)
    with connect_to(tmp_path / "service" / FEED) as guest:
        guest.setblocking(True)
        guest.settimeout(LIMIT_S)
        guest.send(b"60")
        wait_until(lambda: feed._period_s == 1 / 60)
        step = line.play(1)
        feed(step)
        assert read_head(guest.recv(100_000))["n"] > 0
        seated.clear()
        feed._due_s = 0.0
        feed(step)
        assert guest.recv(100_000) == b""
        wait_until(lambda: feed._period_s == 0.0)  # nobody is left to encode for
    feed.close()


def test_there_is_room_for_a_few(line, tmp_path):
    peers = [connect_to(tmp_path / FEED) for _ in range(MOST_SUBSCRIBERS)]
    wait_until(lambda: len(line.feed._wants) == MOST_SUBSCRIBERS)
    with connect_to(tmp_path / FEED) as late:
        late.setblocking(True)
        late.settimeout(LIMIT_S)
        assert late.recv(100) == b""
    for peer in peers:
        peer.close()


def test_a_driver_that_ends_is_noticed_and_the_next_one_found(line, listener, tmp_path, push):
    hear(listener, line)
    line.feed.close()
    wait_until(lambda: listener.take() is None and listener.peer is None)
    assert listener.connect() is None
    again = Line(tmp_path, push.packets)
    assert listener.connect() is not None
    wait_until(lambda: again.feed._period_s > 0.0)
    again.feed.close()


def test_the_feed_of_a_killed_driver_is_replaced(tmp_path, push):
    stale = Line(tmp_path, push.packets)
    assert (tmp_path / FEED).exists()
    Line(tmp_path, push.packets).feed.close()
    stale.feed.close()


def test_lines_tell_the_same(line, listener):
    hear(listener, line)
    writer, said, pictures = LineWriter(), [], []
    for i, state in look_on(line, listener):
        said += writer.write(read_head(state), 0.01 * i)
        pictures.append("\n".join(draw_picture(read_head(state))))
    assert said[0] == "driver: running, profile mine, layer base, source SIMULATED sim:push"
    assert any(each.startswith("hand: Push right") for each in said)
    ignored = [each for each in said if each.startswith("ignored: ")]
    assert len(ignored) == 1
    assert ", because lasted" in ignored[0]
    assert said.count("hand: At rest") <= 2
    assert any("Push right" in each and "█" in each for each in pictures)
    json.dumps(said)
