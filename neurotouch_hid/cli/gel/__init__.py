"""``neurotouch gel``: plan a gel, get the files to make it, check the one that was made."""

import click

from neurotouch_hid.cli.ui.group import LazyGroup

_SUMMARIES = {
    "new": "Write gel.yaml by a few questions.",
    "show": "Draw the gel and its camera, with all measures.",
    "make": "Write moulds, body, stencil and a page of instructions.",
    "check": "Score a gel that was made, and say what to change.",
}


@click.group(
    cls=LazyGroup,
    places={name: (f"{__name__}.{name}", "command") for name in _SUMMARIES},
    summaries=_SUMMARIES,
    epilog="\b\nExamples:\n"
    "  neurotouch gel new                        three questions\n"
    "  neurotouch gel show\n"
    "  neurotouch gel make my-gel                then open my-gel/README.html\n"
    "  neurotouch gel check video:               once it is made\n\n"
    "Nobody has built a gel from these files yet.",
)
def command() -> None:
    """Plan a gel of your own, get the files to make it, and check it.

    The plan is a file, gel.yaml. The driver reads the same file to find the dots.
    """
