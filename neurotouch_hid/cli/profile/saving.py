"""What every change ends with: checked, saved, shown."""

from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.output import say, show_changes

if TYPE_CHECKING:
    from neurotouch_hid.profile.editing import Paper


def save_paper(paper: "Paper", text: str, *, plain: bool) -> None:
    """Saves a changed text if it is right, and shows what has changed.

    Raises:
        ProfileError: there are errors, or it cannot be written; nothing has changed.
    """
    from neurotouch_hid.errors import ProfileError
    from neurotouch_hid.profile.editing import compare

    if text == paper.text and paper.content is not None:
        say("OK", f"{paper.name} says so already, nothing has changed.", plain=plain)
        return
    checked = paper.check(text)
    try:
        checked.require()
    except ProfileError as error:
        raise ProfileError(error.message, hint=error.hint or "Nothing was saved.") from None
    paper.save(text)
    show_changes(compare(paper.text, text), plain=plain)
    say("OK", f"Saved {paper.store.path}", plain=plain)
    if paper.shipped:
        click.echo("This is your own copy; the shipped profile stays as it is.")
    show_warnings(checked, plain=plain)


def show_warnings(checked: object, *, plain: bool) -> None:
    """The faults of something that was read, one a line in plain output."""
    from neurotouch_hid.profile import Checked

    if not isinstance(checked, Checked):
        return
    if not plain:
        if checked.faults:
            click.echo(checked.format())
        return
    for fault in checked.faults:
        status = "WARNING" if fault.severity == "warning" else "FAILED"
        place = f"{checked.name}:{fault.mark.line + 1}:{fault.mark.column + 1}"
        path = f"{fault.path}: " if fault.path else ""
        say(status, f"{place}: {path}{fault.sentence} [{fault.code}]", fault.hint)
