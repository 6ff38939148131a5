"""The follower with a desktop that says what the test wants."""

import threading

from neurotouch_hid.desktop import Follower
from neurotouch_hid.errors import DesktopError
from tests.waiting import wait_until

LIMIT_S = 60.0


class Desktop:
    """A desktop of the test's making: ``front`` is the active window, or what goes wrong."""

    desktop = "Test"
    fd: int | None = None

    def __init__(self) -> None:
        self.front: tuple[str, ...] | DesktopError = ()
        self.closed = 0

    def names(self) -> tuple[str, ...]:
        if isinstance(self.front, DesktopError):
            raise self.front
        return self.front

    def close(self) -> None:
        self.closed += 1


def test_profile_follows_the_window_whatever_the_case_and_only_changes_are_told():
    desktop, wanted = Desktop(), []
    follower = Follower({"Game": "racing", "other": "racing"}, lambda: desktop, wanted.append)
    for front, told in [
        (("x", "GAME"), ["racing"]),
        (("other",), ["racing"]),
        ((), ["racing", None]),
        (("editor",), ["racing", None]),
        (("game",), ["racing", None, "racing"]),
    ]:
        desktop.front = front
        wait_until(lambda front=front: "/".join(front or ["no window"]) in follower.describe())
        wait_until(lambda told=told: wanted == told)
    follower.close()
    assert desktop.closed == 1


def test_desktop_that_goes_away_is_described_and_the_profile_stays():
    desktop, wanted = Desktop(), []
    desktop.front = ("game",)
    follower = Follower({"game": "racing"}, lambda: desktop, wanted.append)
    wait_until(lambda: wanted == ["racing"])
    desktop.front = DesktopError("The desktop is gone.")
    wait_until(lambda: "gone" in follower.describe())
    follower.close()
    assert wanted == ["racing"]


def test_desktop_that_hangs_does_not_hold_up_the_end():
    """As an X server far away whose network has gone."""
    asked, answer = threading.Event(), threading.Event()

    class Hanging(Desktop):
        def names(self) -> tuple[str, ...]:
            asked.set()
            answer.wait()
            return ()

    follower = Follower({"game": "racing"}, Hanging, print)
    assert asked.wait(LIMIT_S)
    closing = threading.Thread(target=follower.close)
    closing.start()
    closing.join(LIMIT_S)
    has_closed = not closing.is_alive()
    answer.set()
    closing.join()
    assert has_closed


def test_name_of_a_window_is_no_danger_to_a_terminal():
    desktop = Desktop()
    desktop.front = ("\x1b[2Jgame",)
    follower = Follower({}, lambda: desktop, print)
    wait_until(lambda: "game is in front (Test)" in follower.describe())
    follower.close()
    assert "\x1b" not in follower.describe()
