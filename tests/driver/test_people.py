"""Whose settings a service plays: those of the person at the machine, and of nobody else."""

import errno
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from neurotouch_hid.driver.chosen import Chosen, load_chosen
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.people import MAX_PROFILES, People
from neurotouch_hid.driver.profile_watch import ProfileWatch
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.errors import DriverError
from neurotouch_hid.players import find_machine_folder
from tests.driver.test_commands import make_commands
from tests.driver.test_profile_watch import Driver
from tests.processes import run_command
from tests.waiting import wait_until

ANNA, BEN = 61001, 61002


def make_profile(name: str, button: str) -> str:
    return f"version: 1\nname: {name}\nbindings:\n  - {{when: pinch, do: {{button: {button}}}}}\n"


def make_settings(button: str, *, user: str | None = "version: 1\nslots: [mine]\n") -> dict:
    return {
        "folder": "/home/her/.config/neurotouch",
        "user": user,
        "profiles": {"mine": make_profile("mine", button)},
    }


@pytest.fixture
def seated() -> list[int]:
    """Who is at the machine; tests change it."""
    return []


@pytest.fixture
def people(tmp_path, seated) -> People:
    return People(tmp_path / "people", find_seated=lambda: seated)


@pytest.fixture
def machine(tmp_path, monkeypatch) -> Path:
    """The administrator's settings, as a service finds them."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "etc"))
    folder = tmp_path / "etc/neurotouch"
    monkeypatch.setenv("CONFIGURATION_DIRECTORY", str(folder))
    (folder / "profiles").mkdir(parents=True)
    (folder / "profiles/kiosk.yaml").write_text(make_profile("kiosk", "start"))
    return folder


class Service(Driver):
    """A driver of the harness that plays for people."""

    def __init__(self, people: People, default: str) -> None:
        super().__init__(default)
        self.watch.close()
        chosen = Chosen(default, self.pipeline.mapping.profile, self.control.user)
        surroundings = Surroundings(announce=self.said.append, people=people, default=default)
        self.watch = ProfileWatch(chosen, self.control, surroundings, lambda new: None)
        self._commands = make_commands(self.control, self.watch, people=people)

    def ask(self, uid: int, **question) -> dict:
        return self._commands.answer(question, uid)

    @property
    def plays(self) -> set[str]:
        return {button.rpartition(".")[2].lower() for button in self.buttons}


@pytest.fixture
def service(machine, people):
    service = Service(people, "kiosk")
    yield service
    service.close()


def test_a_person_s_settings_act_at_once_and_go_with_the_person(service, seated):
    assert service.plays == {"start"}
    seated[:] = [ANNA]
    answer = service.ask(ANNA, command="settings", **make_settings("a"))
    assert answer["ok"], answer
    assert answer["profile"] == "mine"
    service.until(lambda: service.plays == {"a"})
    seated[:] = [BEN]  # has handed nothing over: never hers
    service.until(lambda: service.plays == {"start"})
    service.ask(BEN, command="settings", **make_settings("b"))
    service.until(lambda: service.plays == {"b"})
    seated[:] = []
    service.until(lambda: service.plays == {"start"})
    seated[:] = [ANNA]  # kept, and nothing needs to be sent again
    service.until(lambda: service.plays == {"a"})


def test_a_save_changes_what_plays_and_the_file_is_the_person_s(service, seated):
    seated[:] = [ANNA]
    service.ask(ANNA, command="settings", **make_settings("a"))
    assert service.watch.file == "/home/her/.config/neurotouch/profiles/mine.yaml"
    service.ask(ANNA, command="settings", **make_settings("x"))
    service.until(lambda: service.plays == {"x"})


def test_what_does_not_concern_the_active_profile_releases_nothing(service, seated):
    seated[:] = [ANNA]
    service.ask(ANNA, command="settings", **make_settings("a"))
    service.until(lambda: service.plays == {"a"})
    more = make_settings("a")
    more["profiles"]["other"] = make_profile("other", "b")
    again = "The profile 'mine' has been reloaded."
    assert service.ask(ANNA, command="settings", **more)["profile"] == "mine"
    assert again not in service.said
    assert service.ask(ANNA, command="reload")["ok"]
    service.until(lambda: again in service.said)


def test_who_is_not_at_the_machine_is_refused_and_nothing_changes(service, seated, people):
    seated[:] = [ANNA]
    service.ask(ANNA, command="settings", **make_settings("a"))
    for uid in (BEN, 0):
        refused = service.ask(uid, command="settings", **make_settings("b"))
        assert not refused["ok"]
        assert "not you" in refused["error"]
    service.until(lambda: service.plays == {"a"})
    seated[:] = [ANNA, BEN]  # two seats and one gel: the first seat counts
    assert not service.ask(BEN, command="settings", **make_settings("b"))["ok"]
    assert people.find_present().uid == ANNA


def test_a_broken_profile_never_leaves_the_one_of_the_person_before(service, seated):
    seated[:] = [ANNA]
    service.ask(ANNA, command="settings", **make_settings("a"))
    broken = make_settings("b")
    broken["profiles"]["mine"] = "version: 1\nname: mine\nbindings: 5\n"
    seated[:] = [BEN]
    service.ask(BEN, command="settings", **broken)
    service.until(lambda: service.plays == {"start"})  # the machine's
    mended = service.ask(BEN, command="settings", **make_settings("b"))
    assert mended["profile"] == "mine"
    service.until(lambda: service.plays == {"b"})


def test_a_broken_machine_too_leaves_the_shipped_default(service, seated, machine):
    seated[:] = [ANNA]
    service.ask(ANNA, command="settings", **make_settings("a"))
    (machine / "profiles/kiosk.yaml").write_text("nonsense")
    seated[:] = [BEN]
    service.until(lambda: service.pipeline.mapping.profile.name == "default")


def test_without_values_of_one_s_own_the_machine_s_apply(machine, people, seated):
    (machine / "user.yaml").write_text("version: 1\nfilter: strong\n")
    seated[:] = [ANNA]
    people.keep(ANNA, make_settings("a", user=None))
    chosen = load_chosen(people.find_present(), "kiosk", 1)
    assert (chosen.name, chosen.user.filter) == ("kiosk", "strong")
    people.keep(ANNA, make_settings("a", user="version: 1\nfilter: light\n"))
    chosen = load_chosen(people.find_present(), "kiosk", 1)
    assert (chosen.name, chosen.user.filter) == ("kiosk", "light")  # no favourite: the machine's
    people.keep(ANNA, make_settings("a"))
    assert load_chosen(people.find_present(), "kiosk", 1).name == "mine"


def test_what_was_taken_away_is_gone_and_with_everything_the_person(people, seated, tmp_path):
    seated[:] = [ANNA]
    people.keep(ANNA, make_settings("a"))
    people.keep(ANNA, {"folder": "/x", "user": None, "profiles": {"other": "version: 1\n"}})
    kept = sorted(path.name for path in (tmp_path / f"people/{ANNA}").rglob("*") if path.is_file())
    assert kept == ["origin", "other.yaml"]
    people.keep(ANNA, {"folder": "/x", "user": None, "profiles": {}})
    assert people.find_present() is None


@pytest.mark.parametrize(
    "wrong",
    [
        {"folder": 5, "user": None, "profiles": {}},
        {"folder": "relative", "user": None, "profiles": {}},
        {"folder": "/x", "user": None, "profiles": []},
        {"folder": "/x", "user": 5, "profiles": {}},
        {"folder": "/x", "user": None, "profiles": {"../../etc/passwd": "a"}},
        {"folder": "/x", "user": None, "profiles": {"a/b": "a"}},
        {"folder": "/x", "user": None, "profiles": {"mine": "x" * 70_000}},
        {"folder": "/x", "user": None, "profiles": {"mine": "\udc80"}},
        {"folder": "/x", "user": None, "profiles": {f"p{i}": "" for i in range(MAX_PROFILES + 1)}},
    ],
)
def test_what_are_no_settings_changes_nothing(people, seated, tmp_path, wrong):
    seated[:] = [ANNA]
    people.keep(ANNA, make_settings("a"))
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.yaml")}
    with pytest.raises(DriverError):
        people.keep(ANNA, wrong)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.yaml")} == before


@pytest.mark.parametrize("path", ["/etc/shadow", "../people/61002/profiles/mine.yaml", "x.yaml"])
def test_the_service_reads_no_file_that_a_guest_names(service, seated, path):
    seated[:] = [ANNA]
    refused = service.ask(ANNA, command="use", profile=path)
    assert not refused["ok"]
    assert "by name" in refused["error"]


def test_the_machine_s_profiles_are_everybody_s(machine, people, seated):
    assert find_machine_folder() == machine
    seated[:] = [ANNA]
    people.keep(ANNA, make_settings("a", user="version: 1\nslots: [kiosk]\n"))
    assert load_chosen(people.find_present(), None, 1).name == "kiosk"


# Another user, who may read where this Python is, and no more than that.
AS_ANNA = (
    "setpriv",
    f"--reuid={ANNA}",
    f"--regid={ANNA}",
    "--clear-groups",
    "--inh-caps=+dac_read_search",
    "--ambient-caps=+dac_read_search",
)


@pytest.mark.skipif(os.getuid() != 0, reason="only root becomes other people")
def test_a_command_of_a_real_person_changes_what_the_service_plays(service, seated, people):
    """Another user's process, this one's socket, and the kernel says who asks."""
    folder = Path(f"/tmp/nt-people-{os.getpid()}")  # a folder that others can reach
    home = folder / "home"
    try:
        home.mkdir(parents=True)
        os.chown(home, ANNA, ANNA)
        folder.chmod(0o755)
        with ControlSocket(folder / "run", lambda: seated) as socket:
            socket.serve(service._commands.answer)
            seated[:] = [ANNA]

            def save(*command: str) -> dict:
                done = run_command(
                    *AS_ANNA,
                    sys.executable,
                    "-m",
                    "neurotouch_hid",
                    "profile",
                    *command,
                    "--json",
                    env={
                        **os.environ,
                        "XDG_CONFIG_HOME": str(home),
                        "RUNTIME_DIRECTORY": str(folder / "run"),
                    },
                    cwd="/",
                )
                return json.loads(done.stdout)

            save("new", "mine", "--template", "push-only")
            used = save("use", "mine")
            assert used["status"] == "OK", used
            assert "'mine' is now active" in used["notes"][0]
            service.until(lambda: service.watch.name == "mine")
            changed = save("set", "user", "filter", "strong")
            assert "It applies now" in changed["notes"][0], changed
            wait_until(lambda: service.control.user.filter == "strong")
            seated[:] = [BEN, ANNA]  # somebody else sits at the first seat, she at another one
            late = save("set", "user", "filter", "light")
            assert late["status"] == "WARNING", late
            assert "not you" in late["notes"][0]
            assert service.control.user.filter != "light"
    finally:
        subprocess.run(["rm", "-rf", folder], check=True)


def test_a_full_disk_keeps_what_was_there_and_says_what_to_do(people, seated, monkeypatch):
    def fail(path, content):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    seated.append(ANNA)
    people.keep(ANNA, make_settings("a"))
    monkeypatch.setattr("neurotouch_hid.driver.people.write_whole", fail)
    with pytest.raises(DriverError, match="No space left on device") as refused:
        people.keep(ANNA, make_settings("b"))
    assert refused.value.hint == "Make room on this disk, then try again."
    kept = people.find_present().folder / "profiles/mine.yaml"
    assert kept.read_text() == make_profile("mine", "a")
