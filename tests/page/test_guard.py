"""Tokens, tickets, names and limits at their bounds, by a clock of the test."""

from types import SimpleNamespace

import pytest

from neurotouch_hid.errors import PageError
from neurotouch_hid.page import guard
from neurotouch_hid.page.guard import Guard, Rate, Waiting, make_ticket, make_token

TOKEN = "abcdefghijklmnopqrst_-"


@pytest.fixture
def clock(monkeypatch):
    clock = SimpleNamespace(now_s=100.0)
    monkeypatch.setattr(guard, "time", SimpleNamespace(monotonic=lambda: clock.now_s))
    return clock


@pytest.mark.parametrize("token", [TOKEN[:-1], TOKEN[:-1] + "+", TOKEN + "\n", ""])
def test_a_weak_token_is_refused(token):
    with pytest.raises(PageError, match="at least 22"):
        Guard(token)


def test_every_made_token_is_another_one_and_strong_enough():
    tokens = {make_token() for _ in range(20)}
    assert len(tokens) == 20
    assert all(Guard(token).knows(token) for token in tokens)


@pytest.mark.parametrize("said", [None, 7, "", TOKEN[:-1], TOKEN + "x", TOKEN.upper(), "\ud800"])
def test_only_the_token_is_known(said):
    assert Guard(TOKEN).knows(TOKEN)
    assert not Guard(TOKEN).knows(said)


def test_a_ticket_opens_for_a_minute(clock):
    ticket, at = make_ticket(TOKEN), Guard(TOKEN)
    assert at.accepts(ticket)
    clock.now_s = 160.0
    assert at.accepts(ticket)
    clock.now_s = 160.001
    assert not at.accepts(ticket)


def test_no_other_ticket_opens(clock):
    end, sign = make_ticket(TOKEN).split("-")
    assert (end, len(sign)) == ("160", 64)
    wrong = [
        make_ticket(TOKEN.upper()),
        f"161-{sign}",
        f"0{end}-{sign}",
        f"{end}-{sign[:-1]}",
        f"{end}-",
        end,
        "",
        f"{'1' * 13}-{sign}",
        f"{end}-{sign[:-1]}é",
        f"١٦٠-{sign}",
        f"-{end}-{sign}",
    ]
    assert [ticket for ticket in wrong if Guard(TOKEN).accepts(ticket)] == []


def test_the_page_has_the_names_of_this_machine_and_of_the_given_address():
    here, there, six = Guard(TOKEN), Guard(TOKEN, "10.0.0.7"), Guard(TOKEN, "fe80::1")
    assert here.hosts == here.origins == frozenset()
    for each in (here, there, six):
        each.open_port(8000)
    local = {"localhost:8000", "127.0.0.1:8000", "[::1]:8000"}
    assert here.hosts == local
    assert there.hosts == {*local, "10.0.0.7:8000"}
    assert six.hosts == {*local, "[fe80::1]:8000"}
    assert there.origins == {f"http://{host}" for host in there.hosts}
    assert here.link("game") == f"/game#k={TOKEN}"


@pytest.mark.parametrize("address", ["0.0.0.0", "::", "224.0.0.1", "localhost", ""])
def test_an_address_is_that_of_one_interface(address):
    with pytest.raises(PageError) as refused:
        Guard(TOKEN, address)
    assert "ip address" in refused.value.hint


def test_a_client_may_send_so_many_at_once_and_then_so_many_a_second(clock):
    rate = Rate(4.0)
    assert [rate.allows() for _ in range(5)] == [True] * 4 + [False]
    clock.now_s += 0.25
    assert [rate.allows() for _ in range(2)] == [True, False]
    clock.now_s += 100.0  # silence saves nothing up
    assert [rate.allows() for _ in range(5)] == [True] * 4 + [False]


class Line:
    """A connection that a test looks at."""

    is_dropped = False

    def drop(self):
        self.is_dropped = True


def test_where_too_many_wait_the_oldest_of_the_crowd_goes():
    waiting, lines = Waiting(3), [Line() for _ in range(6)]
    for line, address in zip(lines[:4], ("owner", "crowd", "crowd", "crowd"), strict=True):
        waiting.add(line, address)
    assert [line.is_dropped for line in lines] == [False, True] + [False] * 4
    waiting.remove(lines[0])
    waiting.remove(lines[0])
    waiting.add(lines[4], "crowd")
    assert not lines[2].is_dropped
    waiting.add(lines[5], "owner")
    assert [line.is_dropped for line in lines] == [False, True, True, False, False, False]
