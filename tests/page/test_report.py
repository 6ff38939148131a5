"""The report of ``neurotouch evaluate`` in a real browser, by the rules of axe."""

import pytest

from neurotouch_hid.evaluation.accuracy.report import write_report
from neurotouch_hid.messages import GestureKind
from tests.evaluation.test_report import ORIGIN, evaluate
from tests.page.test_layout import check_rules


@pytest.fixture(scope="module")
def link(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report") / "report"
    methods = {
        "paper": evaluate(0.5, GestureKind.PUSH),
        "neurotouch": evaluate(0.25, GestureKind.ZOOM),
    }
    write_report(folder, methods, ORIGIN, lambda _: None)
    return (folder / "report.html").as_uri()


@pytest.mark.parametrize("way", [{}, {"color_scheme": "dark"}, {"forced_colors": "active"}])
@pytest.mark.parametrize("width", [1280, 320])
def test_the_report_can_be_read_by_everybody(open_page, link, way, width):
    page = open_page(link, viewport={"width": width, "height": 1000}, **way)
    check_rules(page, "at first")
    page.evaluate("() => document.querySelectorAll('details').forEach((each) => each.open = true)")
    check_rules(page, "with all numbers")
    assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
