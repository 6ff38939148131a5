"""Commands about what a profile was before, or is elsewhere."""

import click

from neurotouch_hid.cli.ui.completing import complete_profile
from neurotouch_hid.cli.ui.outcome import Outcome, report_lines
from neurotouch_hid.cli.ui.output import (
    json_option,
    make_stamp,
    plain_option,
    print_json,
    show_changes,
)
from neurotouch_hid.errors import ProfileError


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile diff racing                 your copy against the shipped one\n"
    "  neurotouch profile diff mine racing            two profiles\n"
    "  neurotouch profile diff mine --last            what the last change did"
)
@click.argument("name", shell_complete=complete_profile)
@click.argument("other", required=False, shell_complete=complete_profile)
@click.option("--last", is_flag=True, help="Compare with the version before the last change.")
@json_option
@plain_option
def diff(name: str, other: str | None, last: bool, as_json: bool, plain: bool) -> None:
    """Show in which lines two profiles differ.

    Without OTHER, your own NAME is compared with the shipped one.
    """
    from neurotouch_hid.profile.editing import Store, adopt, compare, read_text
    from neurotouch_hid.profile.editing.edited_file import find_schema
    from neurotouch_hid.profile.reading.library import find_profile, find_shipped_folder

    path = find_profile(name)
    shipped = find_shipped_folder() / path.name
    versions = Store(path, str).versions()
    if other is not None:
        base = find_profile(other)
    elif shipped.exists() and shipped != path and not last:
        base = shipped
    elif versions:
        base = versions[0].path
    else:
        raise ProfileError(
            f"there is nothing to compare '{name}' with: it is not a copy, and never changed",
            hint=f"neurotouch profile diff {name} OTHER",
        )
    before = read_text(base)[0]
    if base == shipped:  # the schema line differs in every copy
        before = adopt(before, path.stem, find_schema(path))
    lines = compare(before, read_text(path)[0])
    if as_json:
        print_json(
            {
                "from": str(base),
                "to": str(path),
                "lines": report_lines(lines),
            }
        )
        return
    click.echo(f"from: {base}")
    click.echo(f"to: {path}")
    show_changes(lines, plain=plain)
    if not lines:
        click.echo("no difference")


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile history mine\n"
    "  neurotouch profile undo mine --to 3            back to version 3"
)
@click.argument("name", shell_complete=complete_profile)
@json_option
def history(name: str, as_json: bool) -> None:
    """Print the versions of NAME that are kept, newest first."""
    from neurotouch_hid.profile.editing import compare, read_text, take_paper

    edited = take_paper(name, make_stamp)
    path = edited.store.path
    rows = [
        {
            "version": version.number,
            "replaced": version.stamp.replace("_", " "),
            "lines_different_now": len(compare(read_text(version.path)[0], edited.text)),
            "path": str(version.path),
        }
        for version in edited.store.versions()
    ]
    if as_json:
        print_json(rows)
        return
    for row in rows:
        n = row["lines_different_now"]
        difference = f"{n} lines differ from now" if n else "the same as now"
        click.echo(f"version {row['version']}: replaced {row['replaced']}, {difference}")
    if not rows:
        click.echo(f"{path.stem} has never been changed")


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile undo mine              take back the last change; again, the one before\n"
    "  neurotouch profile undo mine --to 3       back to version 3 of 'profile history'"
)
@click.argument("name", shell_complete=complete_profile)
@click.option("--to", "number", type=click.IntRange(min=1), help="The version to go back to.")
@json_option
@plain_option
def undo(name: str, number: int | None, as_json: bool, plain: bool) -> None:
    """Take back the last change.

    Nothing is lost: what is undone stays in the history of NAME.
    """
    from neurotouch_hid.profile.editing import compare, read_text, take_paper

    edited = take_paper(name, make_stamp)
    version = edited.store.undo() if number is None else edited.store.restore(number)
    lines = compare(edited.text, read_text(edited.store.path)[0])
    message = f"{edited.name} is as in version {version.number} again."
    outcome = Outcome(message, file=edited.store.path, changed=bool(lines), lines=lines)
    outcome.tell(plain=plain, as_json=as_json)
