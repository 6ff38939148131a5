"""``neurotouch profile``: look at profiles, change them, try them, share them."""

import click

from neurotouch_hid.cli.ui.group import LazyGroup
from neurotouch_hid.process.startup import collect_rarely

_SUMMARIES = {
    "list": "Print every profile: yours and those shipped.",
    "show": "Say in words what a profile does.",
    "check": "Find every mistake: what is wrong, risky or without effect.",
    "test": "Play scripted gestures and print what comes out.",
    "new": "Make a profile of your own as a copy of another.",
    "edit": "Change a profile step by step, by questions.",
    "set": "Set one value; nothing else in the file changes.",
    "bind": "Bind a gesture to an action.",
    "unbind": "Remove what a gesture does.",
    "use": "Play with a profile from now on.",
    "diff": "Show in which lines two profiles differ.",
    "history": "Print the versions that are kept, newest first.",
    "undo": "Take back the last change.",
    "delete": "Delete a profile of your own; undo brings it back.",
    "upgrade": "Rewrite a profile in the present format.",
    "export": "Export a profile to a file, without your own values.",
    "import": "Import a profile from a file, after showing what it does.",
}
_MODULES = {
    "looking": {"list": "list_command", "show": "show"},
    "checking": {"check": "check", "test": "test"},
    "changing": {
        "new": "new",
        "set": "set_command",
        "bind": "bind",
        "unbind": "unbind",
        "use": "use",
        "upgrade": "upgrade",
    },
    "edit": {"edit": "edit"},
    "history": {"diff": "diff", "history": "history", "undo": "undo", "delete": "delete"},
    "sharing": {"export": "export", "import": "import_command"},
}


@click.group(
    cls=LazyGroup,
    places={
        name: (f"{__name__}.{module}", function)
        for module, names in _MODULES.items()
        for name, function in names.items()
    },
    summaries=_SUMMARIES,
    epilog="\b\nExamples:\n"
    "  neurotouch profile list\n"
    "  neurotouch profile new mine --template default\n"
    "  neurotouch profile edit mine                       questions and answers, no YAML\n"
    "  neurotouch profile set mine push.curve.expo 0.4\n"
    '  neurotouch profile bind mine "pinch hold" "toggle button a"\n'
    "  neurotouch profile undo mine",
)
def command() -> None:
    """Look at profiles, change them, try them, share them.

    Profiles that are shipped are never changed: the first change makes your own copy. Every change
    is checked before it is saved, shown, and can be undone.
    """
    collect_rarely()
