"""What is saved holds within a second; what is wrong changes nothing and says why."""

import os
import threading
import time
from pathlib import Path

import pytest

from neurotouch_hid.driver.chosen import Chosen
from neurotouch_hid.driver.profile_watch import ProfileWatch
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.errors import ProfileError
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import no_gesture
from neurotouch_hid.profile import UserSettings, load_profile
from neurotouch_hid.runtime import Pipeline, PipelineControl
from tests.waiting import wait_until

LIMIT_S = 60.0
"""Far more than the second that is promised: tests are not timed."""


def text(button: str, more: str = "") -> str:
    return (
        f"version: 1\nname: mine\n{more}bindings:\n  - {{when: pinch, do: {{button: {button}}}}}\n"
    )


class Driver:
    """A line that turns without slices, with a watch over its profile."""

    def __init__(self, name: str, user: UserSettings | None = None) -> None:
        profile = load_profile(name)
        user = user or UserSettings()
        self.pipeline = Pipeline.build(profile, GestureConfig(), user=user)
        self.control = PipelineControl(self.pipeline, user)
        self.said: list[str] = []
        self.prepared: list[str] = []
        self._done = threading.Event()
        self._line = threading.Thread(target=self._turn)
        self._line.start()
        self.watch = ProfileWatch(
            Chosen(name, profile, user),
            self.control,
            Surroundings(announce=self.said.append),
            lambda new: self.prepared.append(new.name),
        )

    def _turn(self) -> None:
        t_us = 0
        while not self._done.wait(0.01):
            self.control.apply_commands()
            t_us += 10_000
            self.pipeline.mapping.update(no_gesture(t_us))

    def close(self) -> None:
        self.watch.close()
        self._done.set()
        self._line.join()

    @property
    def buttons(self) -> set[str]:
        bindings = self.pipeline.mapping.profile.all_layers[0].bindings
        return {str(binding.do.button) for binding in bindings}

    def until(self, happened) -> None:
        wait_until(happened, lambda: self.said)


