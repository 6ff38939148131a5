"""``neurotouch game``: opens the spacecraft game."""

import click

from neurotouch_hid.cli.ui.output import echo


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch demo --mouse      in one terminal: a gel under your mouse\n"
    "  neurotouch game              in another: the game in your browser\n"
    "  neurotouch game --no-open    only prints the link"
)
@click.option("--open/--no-open", "open_browser", default=True, help="Open it in your browser.")
@click.option("--port", type=click.IntRange(0, 65535), help="Default: 7878, or any if it is taken.")
def command(open_browser: bool, port: int | None) -> None:
    """Open the spacecraft game in your browser: fly through rings; there is no time limit.

    It reads the virtual pad as any game does, so a running driver flies it. Without one it flies by
    itself. The key P pauses and resumes the driver. Ctrl-C ends the page's server; if 'neurotouch
    view' or a demo serves the page already, this command only opens it.
    """
    from neurotouch_hid.cli.view import OPENS_S, open_page, serve_page
    from neurotouch_hid.page.address import Address, read_address

    def tell(address: Address) -> None:
        echo(f"Spacecraft: {address.link('game')}")
        if open_browser:
            opening = open_page(address, "game")
            if served is not None:  # this program ends now
                opening.join(OPENS_S)

    served = read_address()
    if served is not None:
        tell(served)
    else:
        serve_page(tell, edit=True, port=port)  # without edit, a person could not pause there
