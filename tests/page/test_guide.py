"""``neurotouch hello`` and ``gel check --live`` at their page, by keyboard alone."""

import json
import re
import zipfile

from tests.page.test_layout import check_rules
from tests.page.waiting import refuse_connections, wait_for
from tests.processes import Process


def start(folder, *arguments):
    running = Process(folder, *arguments, ready="Page: ")
    return running, re.search(r"Page: (\S+)", running.said)[1]


def test_hello_is_done_at_the_page_by_keyboard(open_page, tmp_path):
    out = tmp_path / "try"
    running, link = start(tmp_path, "hello", str(out), "--source", "sim:rest", "--page")
    try:
        page = open_page(link)
        wait_for(page, "request", "Light and focus")
        wait_for(page, "live", "of 9")  # what a screen reader says
        assert page.locator("#simulated").text_content() == "SIMULATED"
        check_rules(page, "a request")
        assert page.evaluate("document.activeElement.textContent") == "Done, next"
        page.keyboard.press("Tab")
        for n_done in range(9):
            wait_for(page, "progress", f"{n_done} of 9")
            page.keyboard.press("Enter")
        wait_for(page, "request", "This is the end")
        assert "Stiffness is not measurable" in page.locator("#results").text_content()
        assert "Nothing was sent." in page.locator("#heard").text_content()
        assert not page.locator("#keys").is_visible()
        check_rules(page, "the answers")
        running.process.wait(60)
    finally:
        running.end()
    with zipfile.ZipFile(tmp_path / "try.hello.zip") as archive:
        spans = json.loads(archive.read("hello.json"))["prompts"]
    assert [span["skipped"] for span in spans] == [True] * 9


def test_score_of_a_gel_is_shown_while_it_changes(open_page, tmp_path):
    running, link = start(tmp_path, "gel", "check", "sim:rest,missing=12", "--live", "--page")
    try:
        page = open_page(link)
        wait_for(page, "score", "intensity")
        score = page.locator("#score").text_content()
        assert "Missing or too faint" in score
        assert "FAILED" in score
        assert "dots again" in page.locator("#request").text_content()
        check_rules(page, "a score")
    finally:
        running.end()


def test_a_lost_connection_is_told_once_and_not_each_second(open_page, tmp_path):
    running, link = start(tmp_path, "gel", "check", "sim:rest,missing=12", "--live", "--page")
    try:
        page = open_page(link)
        wait_for(page, "score", "intensity")
        refuse_connections(page)
        page.evaluate(
            """() => {
                window.told = [];
                const live = document.getElementById("live");
                new MutationObserver(() => window.told.push(live.textContent))
                    .observe(live, { childList: true, characterData: true, subtree: true });
            }"""
        )
        running.process.kill()
        wait_for(page, "notice", "The connection is lost")
        page.wait_for_timeout(4_000)
        told = [each for each in page.evaluate("window.told") if "connection" in each]
        assert len(told) == 1
    finally:
        running.end()
