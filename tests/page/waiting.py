"""Waiting beside a page."""

import time

from playwright.sync_api import TimeoutError as TooLate

from tests.processes import LIMIT_S


def wait_on(page, happened) -> None:
    """Waits for what happens outside the page, and lets the page's events in meanwhile."""
    deadline = time.monotonic() + LIMIT_S
    while not happened():
        assert time.monotonic() < deadline
        page.wait_for_timeout(50)


def refuse_connections(page) -> None:
    """Lets every further attempt of a page to connect fail."""
    page.evaluate(
        """() => {
            window.WebSocket = class { constructor() { setTimeout(() =>
                this.onclose({code: 1006, reason: ""})); } };
            window.WebSocket.OPEN = 1;
        }"""
    )


def rest_hand(page) -> None:
    """Waits until Resume acts: right after Pause it would be a second press of a trembling hand."""
    page.wait_for_timeout(600)


def wait_for(page, element: str, words: str) -> None:
    """Waits until an element, by its id, says these words."""
    try:
        page.wait_for_function(
            "([id, words]) => document.getElementById(id).textContent.includes(words)",
            arg=[element, words],
        )
    except TooLate:
        raise AssertionError(f"#{element} says: {page.text_content(f'#{element}')}") from None
