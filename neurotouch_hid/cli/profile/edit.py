"""``neurotouch profile edit``: questions and answers, or the user's own text editor."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.profile.drafts import find_draft, keep_draft, save_draft, write_draft
from neurotouch_hid.cli.profile.guide import Guide
from neurotouch_hid.cli.profile.saving import save_edited
from neurotouch_hid.cli.profile.values import ask_values
from neurotouch_hid.cli.ui.completing import complete_file, complete_source
from neurotouch_hid.cli.ui.outcome import show_faults
from neurotouch_hid.cli.ui.output import choose, make_stamp, plain_option, say
from neurotouch_hid.errors import NeuroTouchError

if TYPE_CHECKING:
    from neurotouch_hid.profile.editing import EditedFile, ProfileText


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile edit mine             questions with numbered answers\n"
    "  neurotouch profile edit mine --editor    the file itself, in $EDITOR\n"
    "  neurotouch profile edit user             your own values: filter, timing, sound and others"
)
@click.argument("name", shell_complete=complete_file)
@click.option("--editor", is_flag=True, help="Open the file in $VISUAL or $EDITOR; check it after.")
@click.option(
    "--source",
    shell_complete=complete_source,
    help="Let gestures be shown instead of named: file:NAME.aedat4, sim:NAME or davis:.",
)
@plain_option
def edit(name: str, editor: bool, source: str | None, plain: bool) -> None:
    """Change a profile step by step, by questions.

    Nothing is timed. Every step can be taken back, and nothing is saved before you say so.
    """
    from neurotouch_hid.profile import UserSettings
    from neurotouch_hid.profile.editing import read_text, take_file

    edited = take_file(name, make_stamp)
    draft = find_draft(edited)
    text = edited.text
    if draft.exists():
        choices = ["Go on with it", "Throw it away"]
        if choose("There is a draft that was not saved.", choices) == 0:
            text = read_text(draft)[0]
        else:
            draft.unlink()
    if editor:
        settled = _edit_text(edited, text, draft, plain=plain)
    elif edited.model is UserSettings:
        settled = ask_values(edited, text, draft, plain=plain)
    else:
        settled = Guide(edited, text, draft, source, plain=plain).run()
    if settled:
        draft.unlink(missing_ok=True)


def _edit_text(edited: "EditedFile", text: "ProfileText", draft: Path, *, plain: bool) -> bool:
    """Opens the draft in the editor until the text is right or the person stops.

    What the person has saved there stays if the editor fails or the terminal is closed.

    Returns:
        False if a draft is left.
    """
    from neurotouch_hid.profile.editing import read_text

    newline = "\r\n" if "\r\n" in text.text else "\n"
    answer = 0
    with keep_draft(draft, edited, lambda: text):
        while answer == 0:
            write_draft(draft, text)
            try:
                _open_editor(edited.name, draft)
            finally:
                written = read_text(draft)[0].text.replace("\r\n", "\n")
                text = text.rewrite(written.replace("\n", newline))
            if text == edited.text:
                say("OK", "Nothing has changed.", plain=plain)
                return True
            checked = edited.check(text)
            if checked.whole is not None:
                save_edited(edited, text, plain=plain)
                return True
            show_faults(checked, plain=plain)
            choices = ["Edit again", "Keep the old profile, discard this one", "Keep it as a draft"]
            answer = choose("There are errors. What now?", choices, default=0)
    if answer == 1:
        say("OK", "The old profile is kept.", plain=plain)
        return True
    save_draft(draft, text)
    return False


def _open_editor(name: str, draft: Path) -> None:
    """Lets the person change the draft until the editor ends.

    Raises:
        NeuroTouchError: the editor cannot be started, or it has failed.
    """
    try:
        click.edit(filename=str(draft))
    except (click.ClickException, ValueError) as error:  # a ValueError: an open quote in $EDITOR
        said = error.format_message() if isinstance(error, click.ClickException) else str(error)
        raise NeuroTouchError(
            f"The text editor has failed. {said}.",
            hint=f"Set VISUAL to an editor, like nano. Without one: neurotouch profile edit {name}",
        ) from None