@pytest.fixture
def config(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    folder = tmp_path / "neurotouch" / "profiles"
    folder.mkdir(parents=True)
    (folder / "mine.yaml").write_text(text("a"))
    return folder.parent


@pytest.fixture
def file(config) -> Path:
    return config / "profiles" / "mine.yaml"


@pytest.fixture
def driver(file):
    driver = Driver("mine")
    yield driver
    driver.close()


def write(file: Path, content: str) -> None:
    file.write_text(content)


def replace(file: Path, content: str) -> None:
    """As careful editors save."""
    new = file.with_suffix(".new")
    new.write_text(content)
    new.replace(file)


@pytest.mark.parametrize("save", [write, replace])
def test_saved_profile_holds(driver, file, save):
    save(file, text("b"))
    driver.until(lambda: driver.buttons == {"b"})
    driver.until(lambda: driver.said == ["The profile 'mine' has been reloaded."])
    assert driver.prepared == ["mine"]


def spoil_by_text(file):
    file.write_text(text("bb"))


def spoil_by_truncating(file):
    os.truncate(file, 12)


def spoil_by_removing(file):
    file.unlink()


def spoil_by_directory(file):
    file.unlink()
    file.mkdir()


def spoil_by_fifo(file):
    file.unlink()
    os.mkfifo(file)


def spoil_by_link_to_itself(file):
    file.unlink()
    file.symlink_to(file)


def spoil_by_size(file):
    file.write_text("#" * 70_000)


@pytest.mark.parametrize(
    "spoil",
    [
        spoil_by_text,
        spoil_by_truncating,
        spoil_by_removing,
        spoil_by_directory,
        spoil_by_fifo,
        spoil_by_link_to_itself,
        spoil_by_size,
    ],
)
def test_spoiled_file_keeps_the_old_profile_and_says_why_once(driver, file, spoil):
    spoil(file)
    driver.until(lambda: driver.said)
    assert driver.said[0].startswith("The profile 'mine' goes on as it was: ")
    assert len(driver.control.status()["errors"]) == 1
    assert driver.buttons == {"a"}
    with pytest.raises(ProfileError):
        driver.watch.reload().result(LIMIT_S)  # the watch is alive, and the file still wrong
    assert len(driver.said) == 2
    if file.is_dir():
        file.rmdir()
    file.unlink(missing_ok=True)
    file.write_text(text("x"))
    driver.until(lambda: driver.buttons == {"x"})


@pytest.mark.parametrize("mended", ["a", "x"])
def test_mended_mistake_is_taken_back(driver, file, mended):
    file.write_text(text("bb"))
    driver.until(lambda: driver.said)
    file.write_text(text(mended))
    driver.until(lambda: len(driver.said) == 2)
    how = "is in order again" if mended == "a" else "has been reloaded"
    assert driver.said[1] == f"The profile 'mine' {how}."
    driver.until(lambda: driver.buttons == {mended})
    assert driver.control.status()["errors"] == []


def test_folder_that_cannot_be_looked_into_keeps_the_old_profile_and_says_why(driver, config):
    """As in a home on another machine that does not answer."""
    away = config.with_name("away")
    config.rename(away)
    config.symlink_to("x" * 300)  # no folder has so long a name: whoever looks gets an error
    with pytest.raises(ProfileError, match="File name too long"):
        driver.watch.reload().result(LIMIT_S)
    config.unlink()
    away.rename(config)
    assert driver.watch.reload().result(LIMIT_S) == "mine"
    assert driver.said[0].startswith("The profile 'mine' goes on as it was: ")


def test_error_names_line_and_column(driver, file):
    file.write_text(text("bb"))
    driver.until(lambda: driver.said)
    assert "mine.yaml:4:" in driver.said[0]
    assert "did you mean" in driver.said[0]


def test_saved_base_of_a_profile_holds(config, file):
    base = config / "profiles" / "base.yaml"
    base.write_text(text("y").replace("mine", "base"))
    file.write_text("version: 1\nname: mine\nextends: [base]\n")
    driver = Driver("mine")
    try:
        replace(base, text("lb").replace("mine", "base"))
        driver.until(lambda: driver.buttons == {"lb"})
        base.write_text("version: 2\n")
        driver.until(lambda: len(driver.said) == 2)
        assert "'base' has errors" in driver.said[1]
        assert driver.buttons == {"lb"}
    finally:
        driver.close()


def test_person_changes_their_values(driver, config):
    before = driver.pipeline.mapping
    (config / "user.yaml").write_text("version: 1\nmirror: true\n")
    driver.until(lambda: driver.pipeline.mapping is not before)
    driver.until(lambda: driver.said)
    (config / "user.yaml").write_text("version: 1\nmirror: perhaps\n")
    driver.until(lambda: len(driver.said) == 2)
    assert "user.yaml:2" in driver.said[1]


def test_own_profile_that_hides_a_shipped_one_holds(config):
    driver = Driver("racing")
    try:
        write(config / "profiles" / "racing.yaml", text("guide").replace("mine", "racing"))
        driver.until(lambda: driver.pipeline.mapping.profile == load_profile("racing"))
        assert driver.buttons == {"guide"}
    finally:
        driver.close()


def test_comment_or_another_file_lets_go_of_nothing(driver, file):
    file.write_text("# a comment\n" + text("a"))
    (file.parent / "other.yaml").write_text("nonsense: [")
    time.sleep(1.0)  # four polls: nothing is to happen, so there is nothing to wait for
    assert driver.said == []
    assert driver.prepared == []


def test_use_goes_on_with_another_profile_which_is_then_watched(driver, file):
    other = file.with_name("other.yaml")
    other.write_text(text("x").replace("mine", "other"))
    assert driver.watch.use("other").result(LIMIT_S) == "other"
    driver.until(lambda: driver.buttons == {"x"})
    other.write_text(text("y").replace("mine", "other"))
    driver.until(lambda: driver.buttons == {"y"})
    assert driver.watch.name == "other"


def test_use_of_what_is_not_there_changes_nothing(driver):
    with pytest.raises(ProfileError, match="No profile is called 'nine'"):
        driver.watch.use("nine").result(LIMIT_S)
    assert driver.watch.reload().result(LIMIT_S) == "mine"


def test_next_goes_round_the_favourites(config):
    for name, button in (("one", "a"), ("two", "b")):
        (config / "profiles" / f"{name}.yaml").write_text(text(button).replace("mine", name))
    (config / "user.yaml").write_text("version: 1\nslots: [one, two]\n")
    driver = Driver("mine", UserSettings(slots=["one", "two"]))
    try:
        held = [driver.watch.next().result(LIMIT_S) for _ in range(3)]
        assert held == ["one", "two", "one"]
    finally:
        driver.close()


def test_application_has_its_profile_and_then_the_chosen_one_returns(driver):
    assert driver.watch.follow("racing").result(LIMIT_S) == "racing"
    assert driver.watch.follow(None).result(LIMIT_S) == "mine"
    driver.watch.use("flight")
    assert driver.watch.follow("racing").result(LIMIT_S) == "racing"
    assert driver.watch.follow(None).result(LIMIT_S) == "flight"


def test_sentences_are_said_in_order_and_before_the_end(file):
    driver = Driver("mine")
    for n in range(5):
        driver.watch.say(str(n))
    driver.close()
    assert driver.said == list("01234")
