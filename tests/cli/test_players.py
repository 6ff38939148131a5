"""Several gels: a driver, a pad and a profile for each player; orders reach all of them."""

import json
import subprocess
from contextlib import ExitStack
from pathlib import Path

import pytest

from neurotouch_hid import client
from neurotouch_hid.cli.shared.send_without_click import send_command
from neurotouch_hid.cli.shared.silent_driver import open_silent_driver
from neurotouch_hid.cli.ui.welcome import welcome
from neurotouch_hid.client import ask
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.errors import DriverError, NotRunningError
from neurotouch_hid.players import find_runtime_folder
from neurotouch_hid.profile.editing import hand_over_saved
from tests.processes import PROGRAM, make_environment, run_neurotouch
from tests.waiting import wait_until


class Players:
    """Two drivers that run beside each other, with other profiles."""

    def __init__(self, folder: Path, closing: ExitStack) -> None:
        self.environment = make_environment(folder)
        for player, profile in ((1, "spacecraft"), (2, "racing")):
            options = ["--source", "sim:rest", "--device", "memory", "--show", "nothing"]
            log = closing.enter_context((folder / f"{player}.txt").open("w+"))
            process = subprocess.Popen(
                [*PROGRAM, "run", *options, "--player", str(player), "--profile", profile],
                stderr=log,
                env=self.environment,
            )
            closing.callback(process.wait)
            closing.callback(process.terminate)
            wait_until(lambda log=log.name: "Gamepad ready" in Path(log).read_text())

    def call(self, *arguments: str, player: str | None = None) -> subprocess.CompletedProcess:
        named = {} if player is None else {"NEUROTOUCH_PLAYER": player}
        return run_neurotouch(*arguments, code=None, env={**self.environment, **named})

    def states(self) -> list[str]:
        said = (self.call("status", "--json", player=player) for player in "12")
        return [json.loads(each.stdout)["state"] for each in said]

    def wait_for(self, *states: str) -> None:
        """An order to a driver that is held up just then is obeyed a moment later."""
        wait_until(lambda: self.states() == list(states), self.states)


@pytest.fixture(scope="module")
def players(tmp_path_factory):
    with ExitStack() as closing:
        yield Players(tmp_path_factory.mktemp("players"), closing)


def test_each_has_a_profile_of_their_own(players):
    said = [json.loads(players.call("status", "--json", player=who).stdout) for who in "12"]
    assert [each["profile"] for each in said] == ["spacecraft", "racing"]
    assert said[0]["pid"] != said[1]["pid"]


def test_an_order_reaches_everybody(players):
    done = players.call("panic")
    assert done.returncode == 0
    assert [line[:9] for line in done.stdout.splitlines()] == ["Player 1:", "Player 2:"]
    players.wait_for("panic", "panic")
    players.call("resume")
    players.wait_for("running", "running")


def test_an_order_to_one_does_not_reach_the_other(players):
    players.call("pause", player="2")
    players.wait_for("running", "paused")
    assert players.call("pause", player="2").stdout.startswith("Your driver: Already paused")
    players.call("resume", player="2")
    players.wait_for("running", "running")


def test_there_is_no_fifth_player(players):
    done = players.call("status", player="5")
    assert done.returncode == 8
    assert "NEUROTOUCH_PLAYER must be one of 1, 2, 3, 4" in done.stderr


def test_nobody_takes_the_place_of_a_player_who_plays(players):
    done = players.call("run", "--source", "sim:rest", "--device", "memory", "--player", "2")
    assert done.returncode == 75
    only = "NEUROTOUCH_PLAYER=2 neurotouch"
    assert f"Fix: Ask it: {only} status. End it: {only} stop" in done.stderr
    first = players.call("run", "--source", "sim:rest", "--device", "memory")
    assert "End it: NEUROTOUCH_PLAYER=1 neurotouch stop" in first.stderr


