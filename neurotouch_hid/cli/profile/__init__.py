"""``neurotouch profile``: look at profiles, change them, try them, share them."""

import click

from neurotouch_hid.cli.profile import changing, guide, looking, sharing


@click.group(
    epilog="\b\nExamples:\n"
    "  neurotouch profile list\n"
    "  neurotouch profile new mine --template racing\n"
    "  neurotouch profile edit mine                       questions and answers, no YAML\n"
    "  neurotouch profile set mine push.curve.expo 0.4\n"
    '  neurotouch profile bind mine "pinch hold" "toggle button a"\n'
    "  neurotouch profile undo mine"
)
def command() -> None:
    """Look at profiles, change them, try them, share them.

    Profiles that are shipped are never changed: the first change makes your own copy. Every change
    is checked before it is saved, shown, and can be undone.
    """


for module in (looking, changing, guide, sharing):
    for subcommand in module.COMMANDS:
        command.add_command(subcommand)
