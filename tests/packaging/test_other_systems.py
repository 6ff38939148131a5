"""Packages for other systems name the version and the libraries of ``pyproject.toml``."""

import re
import subprocess
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from neurotouch_hid import __version__

ROOT = Path(__file__).parents[2]
PACKAGING = ROOT / "packaging"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

# What nixpkgs calls the libraries that it builds from source.
IN_NIX = {
    "evdev-binary": "evdev",
    "opencv-contrib-python-headless": "opencv4",
    "ruamel.yaml": "ruamel-yaml",
    "backports.zstd": "backports-zstd",
}


def list_dependencies() -> set[str]:
    return {re.match(r"[\w.-]+", each)[0] for each in PROJECT["dependencies"]}


def normalise(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


@pytest.mark.parametrize(
    ("file", "pattern"),
    [
        ("arch/PKGBUILD", r"^pkgver=(.+)$"),
        ("rpm/neurotouch-hid.spec", r"^Version:\s+(.+)$"),
        ("flake.nix", r'version = "(.+)";'),
    ],
)
def test_version_is_that_of_the_program(file, pattern):
    found = re.search(pattern, (PACKAGING / file).read_text(), re.MULTILINE)
    assert found[1] == __version__


@pytest.mark.parametrize(
    ("machine", "name"), [("x86_64", "evdev-binary"), ("aarch64", "evdev"), ("riscv64", "evdev")]
)
def test_every_processor_gets_an_evdev_that_exists_for_it(machine, name):
    """evdev-binary has wheels for x86-64 only, and no source: elsewhere pip would find nothing."""
    there = {"sys_platform": "linux", "platform_machine": machine}
    requirements = map(Requirement, PROJECT["dependencies"])
    named = [each for each in requirements if each.name.startswith("evdev")]
    assert [each.name for each in named if each.marker.evaluate(there)] == [name]


def test_flake_has_every_library():
    text = (PACKAGING / "flake.nix").read_text()
    named = set(re.findall(r"python\.([\w-]+)\s*$", text, re.MULTILINE))
    named |= set(re.findall(r"\(python\.pythonOlder \"3\.14\"\) python\.([\w-]+)", text))
    assert named == {IN_NIX.get(name, name) for name in list_dependencies()}
    removed = re.search(r"pythonRemoveDeps = \[(.*?)\]", text)[1].replace('"', "").split()
    assert set(removed) == {
        name for name, there in IN_NIX.items() if normalise(name) != normalise(there)
    }


def test_packages_with_libraries_of_their_own_have_every_one():
    locked = re.findall(r"^([\w.-]+)==", (PACKAGING / "requirements.lock").read_text(), re.M)
    assert {normalise(name) for name in list_dependencies()} <= {normalise(each) for each in locked}
    for file in ("arch/PKGBUILD", "rpm/neurotouch-hid.spec", "sysext/build.sh"):
        assert "lay-out.sh" in (PACKAGING / file).read_text()


def test_rpm_lists_every_file_that_is_laid_out():
    """A file that the list lacks would end the build with an error, a day later, on Fedora."""
    spec = (PACKAGING / "rpm/neurotouch-hid.spec").read_text().partition("%files\n")[2]
    for folder, kind in [
        ("etc", "/etc/neurotouch"),
        ("modules-load.d", "/usr/lib/modules-load.d"),
        ("sysusers.d", "/usr/lib/sysusers.d"),
    ]:
        for path in (PACKAGING / folder).iterdir():
            assert f"{kind}/{path.name}\n" in spec


def test_settings_stay_at_an_upgrade():
    names = {f"etc/neurotouch/{path.name}" for path in (PACKAGING / "etc").iterdir()}
    build = (PACKAGING / "arch/PKGBUILD").read_text()
    assert set(re.search(r"^backup=\((.*)\)$", build, re.M)[1].split()) == names
    spec = (PACKAGING / "rpm/neurotouch-hid.spec").read_text()
    assert set(re.findall(r"^%config\(noreplace\) /(.+)$", spec, re.M)) == names


@pytest.mark.parametrize(
    ("shell", "file"),
    [
        ("bash", "arch/PKGBUILD"),
        ("sh", "arch/neurotouch-hid.install"),
        ("sh", "lay-out.sh"),
        ("sh", "compile-kernels.sh"),
        ("sh", "add-kernels.sh"),
        ("sh", "sysext/build.sh"),
    ],
)
def test_script_can_be_read_by_its_shell(shell, file):
    subprocess.run([shell, "-n", PACKAGING / file], check=True)
