"""What is served: the program's own files, under rules that let nothing else in."""

import re

import pytest

from neurotouch_hid.page.guard import (
    HEADERS,
)
from neurotouch_hid.page.server import STATIC
from tests.page.connecting import get


@pytest.mark.parametrize("path", ["/", "/gel", "/game", "/shared/style.css", "/nothing", "/stream"])
def test_every_answer_carries_the_rules(server, path):
    _, headers, _ = get(server, path)
    for name, value in HEADERS.items():
        assert headers[name] == value
    assert not [name for name in headers if name.lower().startswith("access-control")]


def test_the_policy_allows_own_files_only():
    policy = dict(
        part.strip().split(" ", 1) for part in HEADERS["Content-Security-Policy"].split(";")
    )
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == policy["connect-src"] == "'self'"
    assert policy["frame-ancestors"] == policy["base-uri"] == "'none'"


def test_no_page_names_anything_elsewhere(server):
    for path in STATIC.glob("*/*"):
        text = path.read_text()
        found = re.findall(r"(?:https?:)?//[a-z][\w.-]*\.[a-z]+", text)
        assert [each for each in found if "w3.org" not in each] == [], path.name
        if path.suffix == ".html":
            assert "<style" not in text
            assert not re.search(r"<script(?![^>]*\bsrc=)", text)
            assert not re.search(r"\son\w+=", text)
        if path.suffix == ".js":
            assert "innerHTML" not in text  # what a profile is called is text, never markup
            assert "insertAdjacentHTML" not in text


@pytest.mark.parametrize(
    "path",
    ["/../guard.py", "/%2e%2e/guard.py", "/static/../hub.py", "//etc/passwd", "/view/view.html?x"],
)
def test_nothing_else_is_served(server, path):
    assert get(server, path)[0] == 404
