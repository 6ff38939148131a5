"""Ends every change of a profile: checks it, saves it and says what has changed."""

import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from neurotouch_hid.cli.ui.outcome import Outcome
from neurotouch_hid.cli.ui.output import choose, say
from neurotouch_hid.errors import ProfileError

if TYPE_CHECKING:
    from neurotouch_hid.files.faults import Fault
    from neurotouch_hid.profile import Checked
    from neurotouch_hid.profile.editing import EditedFile, ProfileText


def _find_new(edited: "EditedFile", checked: "Checked[Any]") -> "tuple[Fault, ...]":
    """Returns the faults that the file as it is does not have."""
    if not checked.faults:
        return ()
    before = {(each.path, each.sentence) for each in edited.check(edited.text).faults}
    return tuple(each for each in checked.faults if (each.path, each.sentence) not in before)


def _count_older(n: int, edited: "EditedFile") -> tuple[str, ...]:
    from neurotouch_hid.profile import list_profiles

    if n == 0:
        return ()
    name, path = edited.name, edited.store.path
    known = name == "user" or list_profiles().get(name) == path
    warnings = "1 older warning stays" if n == 1 else f"{n} older warnings stay"
    return (f"{warnings}: neurotouch profile check {name if known else path}",)


def _explain(refused: str, fault: "Fault") -> ProfileError:
    """Returns the error about one change, for a person who sees no file."""
    hint = f"{fault.hint[:1].upper()}{fault.hint[1:]}"
    if hint and not hint.endswith("?"):
        hint += "."
    subject = "it " if fault.sentence.startswith(("needs", "is ", "has ")) else ""
    if fault.code == "NT112":  # the sentence lists the words
        hint = hint or "Write one of these words."
    return ProfileError(
        f"{refused}: {subject}{fault.sentence}.",
        hint=hint or f"What this means: neurotouch explain {fault.code}",
    )


def tell_old_words(edited: "EditedFile", text: "ProfileText") -> tuple[str, ...]:
    """Returns a note if a copy does something else now, and is described as the original is."""
    from neurotouch_hid.profile.reading import find_shipped_folder

    before, after = edited.text.document, text.document
    said = after.get("description")
    if before == after or not isinstance(said, str):
        return ()
    words = " ".join(said.split())
    shipped = (path.read_text(encoding="utf-8") for path in find_shipped_folder().glob("*.yaml"))
    if not any(words in " ".join(each.split()) for each in shipped):
        return ()
    command = f"neurotouch profile set {edited.name} description"
    return (f'It is still described as the original. Say what it does now: {command} "My words"',)


def save_edited(
    edited: "EditedFile",
    text: "ProfileText",
    notes: tuple[str, ...] = (),
    *,
    refused: str = "",
    plain: bool,
    as_json: bool = False,
) -> None:
    """Saves a changed text if it is right, and tells what has changed; then prints ``notes``.

    Args:
        edited: the file.
        text: its text now.
        notes: sentences for the end.
        refused: what has failed if this one change brings a mistake in, such as "'filter' was not
            changed"; the mistake is then told without its place in a file that was not saved.
        plain: one fact per line.
        as_json: the result as JSON.

    Raises:
        ProfileError: there are errors, or it cannot be written; nothing has changed. With
            ``as_json`` errors are told, and the process ends with the error's exit code.
    """
    from neurotouch_hid.profile.editing import compare, hand_over_saved

    path = edited.store.path
    if text == edited.text and edited.content is not None:
        message = f"{edited.name} says so already, nothing has changed."
        Outcome(message, file=path).tell(plain=plain, as_json=as_json)
        return
    try:
        checked = edited.save(text)
    except ProfileError as error:
        checked = edited.check(text)
        if checked.whole is not None:  # right, but it cannot be written
            raise
        new = _find_new(edited, checked) if refused else ()
        fault = next((each for each in sorted(new) if each.severity == "error"), None)
        told = ProfileError(f"{error.message}\nNothing was saved.", hint=error.hint)
        if fault is not None:
            told = _explain(refused, fault)
        if not as_json:
            raise told from None
        message = "There are errors." if fault is None else told.message
        fix = told.hint or "Nothing was saved."
        Outcome(message, "FAILED", path, checked=checked, fix=fix).tell(plain=plain, as_json=True)
        sys.exit(error.exit_code)
    effect = hand_over_saved(edited.name)
    if edited.shipped:
        notes = ("This is your own copy; the original stays as it is.", *notes)
    if not as_json:  # what a person has read before is not read out with every change
        new = _find_new(edited, checked)
        notes += _count_older(len(checked.faults) - len(new), edited)
        checked = replace(checked, faults=new)
    saved = Outcome(
        f"Saved {path}",
        effect.status,
        file=path,
        changed=True,
        lines=compare(edited.text, text),
        checked=checked,
        notes=(effect.text, *notes),
        fix=effect.fix,
    )
    saved.tell(plain=plain, as_json=as_json)


def offer_saving(edited: "EditedFile", text: "ProfileText", *, plain: bool) -> None:
    """Saves a changed text if the person wants to, as ``save_edited``."""
    if text == edited.text:
        say("OK", "Nothing has changed.", plain=plain)
    elif choose("Save this?", ["Save", "Throw it away"], default=0) == 0:
        save_edited(edited, text, plain=plain)
    else:
        say("OK", "Nothing was saved.", plain=plain)
