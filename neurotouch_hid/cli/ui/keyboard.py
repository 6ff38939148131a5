"""Reads lines from the keyboard while the command does something else."""

import os
import select
import sys

from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.errors import EndOfInputError


class Keyboard:
    """Reads whole lines from the standard input, also from a pipe.

    It buffers input, so nothing else may read the standard input meanwhile.
    """

    def __init__(self) -> None:
        self._fd = sys.stdin.fileno()
        self._arrived = b""
        self._ended = False

    def poll(self) -> str | None:
        """Returns the next line if one has arrived, without its end.

        Raises:
            EndOfInputError: the input has ended.
        """
        while b"\n" not in self._arrived and select.select([self._fd], [], [], 0)[0]:
            self._receive()
        return self._take() if b"\n" in self._arrived else None

    def ask(self, question: str) -> str:
        """Waits for the answer to a question.

        Raises:
            EndOfInputError: the input has ended.
        """
        echo(question)
        while b"\n" not in self._arrived:
            self._receive()
        return self._take()

    def choose(self, question: str, choices: list[str]) -> int:
        """Asks for one of several by number until a valid one is given; returns its index."""
        lines = [f"  {number}. {choice}" for number, choice in enumerate(choices, 1)]
        while True:
            answer = self.ask("\n".join([question, *lines, f"Number, 1 to {len(choices)}:"]))
            if answer.isdecimal() and 1 <= int(answer) <= len(choices):
                return int(answer) - 1
            echo(f"'{answer[:40]}' is not one of the numbers.")

    def _receive(self) -> None:
        content = os.read(self._fd, 4096)
        if not content:
            if not self._arrived:
                raise EndOfInputError
            content = b"\n"  # the last line without its end
        self._arrived += content

    def _take(self) -> str:
        line, _, self._arrived = self._arrived.partition(b"\n")
        return line.decode("utf-8", "replace").strip()
