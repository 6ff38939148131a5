"""The Debian package's own files; the package itself is tried in tests/system."""

import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

from tests.processes import run_command

ROOT = Path(__file__).parents[2]
DEBIAN = ROOT / "packaging/debian"
LOCK = ROOT / "packaging/requirements.lock"
SCRIPTS = [*DEBIAN.glob("*.p*[mt]"), *DEBIAN.glob("*.p*inst"), ROOT / "packaging/build-deb.sh"]


def read_lock() -> dict[str, str]:
    """Each requirement that is locked, with its hashes."""
    text = LOCK.read_text().replace("\\\n", " ")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    return {normalize(re.split(r"[=\s;]", line)[0]): line for line in lines}


def normalize(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def test_every_dependency_is_locked_by_hash():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    locked = read_lock()
    wanted = {normalize(re.split(r"[\s<>=;\[]", each)[0]) for each in project["dependencies"]}
    assert wanted <= set(locked), "make lock"
    assert all("--hash=sha256:" in line for line in locked.values())


def test_the_lock_names_no_place_of_ours():
    assert "://" not in LOCK.read_text()


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_the_shell_reads_the_scripts(path):
    subprocess.run(["sh", "-n", str(path)], check=True)


def test_there_are_all_scripts():
    names = {path.suffix for path in SCRIPTS}
    assert {".postinst", ".prerm", ".postrm"} <= names


@pytest.mark.parametrize("name", ["postinst", "prerm", "postrm"])
def test_scripts_leave_alone_a_system_that_is_not_running(name):
    """In a chroot there is no systemd to talk to."""
    text = (DEBIAN / f"neurotouch-hid.{name}").read_text()
    before, _, after = text.partition("[ -d /run/systemd/system ]")
    assert "systemctl" not in before
    assert "udevadm" not in before
    assert "#DEBHELPER#" in text
    assert after


@pytest.mark.parametrize("name", ["postinst", "postrm"])
def test_scripts_ask_nothing_of_udev_where_it_does_not_run(name):
    """In a container there is systemd, but no udev: its refusal would end apt's work."""
    text = (DEBIAN / f"neurotouch-hid.{name}").read_text()
    before, _, after = text.partition("if udevadm control --ping 2>/dev/null; then\n")
    guarded, _, rest = after.partition("fi\n")
    assert "udevadm" not in before
    assert "udevadm trigger" in guarded
    assert "udevadm" not in rest


def test_what_is_installed_is_there():
    for line in (DEBIAN / "neurotouch-hid.install").read_text().splitlines():
        assert list(ROOT.glob(line.split()[0])), line


def test_the_unit_of_a_session_is_enabled_for_everybody_and_disabled_at_the_purge(tmp_path):
    if not shutil.which("dh_installsystemduser"):
        pytest.skip("debhelper is not installed")
    shutil.copytree(DEBIAN, tmp_path / "debian")
    (tmp_path / "debian/changelog").write_text(
        "neurotouch-hid (1) unstable; urgency=low\n\n  * Test.\n\n"
        " -- A <a@b.invalid>  Thu, 01 Jan 2026 00:00:00 +0000\n"
    )
    unit = ROOT / "packaging/systemd/neurotouch-session.service"
    place = "debian/neurotouch-hid/usr/lib/systemd/user"
    assert (
        f"packaging/systemd/{unit.name} usr/lib/systemd/user"
        in (DEBIAN / "neurotouch-hid.install").read_text().splitlines()
    )
    (tmp_path / place).mkdir(parents=True)
    shutil.copy(unit, tmp_path / place)
    for command in ("dh_installsystemduser", "dh_installdeb"):
        subprocess.run([command], cwd=tmp_path, check=True)
    made = tmp_path / "debian/neurotouch-hid/DEBIAN"
    assert re.search(rf"deb-systemd-helper --user enable .*{unit.name}", _read(made, "postinst"))
    assert re.search(rf"deb-systemd-helper --user purge .*{unit.name}", _read(made, "postrm"))


def _read(folder: Path, script: str) -> str:
    return (folder / script).read_text()


def test_the_launcher_starts_only_what_the_package_brought():
    first, *_, guard, last = (ROOT / "packaging/launcher.py").read_text().splitlines()
    assert first == "#!/usr/bin/python3 -I"  # nothing of the user's own
    assert (guard, last) == ('if __name__ == "__main__":', "    main()")


def test_the_manual_page_knows_every_command(tmp_path):
    from neurotouch_hid.cli.main import cli

    page = make_page()
    for name in cli.list_commands(None):
        assert f".SS neurotouch {name}" in page.replace("\\", "")


@pytest.mark.parametrize("which", ["neurotouch.1", "neurotouch-service.7"])
def test_manual_pages_are_sound(which, tmp_path):
    if not shutil.which("groff"):
        pytest.skip("groff is not installed")
    page = ROOT / "packaging/man" / which
    if which == "neurotouch.1":
        page = tmp_path / which
        page.write_text(make_page())
    done = run_command("groff", "-man", "-ww", "-z", "-Tutf8", "-k", page, code=None)
    assert done.stderr == ""


def test_the_page_of_the_service_knows_every_choice():
    from neurotouch_hid.driver.service_settings import ServiceSettings

    page = (ROOT / "packaging/man/neurotouch-service.7").read_text()
    for key in ServiceSettings.model_fields:
        assert f"{key}:" in page


@pytest.mark.parametrize(
    ("program", "arguments", "file"),
    [
        ("desktop-file-validate", (), "neurotouch-hid.desktop"),
        ("appstreamcli", ("validate", "--no-net"), "neurotouch-hid.metainfo.xml"),
    ],
)
def test_the_desktop_understands_its_files(program, arguments, file):
    if not shutil.which(program):
        pytest.skip(f"{program} is not installed")
    run_command(program, *arguments, ROOT / "packaging/desktop" / file)


def test_the_desktop_entry_starts_commands_that_there_are():
    from neurotouch_hid.cli.main import cli

    text = (ROOT / "packaging/desktop/neurotouch-hid.desktop").read_text()
    started = re.findall(r"^Exec=neurotouch (\S+)", text, re.MULTILINE)
    assert len(started) == 4
    assert set(started) <= set(cli.list_commands(None))


def make_page() -> str:
    import sys

    done = run_command(
        sys.executable, ROOT / "packaging/man/make_page.py", cwd=ROOT, env={"PYTHONPATH": str(ROOT)}
    )
    return done.stdout
