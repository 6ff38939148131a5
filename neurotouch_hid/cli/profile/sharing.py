"""Commands that give profiles to others and take theirs."""

import shlex
from pathlib import Path

import click

from neurotouch_hid.cli.ui.completing import complete_profile
from neurotouch_hid.cli.ui.options import OutFile
from neurotouch_hid.cli.ui.outcome import Outcome, confirm, show_faults
from neurotouch_hid.cli.ui.output import (
    echo,
    echo_file,
    json_option,
    make_stamp,
    plain_option,
    print_json,
    save_text,
    show_changes,
)
from neurotouch_hid.cli.ui.usage_errors import WrongUsage
from neurotouch_hid.errors import ProfileError


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile export mine > mine.yaml\n"
    "  neurotouch profile export mine --output mine.yaml --user me.yaml"
)
@click.argument("name", shell_complete=complete_profile)
@click.option(
    "--output",
    type=OutFile(allow_dash=True),
    help="The file to write; without, or with -, it is printed.",
)
@click.option(
    "--user",
    "user_path",
    type=OutFile(),
    help="Write your own values too (ranges, filter, timing), to this file.",
)
@click.option("--force", is_flag=True, help="Overwrite files.")
@json_option
def export(
    name: str, output: Path | None, user_path: Path | None, force: bool, as_json: bool
) -> None:
    """Export a profile to a file, without your own values.

    Ranges, filter and timing are yours: they go along only with --user, in a file of their own,
    which 'neurotouch profile import --user' takes in.
    """
    from neurotouch_hid.players import find_user_file
    from neurotouch_hid.profile import check_profile
    from neurotouch_hid.profile.editing import ProfileText, forget_schema, read_text
    from neurotouch_hid.profile.reading import find_profile, find_shipped_folder

    if output == Path("-"):
        output = None
    path = find_profile(name)
    checked = check_profile(path)
    profile = checked.require()
    shared = forget_schema(ProfileText(checked.text))
    files = {} if output is None else {output: shared}
    if user_path is not None:
        if not find_user_file().exists():
            raise ProfileError(
                "You have no values of your own yet.", hint="Make them: neurotouch calibrate"
            )
        files[user_path] = forget_schema(read_text(find_user_file())[0])
    for target in () if force else files:
        if target.exists():
            raise ProfileError(f"'{target}' exists already.", hint="Add --force to overwrite it.")
    for target, text in files.items():
        save_text(target, text.text)
    notes = tuple(
        f"{profile.name} is built on your own '{base}': export that too."
        for base in (checked.written.extends if checked.written is not None else ())
        if find_profile(base).parent != find_shipped_folder()
    )
    if as_json:
        written = [str(target) for target in files]
        content = shared.text if output is None else None
        print_json({"status": "OK", "files": written, "content": content, "notes": list(notes)})
        return
    if output is None:
        echo_file(shared.text)
    for target in files:
        echo(f"OK Saved {target}", err=True)
    for note in notes:
        echo(f"WARNING {note}", err=True)


@click.command(
    "import",
    epilog="\b\nExamples:\n"
    "  neurotouch profile import friend.yaml\n"
    "  neurotouch profile import friend.yaml --name racing-2 --yes\n"
    "  neurotouch profile import --user me.yaml         your own values, on another machine",
)
@click.argument("file", type=click.Path(path_type=Path, readable=False))
@click.option("--name", help="What to call it. Default: the name in the file.")
@click.option("--user", "is_user", is_flag=True, help="FILE has your own values, not a profile.")
@click.option("--yes", is_flag=True, help="Do not ask.")
@json_option
@plain_option
def import_command(
    file: Path, name: str | None, is_user: bool, yes: bool, as_json: bool, plain: bool
) -> None:
    """Import a profile from a file, after showing what it does.

    Nothing in FILE is ever run. With --json nothing is asked: without --yes it only says what would
    change.
    """
    if is_user and name is not None:
        raise WrongUsage(
            "Options --user and --name cannot go together.",
            hint="Leave --name away: your own values have no name.",
        )
    if is_user:
        _take_values(file, yes=yes, as_json=as_json, plain=plain)
    else:
        _take_profile(file, name, yes=yes, as_json=as_json, plain=plain)


