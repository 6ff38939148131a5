"""``neurotouch setup --windows`` says what it will do, does it, and leaves no trace afterwards."""

import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from neurotouch_hid.cli import setup
from neurotouch_hid.errors import NeuroTouchError

EXTENSION = ".local/share/gnome-shell/extensions/windows@neurotouch-hid"
SCRIPT = ".local/share/neurotouch/kwin-windows.js"

# Keeps GNOME's lists in a file of lines 'name=value', as the real one keeps them in a database.
GSETTINGS = f"""#!{sys.executable}
import sys
from pathlib import Path
lists = Path(__file__).with_name("lists")
kept = dict(line.split("=", 1) for line in lists.read_text().splitlines())
action, schema, name, *value = sys.argv[1:]
assert schema == "org.gnome.shell"
if action == "get":
    print(kept.get(name, "@as []"))
elif action == "set":
    kept[name] = value[0]
else:
    kept.pop(name, None)
lists.write_text("".join(f"{{key}}={{kept[key]}}\\n" for key in kept))
"""


@pytest.fixture
def home(tmp_path, monkeypatch) -> Path:
    """The home of a person under Wayland, with GNOME's program for settings."""
    for name in ("XDG_DATA_HOME", "DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-0")
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    program = tmp_path / "bin/gsettings"
    program.parent.mkdir()
    program.write_text(GSETTINGS)
    program.chmod(0o755)
    (tmp_path / "bin/lists").touch()
    return tmp_path


def run(desktop: str, *options: str, answer: str = "") -> Result:
    return CliRunner().invoke(
        setup.command, ["--windows", *options], input=answer, env={"XDG_CURRENT_DESKTOP": desktop}
    )


def list_files(home: Path) -> set[str]:
    found = {str(path.relative_to(home)) for path in home.rglob("*") if path.is_file()}
    return found - {"bin/gsettings", "bin/lists"}


def read_lists(home: Path) -> str:
    return (home / "bin/lists").read_text()


def test_kde_gets_one_file_after_asking(home):
    for options, answer in ((["--dry-run"], ""), ([], "n\n")):
        said = run("KDE", *options, answer=answer)
        assert SCRIPT in said.output
        assert not list_files(home)
    said = run("KDE", answer="y\n")
    assert said.exit_code == 0
    assert "titles" in said.output
    assert list_files(home) == {SCRIPT}
    assert "io.github.neurotouch_hid.Windows" in (home / SCRIPT).read_text()
    assert run("KDE", "--uninstall", "--yes").exit_code == 0
    assert not list_files(home)
    assert not (home / SCRIPT).parent.exists()


@pytest.mark.parametrize("before", ["", "enabled-extensions=['other@example.org']\n"])
def test_gnome_gets_the_extension_and_other_extensions_stay(home, before):
    (home / "bin/lists").write_text(before)
    said = run("ubuntu:GNOME", "--yes")
    assert said.exit_code == 0, said.output
    assert "Log out" in said.output
    assert list_files(home) == {f"{EXTENSION}/metadata.json", f"{EXTENSION}/extension.js"}
    assert "'windows@neurotouch-hid']" in read_lists(home)
    run("ubuntu:GNOME", "--yes")
    assert read_lists(home).count("windows@") == 1
    said = run("ubuntu:GNOME", "--uninstall", "--yes")
    assert said.exit_code == 0, said.output
    assert not list_files(home)
    assert not (home / EXTENSION).exists()
    assert read_lists(home) == before


def test_extension_that_was_switched_off_by_hand_leaves_no_trace_either(home):
    run("GNOME", "--yes")
    (home / "bin/lists").write_text("disabled-extensions=['windows@neurotouch-hid', 'x@y']\n")
    run("GNOME", "--uninstall", "--yes")
    assert read_lists(home) == "disabled-extensions=['x@y']\n"


def test_everything_is_removed_on_any_desktop(home):
    run("KDE", "--yes")
    run("GNOME", "--yes")
    run("sway", "--uninstall", "--yes")
    assert not list_files(home)
    assert "nothing here" in run("sway", "--uninstall", "--yes").output


def test_uninstalling_the_rules_says_that_the_desktop_keeps_its_part(home):
    run("KDE", "--yes")
    said = CliRunner().invoke(setup.command, ["--uninstall", "--dry-run"])
    assert "setup --windows --uninstall" in said.output


def test_other_desktops_need_nothing(home):
    said = run("niri", "--yes")
    assert isinstance(said.exception, NeuroTouchError)
    assert "needs nothing" in said.exception.message


def test_without_a_desktop_it_says_where_to_type_it(home, monkeypatch):
    monkeypatch.delenv("WAYLAND_DISPLAY")
    said = run("KDE", "--yes")
    assert isinstance(said.exception, NeuroTouchError)
    assert "No desktop" in said.exception.message


def test_missing_program_of_gnome_is_named(home):
    (home / "bin/gsettings").unlink()
    said = run("GNOME", "--yes")
    assert isinstance(said.exception, NeuroTouchError)
    assert "gsettings" in said.exception.message


def test_missing_library_is_named(home, monkeypatch):
    assert "pip install" not in run("KDE", "--yes").output
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert "pip install 'neurotouch-hid[desktop]'" in run("KDE", "--yes").output