def test_a_demo_is_that_of_the_environments_player(players):
    done = players.call("demo", "--seconds", "1", "--no-page", player="2")
    assert (done.returncode, "NEUROTOUCH_PLAYER=2 neurotouch stop" in done.stderr) == (75, True)
    done = players.call("demo", "--seconds", "1", "--no-page", player="3")
    assert done.returncode == 0, done.stderr


def test_who_is_measured_is_the_environments_player(tmp_path, monkeypatch):
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "2")
    assert open_silent_driver("sim:push").options.player == 2


@pytest.fixture
def second(tmp_path, monkeypatch):
    """Only player 2 plays; the list has the commands that reach that driver."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    heard = []

    def answer(question, _user):
        heard.append(question["command"])
        return {"ok": True, "text": "Done.", "profile": "racing"}

    with ControlSocket(find_runtime_folder(2)) as control:
        control.serve(answer)
        yield heard


def test_a_player_who_does_not_play_is_told_who_does(second, monkeypatch):
    with pytest.raises(NotRunningError) as caught:
        ask("status")
    assert caught.value.hint == (
        "The driver of player 2 runs. For this one: NEUROTOUCH_PLAYER=2 neurotouch COMMAND"
    )
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "2")
    assert ask("status")["ok"]


def test_the_welcome_knows_drivers_that_it_cannot_describe(second, capsys, monkeypatch):
    welcome()
    assert "The driver of player 2 runs. For this one: " in capsys.readouterr().out
    monkeypatch.setattr(client, "ask_status", _refuse)
    welcome()
    said = "The driver does not answer.\nFix: Try again in a moment.\n"
    assert capsys.readouterr().out == f"{said}All commands: neurotouch --help\n"


def _refuse():
    raise DriverError("The driver does not answer.", hint="Try again in a moment.")


def test_an_order_names_the_only_player_it_has_reached(second, capsys, monkeypatch):
    assert send_command("pause") == 0
    assert capsys.readouterr().out == "Player 2: Done.\n"
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "2")
    assert send_command("pause") == 0
    assert capsys.readouterr().out == "Your driver: Done.\n"


def test_a_wrong_variable_stops_no_panic(second, capsys, monkeypatch):
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "two")
    assert send_command("panic") == 0
    assert second == ["panic"]
    assert send_command("resume") == 8
    assert "Fix: For the first player: unset NEUROTOUCH_PLAYER" in capsys.readouterr().err


def test_own_values_are_not_said_to_play_with_another_player(second):
    """Each player has a file of them; profiles are for all."""
    assert hand_over_saved("user").text == "No driver is running; it applies from the next start."
    assert second == []
    assert hand_over_saved("racing").text == "It applies now."
    assert second == ["settings"]


@pytest.mark.parametrize("given", ["/run/neurotouch", "/run/neurotouch-2"])
def test_another_players_service_lies_where_orders_look_for_it(monkeypatch, given):
    """Its unit calls its folder so already."""
    monkeypatch.setenv("RUNTIME_DIRECTORY", given)
    monkeypatch.setenv("NEUROTOUCH_PLAYER", "2")
    assert find_runtime_folder() == Path("/run/neurotouch-2")


@pytest.mark.parametrize("refusing", [1, 2])
def test_a_driver_that_refuses_does_not_keep_the_panic_from_the_others(
    tmp_path, monkeypatch, refusing
):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    heard = []

    def answer(question, player):
        heard.append((question["command"], player))
        if player == refusing:
            return {"ok": False, "error": "The pipeline has stopped."}
        return {"ok": True, "text": "Stopped."}

    with ExitStack() as stack:
        for player in (1, 2):
            control = stack.enter_context(ControlSocket(find_runtime_folder(player)))
            control.serve(lambda question, _uid, player=player: answer(question, player))
        assert send_command("panic") == 8
    assert sorted(heard) == [("panic", 1), ("panic", 2)]
