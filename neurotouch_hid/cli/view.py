"""``neurotouch view``: serves the page on this machine."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.cli.ui.usage_errors import WrongUsage
from neurotouch_hid.errors import NeuroTouchError

if TYPE_CHECKING:
    from collections.abc import Callable
    from threading import Thread

    from neurotouch_hid.page.address import Address

OPENS_S: Final = 10.0
"""A browser that still runs then is in front of the person, and goes on without this program."""


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch view                      prints the link of the page\n"
    "  neurotouch view --open               opens it in your browser\n"
    "  neurotouch view --edit               the page may change everything\n"
    "  ssh -L 7878:localhost:7878 HOST      shows a remote machine, encrypted\n"
    "  neurotouch view --listen 192.168.1.5 --token-file ~/page-token\n\n"
    "It shows the running driver, also one that starts later. Ctrl-C ends the page, not the driver."
)
@click.option(
    "--edit",
    is_flag=True,
    help="Allow the page to start and pause the driver, calibrate, and change profiles.",
)
@click.option("--open", "open_browser", is_flag=True, help="Open the page in your browser.")
@click.option("--port", type=click.IntRange(0, 65535), help="Default: 7878, or any if it is taken.")
@click.option(
    "--listen",
    metavar="ADDRESS",
    help="Serve other machines too, at this address of one of your interfaces. Nothing is "
    "encrypted, so only in a network you trust. Needs --token-file.",
)
@click.option(
    "--token-file",
    type=click.Path(path_type=Path, dir_okay=False),
    help="A file only you can read, with the secret of the link. Default: a new secret each time.",
)
@click.option("--until-stdin-ends", is_flag=True, hidden=True)
def command(
    edit: bool,
    open_browser: bool,
    port: int | None,
    listen: str | None,
    token_file: Path | None,
    until_stdin_ends: bool,
) -> None:
    """Serve the page: start, change movements, calibrate, watch, play.

    It also shows the driver live: gesture, gel, curves, pad, times, ignored gestures. Terminals and
    screen readers get the same from 'neurotouch monitor --plain'.
    """
    if listen is not None and token_file is None:
        raise WrongUsage("Option --listen needs a token of its own.", hint="Add --token-file FILE.")
    from neurotouch_hid.page.address import read_address

    token = _read_token(token_file) if token_file is not None else None

    def tell(address: "Address") -> None:
        echo(f"Page: {address.link()}")
        echo(f"Live view: {address.link('live')}")
        echo(f"Spacecraft: {address.link('game')}")
        if listen is not None:
            far = address.url.replace("127.0.0.1", f"[{listen}]" if ":" in listen else listen)
            echo(f"From other machines: {far}#k=TOKEN, with the content of {token_file}")
        if open_browser:
            open_page(address)

    served = read_address() if open_browser and listen is None and port is None else None
    if served is not None and served.may_edit >= edit:  # the icon again, or a demo
        opening = open_page(served)
        echo(f"Page: {served.link()}")
        opening.join(OPENS_S)
        return
    try:
        serve_page(
            tell,
            edit=edit,
            port=port,
            listen=listen,
            token=token,
            until_stdin_ends=until_stdin_ends,
        )
    except NeuroTouchError as error:
        if open_browser:
            from neurotouch_hid.cli.ui.notification import notify

            notify("NeuroTouch cannot start", f"{error.message} {error.hint or ''}".strip())
        raise


def open_page(address: "Address", page: str = "") -> "Thread":
    """Opens a page in the browser, beside the program; where that is impossible, says so.

    Returns:
        The thread that does it. It may live as long as the browser, so the program, which serves
        the page, does not wait for it.
    """
    from threading import Thread

    opening = Thread(target=_open_link, args=(address.link_for_browser(page),), daemon=True)
    opening.start()
    return opening


def _open_link(link: str) -> None:
    from neurotouch_hid.cli.ui.browser import open_link
    from neurotouch_hid.cli.ui.notification import notify

    if open_link(link):
        return
    echo("No browser can be opened from here: open the link yourself.", err=True)
    notify(
        "NeuroTouch: no browser opens",
        "The page is ready, but no web browser shows it. Install one, or choose one in the "
        "settings of your desktop. Then start NeuroTouch again.",
    )


def serve_page(
    tell: "Callable[[Address], None]",
    *,
    edit: bool = False,
    port: int | None = None,
    listen: str | None = None,
    token: str | None = None,
    until_stdin_ends: bool = False,
) -> None:
    """Serves the page until Ctrl-C; calls ``tell`` with its address once it is ready."""
    import os
    import sys

    from neurotouch_hid.cli.ui.output import make_stamp
    from neurotouch_hid.page.address import (
        Address,
        forget_address,
        read_address,
        write_address,
    )
    from neurotouch_hid.page.guard import Guard, make_token
    from neurotouch_hid.page.hub import Hub
    from neurotouch_hid.page.server import EndBySignal, Server, open_sockets, run_until_signal

    token = token or make_token()
    guard = Guard(token, listen)
    hub = Hub(edit=edit, stamp=make_stamp, is_far=listen is not None)
    server = Server(guard, open_sockets(listen, port), hub)
    address = Address(server.url, token, os.getpid(), may_edit=edit)

    end = EndBySignal()
    if read_address() is None:  # else the other commands go on finding the first one
        try:
            write_address(address)
        except OSError as error:
            echo(
                f"Warning: other commands will not find this page: {error.strerror} "
                f"({error.filename}).",
                err=True,
            )
    try:
        tell(address)
        sys.stdout.flush()
        run_until_signal(server, end, until_stdin_ends=until_stdin_ends)  # of a demo
    finally:
        forget_address(address.pid)


def _read_token(path: Path) -> str:
    """Returns the secret in a file.

    Raises:
        PageError: it cannot be read, or others can read it too.
    """
    import errno

    from neurotouch_hid.errors import PageError
    from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text

    try:
        if path.stat().st_mode & 0o077:
            raise PageError(
                f"Other users can read {path}.",
                hint=f"Make it readable for yourself only: chmod 600 {path}",
            )
        token = read_text(path, MAX_SETTINGS_BYTES).strip()
        if not token.isascii():
            raise OSError(errno.EILSEQ, "it is not plain ASCII")
    except OSError as error:
        raise PageError(
            f"The token in {path} cannot be read: {error.strerror}.",
            hint=f"Make one: (umask 077; head -c 24 /dev/urandom | base64 | tr +/ -_ > {path})",
        ) from None
    return token