def _take_profile(file: Path, name: str | None, *, yes: bool, as_json: bool, plain: bool) -> None:
    from neurotouch_hid.printable import make_printable
    from neurotouch_hid.profile import check_content, load_unused
    from neurotouch_hid.profile.editing import (
        EditedFile,
        ProfileText,
        Store,
        adopt,
        compare,
        find_own_path,
        find_schema,
        hand_over_saved,
        read_text,
        summarize,
    )
    from neurotouch_hid.profile.reading import find_shipped_folder, holds_values

    text, content = read_text(file)
    if holds_values(content):
        raise ProfileError(
            f"'{file}' has a person's own values, and is no profile.",
            hint=f"Import them: neurotouch profile import --user {shlex.quote(str(file))}",
        )
    checked = check_content(content, make_printable(str(file)), unused=load_unused())
    profile = checked.require()
    stem = name if name is not None else profile.name
    own = find_own_path(stem)
    schema = find_schema(own)
    text = adopt(text, stem, schema)
    old_text, old = read_text(own) if own.exists() else (ProfileText(""), None)
    shipped = find_shipped_folder() / own.name
    if old is None and shipped.exists():
        lines = compare(adopt(read_text(shipped)[0], stem, schema), text)
    else:
        lines = compare(old_text, text)
    if old is not None and not lines:
        same = Outcome(f"Your profile '{stem}' is the same, nothing has changed.", file=own)
        same.tell(plain=plain, as_json=as_json)
        return
    if not as_json:
        if old is not None:
            echo(f"You have a profile '{stem}'. This would change:")
            show_changes(lines, plain=plain)
        elif shipped.exists():
            echo(f"'{stem}' would hide the shipped profile. It would differ in:")
            show_changes(lines, plain=plain)
        else:
            echo(f"This profile is new to you. '{stem}' would be:")
            for line in summarize(profile.model_copy(update={"name": stem})):
                echo(line)
        show_faults(checked, plain=plain)
    if not confirm(f"Save it as {own}?", yes=yes, as_json=as_json):
        _decline(own, lines, plain=plain, as_json=as_json)
        return
    EditedFile(stem, Store(own, make_stamp), old, old_text).save(text)
    effect = hand_over_saved(stem)
    saved = Outcome(
        f"Saved {own}",
        effect.status,
        file=own,
        changed=True,
        lines=lines if as_json else (),  # else they have been shown
        checked=checked if as_json else None,
        notes=(effect.text,),
        fix=effect.fix,
    )
    saved.tell(plain=plain, as_json=as_json)


def _take_values(file: Path, *, yes: bool, as_json: bool, plain: bool) -> None:
    """Takes a person's values from a file that ``export --user`` wrote."""
    from neurotouch_hid.printable import make_printable
    from neurotouch_hid.profile import check_user
    from neurotouch_hid.profile.editing import (
        ProfileText,
        adopt,
        compare,
        find_schema,
        hand_over_saved,
        read_text,
        take_user,
    )

    text, content = read_text(file)
    check_user(content, make_printable(str(file))).require()
    edited = take_user(make_stamp)
    path = edited.store.path
    text = adopt(text, "user", find_schema(path, "user-1.json"))
    lines = compare(edited.text if edited.content is not None else ProfileText(""), text)
    if lines and not as_json:
        echo("Your own values would change:")
        show_changes(lines, plain=plain)
    if lines and not confirm(f"Save them as {path}?", yes=yes, as_json=as_json):
        _decline(path, lines, plain=plain, as_json=as_json)
        return
    if not lines:
        same = Outcome("These are your values already, nothing has changed.", file=path)
        same.tell(plain=plain, as_json=as_json)
        return
    edited.save(text)
    effect = hand_over_saved(edited.name)
    outcome = Outcome(
        f"Saved {path}",
        effect.status,
        file=path,
        changed=True,
        lines=lines if as_json else (),
        notes=(effect.text, "Back to those before: neurotouch profile undo user"),
        fix=effect.fix,
    )
    outcome.tell(plain=plain, as_json=as_json)


def _decline(path: Path, lines: list[tuple[str, int, str]], *, plain: bool, as_json: bool) -> None:
    shown = lines if as_json else ()
    Outcome("Nothing was saved.", file=path, lines=shown).tell(plain=plain, as_json=as_json)
