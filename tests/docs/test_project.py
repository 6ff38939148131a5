"""What the project says about itself in several places is the same everywhere."""

import re
import tomllib

from ruamel.yaml import YAML

from neurotouch_hid import __version__
from tests.docs.prose import ROOT, pages

_LINK = re.compile(r"""(?:\]\(|src="|srcset=")(?!https?:|mailto:|#|_static)([^)"#]+)""")
_PATH = re.compile(
    r"`((?:neurotouch_hid|devtools|docs|examples|packaging|profiles|tests|udev)/(?!_build)[\w./-]*)`"
)


def test_citation_is_of_this_version_and_names_the_paper():
    citation = YAML(typ="safe").load((ROOT / "CITATION.cff").read_text())
    assert citation["version"] == __version__
    assert (
        citation["preferred-citation"]["identifiers"][0]["value"]
        in (ROOT / "README.md").read_text()
    )


def test_readme_tells_the_status_on_its_first_screen():
    head = (ROOT / "README.md").read_text().splitlines()[:20]
    assert any("never yet run on a real camera" in line for line in head)


def test_moving_picture_is_small():
    assert (ROOT / "docs" / "pictures" / "tour.gif").stat().st_size < 1_000_000


def test_every_link_between_documents_leads_to_a_file():
    broken = [
        f"{page.relative_to(ROOT)}: {target}"
        for page in pages()
        for target in _LINK.findall(page.read_text())
        if not (page.parent / target).exists()
    ]
    assert broken == []


def test_every_path_in_documents_exists():
    lost = [
        f"{page.relative_to(ROOT)}: {path}"
        for page in pages()
        for path in _PATH.findall(page.read_text())
        if not (ROOT / path).exists()
    ]
    assert lost == []


def test_every_shipped_profile_is_on_the_page_for_players():
    page = (ROOT / "docs" / "play.md").read_text()
    names = [file.stem for file in (ROOT / "profiles").glob("*.yaml")]
    assert [name for name in names if f"`{name}`" not in page] == []
    assert len(names) == 13  # the page says how many


def test_development_tools_belong_to_this_very_version():
    project = tomllib.loads((ROOT / "devtools" / "pyproject.toml").read_text())["project"]
    assert project["dependencies"] == [f"neurotouch-hid == {__version__}"]
    assert project["dynamic"] == ["version"]  # of the same file
