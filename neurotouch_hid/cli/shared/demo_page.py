"""Serves the page beside a demo, in a process that always ends with the demo."""

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.page.address import forget_address, read_address
from neurotouch_hid.process.own_command import make_own_command

_PATIENCE_S = 5.0
"""Time for the page to end, first after the end of its input, then after a signal."""


@contextmanager
def open_page(page: str) -> Iterator[None]:
    """Serves the page and prints its links; if one is served already, only prints them.

    Args:
        page: the page to name first: ``gel``, or empty for the first page.
    """
    address = read_address()
    if address is not None:
        _say_links(page, address.link(page), address.link("game"))
        yield
        return
    process = subprocess.Popen(  # noqa: S603  # our own command
        make_own_command("view", "--edit", "--until-stdin-ends"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,  # Ctrl-C is for the demo
    )
    try:
        said = [process.stdout.readline() if process.stdout is not None else "" for _ in range(3)]
        if all(said):
            home, _, game = (line.split(": ", 1)[1].strip() for line in said)
            _say_links(page, home.replace("/#", f"/{page}#"), game)
        else:
            echo("Warning: the page could not be started. Try: neurotouch view", err=True)
        yield
    finally:
        _end(process)


def _end(process: "subprocess.Popen[str]") -> None:
    """Asks the page to end; if it does not, kills it and removes the files that it leaves."""
    if process.stdin is not None:
        process.stdin.close()
    for harder in (process.terminate, process.kill):
        try:
            process.wait(_PATIENCE_S)
            break
        except subprocess.TimeoutExpired:
            harder()
    process.wait()
    forget_address(process.pid)
    if process.stdout is not None:
        process.stdout.close()


def _say_links(page: str, first: str, game: str) -> None:
    what = "Press the gel here" if page else "Watch it here"
    echo(f"{what}: {first}\nPlay the spacecraft: {game}", err=True)
