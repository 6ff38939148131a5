"""The folder for a maker."""

import csv
import re
import sys
from io import StringIO
from xml.etree import ElementTree

import pytest

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.gel_making import shapes
from neurotouch_hid.gel_making.cameras import WAYS
from neurotouch_hid.gel_making.drawings import draw_wiring
from neurotouch_hid.gel_making.folder import PAGE, make_files, write_folder
from neurotouch_hid.gel_making.sheet import Words
from tests.gel_making.plans import plan, write

ALWAYS = {
    PAGE, "gel.yaml", "parts.csv", "cut.svg", "picture.svg", "stencil.svg", "stencil.pdf",
}  # fmt: skip
HOUSING = {"wiring.svg", "clamp.stl", "ring.stl", "body.stl", "camera-plate.stl"}
OF_WAY = {
    "evening": set(),
    "printed": HOUSING | {"dome.3mf", "dome-dark.stl", "dome-light.stl"},
    "cast": HOUSING | {"mould-bottom.stl", "mould-top.stl", "pegs.stl"},
}


@pytest.mark.parametrize("way", WAYS)
def test_each_way_has_its_files_and_the_same_bytes_twice(way):
    text = write(way=way).encode()
    files = make_files(plan(way=way), text)
    assert set(files) == ALWAYS | OF_WAY[way]
    assert files["gel.yaml"] == text
    assert make_files(plan(way=way), text) == files


@pytest.mark.parametrize("way", WAYS)
def test_the_page_says_first_that_nobody_has_built_it_and_needs_nothing_from_elsewhere(way):
    files = make_files(plan(way=way), b"")
    page = files[PAGE].decode()
    assert page.index("Nobody has built this yet") < page.index("1 What you need")
    assert page.index("photograph") < page.index("1 What you need")
    assert not re.search(r'(src|href)="', page)
    assert {f"--way {other}" for other in WAYS if other != way} <= set(
        re.findall(r"--way \w+", page)
    )
    for name in re.findall(r"<td>([\w-]+\.\w+)</td>|<code>([\w-]+\.(?:stl|3mf|pdf|svg))", page):
        assert "".join(name) in files
    for svg in re.findall(r"<svg.*?</svg>", page, re.DOTALL):
        ElementTree.fromstring(svg)
    # Grey only, so a printer without colours loses nothing.
    for colour in re.findall(r"#([0-9a-f]{6})\b", page):
        assert len({colour[:2], colour[2:4], colour[4:]}) == 1


def test_the_parts_list_names_no_maker():
    for way in WAYS:
        rows = list(csv.reader(StringIO(make_files(plan(way=way), b"")["parts.csv"].decode())))
        assert rows[0] == ["amount", "what", "property"]
        assert all(len(row) == 3 and all(row) for row in rows)
        words = str(rows).lower()
        for maker in ("ecoflex", "dragon", "sylgard", "ninja", "logitech", "arduino", "ws2812"):
            assert maker not in words


def test_no_words_of_the_circuit_are_cut_off():
    sheet = draw_wiring()
    words = [each for each in sheet.shapes if isinstance(each, Words)]
    wide = 0.52  # of a letter, in its size, where there is no Helvetica
    assert max(word.x + wide * word.size * len(word.text) for word in words) < sheet.width


def test_a_folder_that_is_not_empty_stays_as_it_is(tmp_path):
    out = tmp_path / "gel"
    write_folder(out, {"a": b"1"})
    (out / "mine").write_text("mine")
    with pytest.raises(NeuroTouchError, match="not empty"):
        write_folder(out, {"a": b"2"})
    assert (out / "a").read_bytes() == b"1"
    write_folder(out, {"a": b"2"}, replace=True)
    assert (out / "a").read_bytes() == b"2"
    assert (out / "mine").read_text() == "mine"


def test_without_the_library_for_solids_only_a_flat_gel_can_be_made(monkeypatch):
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    shapes.load_library.cache_clear()
    try:
        assert make_files(plan(way="evening"), b"")
        with pytest.raises(NeuroTouchError, match="manifold3d") as error:
            make_files(plan(), b"")
        assert "pip install 'neurotouch-hid[gel]'" in str(error.value.hint)
    finally:
        shapes.load_library.cache_clear()
