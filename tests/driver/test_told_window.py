"""The service follows the windows that the session of the person at the machine tells."""

import pytest

from neurotouch_hid.driver.told_window import LEASE_S, MAX_CHARACTERS, ToldWindow
from neurotouch_hid.errors import DriverError
from tests.waiting import wait_until

PERSON, OTHER = 1001, 1002
GAME = {"profile": "racing", "window": "supertuxkart is in front (sway)"}


class Service:
    """What a told window sees of a service: who sits there, its profiles, the time."""

    def __init__(self) -> None:
        self.seated, self.now_s = PERSON, 0.0
        self.followed: list[str | None] = []
        self.window = ToldWindow(
            lambda uid: uid == self.seated, self.followed.append, lambda: self.now_s
        )


@pytest.fixture
def service():
    made = Service()
    yield made
    made.window.close()


def test_what_the_person_at_the_machine_tells_counts(service):
    service.window.tell(PERSON, GAME)
    service.window.tell(PERSON, GAME)  # said again: nothing is released
    assert service.followed == ["racing"]
    assert service.window.describe() == GAME["window"]
    service.window.tell(PERSON, {**GAME, "profile": None})
    assert service.followed == ["racing", None]


def test_nobody_else_is_believed(service):
    service.window.tell(PERSON, GAME)
    with pytest.raises(DriverError, match="that is not you"):
        service.window.tell(OTHER, {**GAME, "profile": "mouse"})
    assert service.followed == ["racing"]
    assert service.window.describe() == GAME["window"]


def test_who_leaves_the_seat_is_forgotten(service):
    service.window.tell(PERSON, GAME)
    service.seated = OTHER
    wait_until(lambda: service.followed[-1] is None)
    assert "supertuxkart" not in service.window.describe()


def test_a_session_that_has_ended_is_forgotten(service):
    service.window.tell(PERSON, GAME)
    service.now_s = LEASE_S - 1
    service.window.check()
    assert service.followed == ["racing"]
    service.now_s = LEASE_S + 1
    service.window.check()
    assert service.followed == ["racing", None]


@pytest.mark.parametrize(
    "wrong",
    [
        {},
        {"profile": "../secret", "window": ""},
        {"profile": ["racing"], "window": ""},
        {"profile": "racing", "window": None},
        {"profile": "racing"},
    ],
)
def test_what_is_no_name_changes_nothing(service, wrong):
    with pytest.raises(DriverError, match="A profile's name"):
        service.window.tell(PERSON, wrong)
    assert service.followed == []


def test_what_is_shown_is_short_and_steers_no_terminal(service):
    service.window.tell(PERSON, {**GAME, "window": "\x1b[2J" + "x" * 10_000})
    assert len(service.window.describe()) <= MAX_CHARACTERS + 10
    assert "\x1b" not in service.window.describe()
