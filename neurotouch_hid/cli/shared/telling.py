"""Says what a command says: in the terminal, by voice, and at a page if one is open."""

import os
import sys
from collections import deque
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, Final

import click

from neurotouch_hid.cli.ui.output import echo

if TYPE_CHECKING:
    from neurotouch_hid.cli.ui.keyboard import Keyboard
    from neurotouch_hid.cli.ui.voice import Voice
    from neurotouch_hid.page.command_page import CommandPage

_MOST_HEARD: Final = 40
"""Sentences that the page keeps."""

page_option = click.option(
    "--page", "with_page", is_flag=True, help="Show all at a page too, and print its link."
)
open_option = click.option(
    "--open", "open_browser", is_flag=True, help="The same, and open it in your browser."
)


def start_page(
    stack: ExitStack, keys: list[tuple[str, str]], *, open_browser: bool, **shown: Any
) -> "CommandPage":
    """Serves a page until the block ends; prints its link.

    Raises:
        PageError: it cannot be served.
    """
    from neurotouch_hid.page.address import Address
    from neurotouch_hid.page.command_page import CommandPage

    page = stack.enter_context(CommandPage(keys, **shown))
    address = Address(page.url, page.token, os.getpid(), may_edit=True)
    echo(f"Page: {address.link()}")
    sys.stdout.flush()
    if open_browser:
        from neurotouch_hid.cli.view import open_page

        open_page(address)
    return page


class Telling:
    """Says sentences at all places, and takes a key from any of them.

    Args:
        voice: prints and speaks.
        page: shows the same; None without.
    """

    def __init__(self, voice: "Voice", page: "CommandPage | None") -> None:
        self._voice, self._page = voice, page
        self._heard: deque[tuple[int, str]] = deque(maxlen=_MOST_HEARD)
        self._n_heard = 0
        self._has_keyboard = True

    def say(self, sentence: str) -> None:
        """Prints, speaks and shows a sentence."""
        self._voice.say(sentence)
        self._n_heard += 1
        self._heard.append((self._n_heard, sentence))
        self.show(heard=[list(each) for each in self._heard])

    def show(self, **changed: Any) -> None:
        """Shows values at the page alone."""
        if self._page is not None:
            self._page.show(**changed)

    def poll(self, keyboard: "Keyboard") -> str | None:
        """Returns what was typed or pressed next, if anything was.

        Raises:
            NeuroTouchError: the input has ended, and there is no page.
        """
        from neurotouch_hid.errors import NeuroTouchError

        pressed = None if self._page is None else self._page.poll()
        if pressed is not None or not self._has_keyboard:
            return pressed
        try:
            return keyboard.poll()
        except NeuroTouchError:
            if self._page is None:
                raise
            self._has_keyboard = False  # a program without a terminal: the page has the keys
            return None
