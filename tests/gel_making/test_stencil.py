"""The stencil: true size, dots in place, a file that another reader accepts."""

import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from neurotouch_hid.gel_making.stencil import MIDDLE, RULER, draw_stencil
from tests.gel_making.plans import plan, read, write
from tests.gel_making.test_solids import LAYOUT, SQUARE

SVG = "{http://www.w3.org/2000/svg}"
MM_PER_PT = 25.4 / 72.0


@pytest.fixture(scope="module", params=[SQUARE, LAYOUT], ids=["square", "points"])
def made(request):
    return read(write(way="evening").replace(SQUARE, request.param))


def seen_from_below(points, middle):
    """Where dots are on the page: the person looks at the camera's side, so x is mirrored."""
    return np.asarray(middle) + points * (-1.0, 1.0)


def match(places, points):
    away = np.hypot(*(places[:, None] - points).transpose(2, 0, 1))
    assert sorted(away.argmin(axis=1).tolist()) == list(range(len(points)))
    return away.min(axis=1).max()


def test_the_svg_is_one_to_one_with_each_dot_at_its_place(made):
    root = ElementTree.fromstring(draw_stencil(made).write_svg())
    assert (root.get("width"), root.get("height")) == ("210mm", "297mm")
    assert root.get("viewBox") == "0 0 210 297"
    circles = [
        (float(each.get("cx")), float(each.get("cy")), float(each.get("r")))
        for each in root.iter(f"{SVG}circle")
    ]
    dots = np.array([(x, y) for x, y, r in circles if r == 0.5 * made.gel.dot_mm])
    assert len(dots) == made.gel.n_markers
    assert match(dots, seen_from_below(made.gel.points_mm, MIDDLE)) < 0.01


def test_the_pdf_has_the_same_dots_and_a_ruler_of_50_mm(made):
    pdf = draw_stencil(made).write_pdf()
    assert pdf.startswith(b"%PDF-1.")
    assert pdf.endswith(b"%%EOF\n")
    assert b"/PrintScaling /None" in pdf
    begin = int(pdf.rsplit(b"startxref\n", 1)[1].split()[0])
    assert pdf[begin : begin + 4] == b"xref"
    for number, place in enumerate(re.findall(rb"(\d{10}) 00000 n", pdf), 1):
        assert pdf[int(place) :].startswith(b"%d 0 obj" % number)
    text = pdf.decode("latin-1")
    scale, _, _, down, _, top = map(float, re.search(r"([-\d. ]+) cm", text)[1].split())
    assert scale * MM_PER_PT == pytest.approx(1.0, abs=1e-4)
    assert -down == pytest.approx(scale)
    assert top * MM_PER_PT == pytest.approx(297.0, abs=1e-2)
    radius = 0.5 * made.gel.dot_mm
    starts = re.findall(r"([\d.]+) ([\d.]+) m [\d. c]+h", text)
    sides = re.findall(r"[\d.]+ [\d.]+ m [\d.]+ [\d.]+ [\d.]+ [\d.]+ ([\d.]+) ([\d.]+) c", text)
    middles = np.array([(float(x), float(y)) for (_, y), (x, _) in zip(starts, sides, strict=True)])
    radii = np.array([float(x) for x, _ in starts]) - middles[:, 0]
    dots = middles[np.abs(radii - radius) < 1e-3]
    assert match(dots, seen_from_below(made.gel.points_mm, MIDDLE)) < 0.01
    x, y, length = RULER
    assert length == 50.0
    assert f"{x:.3f} {y:.3f} m {x + 50.0:.3f} {y:.3f} l" in text


def test_words_of_the_pdf_are_in_the_middle():
    """Adobe's table of Helvetica gives these words 6.416 sizes of 4 mm, so 25.7 mm."""
    text = draw_stencil(plan(way="evening")).write_pdf().decode("latin-1")
    x = float(re.search(r"([\d.]+) [\d.]+ Tm \(the user's side\)", text)[1])
    assert x + 0.5 * 25.7 == pytest.approx(MIDDLE[0], abs=1.0)


def test_another_program_draws_the_pdf(tmp_path):
    program = shutil.which("pdftocairo") or shutil.which("mutool")
    if program is None:
        pytest.skip("needs poppler-utils or mupdf-tools")
    path = tmp_path / "stencil.pdf"
    path.write_bytes(draw_stencil(plan(way="evening")).write_pdf())
    out = tmp_path / "page.png"
    command = (
        [program, "-png", "-r", "50", "-singlefile", path, out.with_suffix("")]
        if Path(program).name == "pdftocairo"
        else [program, "draw", "-r", "50", "-o", out, path]
    )
    subprocess.run(command, check=True, timeout=60)
    assert out.stat().st_size > 2000
