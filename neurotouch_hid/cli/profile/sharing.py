"""Commands that give profiles to others and take theirs."""

from pathlib import Path

import click

from neurotouch_hid.cli.completing import complete_profile
from neurotouch_hid.cli.output import make_stamp, plain_option, say, show_changes
from neurotouch_hid.cli.profile.saving import show_warnings
from neurotouch_hid.errors import ProfileError


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile export mine > mine.yaml\n"
    "  neurotouch profile export mine --output mine.yaml --user me.yaml"
)
@click.argument("name", shell_complete=complete_profile)
@click.option(
    "--output", type=click.Path(path_type=Path, dir_okay=False), help="The file to write."
)
@click.option(
    "--user",
    "user_path",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write your own values too (ranges, filter, timing), to this file.",
)
@click.option("--force", is_flag=True, help="Overwrite files.")
def export(name: str, output: Path | None, user_path: Path | None, force: bool) -> None:
    """Give a profile away, without your own values.

    Ranges, filter and timing are yours: they go along only with --user, in a file of their own.
    """
    from neurotouch_hid.profile import check_profile
    from neurotouch_hid.profile.editing import read_text
    from neurotouch_hid.profile.library import find_profile, find_shipped_folder, find_user_file

    path = find_profile(name)
    profile = check_profile(path).require()
    written = check_profile(path).written
    text = read_text(path)[0]
    if output is None:
        click.echo(text, nl=False)
    else:
        _write(output, text, force=force)
    if user_path is not None:
        if not find_user_file().exists():
            raise ProfileError(
                "you have no values of your own yet", hint="Make them: neurotouch calibrate"
            )
        _write(user_path, read_text(find_user_file())[0], force=force)
    for base in written.extends if written is not None else ():
        if find_profile(base).parent != find_shipped_folder():
            click.echo(
                f"WARNING {profile.name} is built on your own '{base}': export that too.", err=True
            )


def _write(path: Path, text: str, *, force: bool) -> None:
    from neurotouch_hid.profile.editing.store import write_whole

    if path.exists() and not force:
        raise ProfileError(f"{path} exists already", hint="Add --force to overwrite it.")
    try:
        write_whole(path, text.encode("utf-8"))
    except OSError as error:
        raise ProfileError(f"{path} cannot be written: {error.strerror}") from None
    click.echo(f"OK Saved {path}", err=True)


@click.command(
    "import",
    epilog="\b\nExamples:\n"
    "  neurotouch profile import friend.yaml\n"
    "  neurotouch profile import friend.yaml --name racing-2 --yes",
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--name", help="What to call it. Default: the name in the file.")
@click.option("--yes", is_flag=True, help="Do not ask.")
@plain_option
def import_command(file: Path, name: str | None, yes: bool, plain: bool) -> None:
    """Take a profile from a file, after showing what it does.

    Nothing in FILE is ever run.
    """
    from neurotouch_hid.profile import check_content
    from neurotouch_hid.profile.editing import Paper, Store, adopt, compare, find_own_path
    from neurotouch_hid.profile.editing.desk import find_schema, read_text
    from neurotouch_hid.profile.editing.summary import summarize
    from neurotouch_hid.profile.faults import make_printable
    from neurotouch_hid.profile.library import find_shipped_folder

    text, content = read_text(file)
    checked = check_content(content, make_printable(str(file)))
    profile = checked.require()
    stem = name if name is not None else profile.name
    own = find_own_path(stem)
    schema = find_schema(own)
    text = adopt(text, stem, schema)
    old_text, old = read_text(own) if own.exists() else ("", None)
    shipped = find_shipped_folder() / own.name
    if old is not None:
        click.echo(f"You have a profile '{stem}'. This would change:")
        show_changes(compare(old_text, text), plain=plain)
    elif shipped.exists():
        click.echo(f"'{stem}' would hide the shipped profile. It would differ in:")
        show_changes(compare(adopt(read_text(shipped)[0], stem, schema), text), plain=plain)
    else:
        click.echo(f"This profile is new to you. '{stem}' would be:")
        for line in summarize(profile):
            click.echo(line)
    show_warnings(checked, plain=plain)
    if not yes and not click.confirm(f"Save it as {own}?", default=False):
        say("OK", "Nothing was saved.", plain=plain)
        return
    Paper(stem, Store(own, make_stamp), old, old_text).save(text)
    say("OK", f"Saved {own}", plain=plain)


COMMANDS = (export, import_command)
