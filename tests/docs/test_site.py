"""The site builds without a warning and without network, and a browser needs none to read it."""

import re
import sys
from pathlib import Path

import pytest

from tests.docs.prose import ROOT
from tests.processes import run_command

pytest.importorskip("furo", reason="the tools for the documents are not installed")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    options = ("--quiet", "--fail-on-warning", "--keep-going", "--nitpicky", "--fresh-env")
    run_command(sys.executable, "-m", "sphinx", *options, "docs", folder, cwd=ROOT)
    return folder


def test_nothing_is_fetched_from_elsewhere(site: Path):
    fetched = re.compile(
        r"""<(?:script|img|iframe|source|link rel="(?:stylesheet|icon|preload)")[^>]*https?://"""
        r"""|(?:@import|url\()\s*["']?https?://"""
    )
    files = [*site.rglob("*.html"), *site.rglob("*.css")]
    assert len(files) > 15
    assert [file.name for file in files if fetched.search(file.read_text())] == []


@pytest.mark.parametrize(
    ("page", "anchor"),
    [
        ("commands", "neurotouch-run"),
        ("commands", "neurotouch-profile-set"),
        ("profile-format", "binding"),
        ("profile-format", "weakrelease"),
        ("user-format", "the-whole-file"),
        ("api", "neurotouch_hid.open_gel"),
    ],
)
def test_reference_is_complete(site: Path, page: str, anchor: str):
    assert f'id="{anchor}"' in (site / f"{page}.html").read_text()
