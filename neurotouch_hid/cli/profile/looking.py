"""Commands that read profiles and change nothing."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neurotouch_hid.cli.completing import complete_profile
from neurotouch_hid.cli.output import json_option, plain_option, print_json, say, show_changes
from neurotouch_hid.cli.profile.saving import show_warnings
from neurotouch_hid.errors import NeuroTouchError, ProfileError

if TYPE_CHECKING:
    from neurotouch_hid.profile import Checked
    from neurotouch_hid.profile.faults import Mark


@click.command(
    "list",
    epilog="\b\nExamples:\n  neurotouch profile list\n  neurotouch profile list --json | jq .",
)
@json_option
@plain_option
def list_command(as_json: bool, plain: bool) -> None:
    """Print every profile: yours and those shipped."""
    from neurotouch_hid.profile import check_profile, list_profiles, load_user
    from neurotouch_hid.profile.library import find_shipped_folder

    shipped = find_shipped_folder()
    favourites = load_user().slots
    rows = []
    for name, path in list_profiles().items():
        checked = check_profile(path)
        rows.append(
            {
                "name": name,
                "path": str(path),
                "own": path.parent != shipped,
                "status": "FAILED" if checked.written is None else "OK",
                "in_use": name == favourites[0],
                "description": checked.written.description if checked.written else "",
            }
        )
    if as_json:
        print_json(rows)
        return
    for row in rows:
        notes = ["yours" if row["own"] else "shipped"] + (["in use"] if row["in_use"] else [])
        text = row["description"] or "it has errors, see: neurotouch profile check"
        if plain:
            say(str(row["status"]), f"{row['name']}, {', '.join(notes)}: {text}")
        else:
            mark = "!" if row["status"] != "OK" else "*" if row["in_use"] else " "
            click.echo(f"{mark} {row['name']:<18} {notes[0]:<8} {text}")


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile show racing\n"
    "  neurotouch profile show mine --effective      with all it is built on, and your own values"
)
@click.argument("name", shell_complete=complete_profile)
@click.option(
    "--effective",
    is_flag=True,
    help="What holds in the end: with what it is built on, your values, all times.",
)
@json_option
@plain_option
def show(name: str, effective: bool, as_json: bool, plain: bool) -> None:
    """Say in words what the profile NAME does."""
    from neurotouch_hid.profile import check_profile, load_user
    from neurotouch_hid.profile.editing.summary import summarize
    from neurotouch_hid.profile.library import find_profile

    path = find_profile(name)
    checked = check_profile(path)
    whole = checked.require()
    written = whole if effective else checked.written or whole
    user = load_user() if effective else None
    if as_json:
        shown = written.model_dump(mode="json", exclude_unset=not effective)
        values = {"user": user.model_dump(mode="json")} if user is not None else {}
        print_json({"file": str(path), "profile": shown, **values})
        return
    click.echo(f"file: {path}")
    for line in summarize(written, user):
        click.echo(line.strip() if plain else line)


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile check                     all profiles, and your own values\n"
    "  neurotouch profile check mine ./draft.yaml\n"
    "  neurotouch profile check mine --json\n\n"
    "Exit code: 6 if there are errors; 0 if not, warnings or none."
)
@click.argument("names", nargs=-1, metavar="[NAME|PATH]...", shell_complete=complete_profile)
@json_option
@plain_option
def check(names: tuple[str, ...], as_json: bool, plain: bool) -> None:
    """Find every mistake: what is wrong, risky or without effect.

    Without a NAME, all profiles that can be loaded by name are checked, and your own values.
    """
    from neurotouch_hid.profile import check_profile, list_profiles
    from neurotouch_hid.profile.library import find_user_file

    found: list[Checked[Any]] = []
    failures: list[NeuroTouchError] = []
    for name in names or list_profiles():
        try:
            found.append(check_profile(name))
        except ProfileError as error:
            failures.append(error)
    if not names and find_user_file().exists():
        from neurotouch_hid.profile.editing import take_user

        paper = take_user(str)
        found.append(paper.check(paper.text))
    n_errors = len(failures)
    for checked in found:
        errors = [fault for fault in checked.faults if fault.severity == "error"]
        n_errors += len(errors)
        if not as_json:
            show_warnings(checked, plain=plain)
            if not errors:
                n_warnings = len(checked.faults)
                count = f"{n_warnings} warning{'s' if n_warnings != 1 else ''}"
                say("OK", f"{checked.name}: {count if n_warnings else 'no faults'}", plain=plain)
    if as_json:
        print_json([*map(_report_failure, failures), *(r for c in found for r in _report(c))])
    for failure in failures if not as_json else ():
        say("FAILED", failure.message, failure.hint or "", plain=plain)
    if n_errors:
        if not as_json:
            say("FAILED", f"{n_errors} error{'s' if n_errors != 1 else ''}", plain=plain)
        sys.exit(ProfileError.exit_code)


def _find_end(mark: "Mark", lines: list[str]) -> int:
    """The column after the last one, from 1 on; a mark may say "to the end of the line"."""
    length = len(lines[mark.line]) if mark.line < len(lines) else 0
    return 1 + max(mark.column + 1, min(mark.column + mark.length, length))


def _report(checked: "Checked[Any]") -> list[dict[str, Any]]:
    lines = checked.text.splitlines()
    return [
        {
            "file": checked.name,
            "line": fault.mark.line + 1,
            "col": fault.mark.column + 1,
            "end": _find_end(fault.mark, lines),
            "code": fault.code,
            "severity": fault.severity,
            "path": fault.path,
            "message": fault.sentence,
            "fix": fault.hint or None,
        }
        for fault in checked.faults
    ]


def _report_failure(error: NeuroTouchError) -> dict[str, Any]:
    nowhere = dict.fromkeys(("file", "line", "col", "end", "code"))
    return nowhere | {"severity": "error", "message": error.message, "fix": error.hint}


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
    from neurotouch_hid.profile.editing.desk import find_schema
    from neurotouch_hid.profile.library import find_profile, find_shipped_folder

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
                "lines": [{"verb": v, "line": n, "text": text} for v, n, text in lines],
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
    from neurotouch_hid.profile.editing import Store, compare, read_text
    from neurotouch_hid.profile.library import find_profile

    path = find_profile(name)
    now = read_text(path)[0]
    rows = [
        {
            "version": version.number,
            "replaced": version.stamp.replace("_", " "),
            "lines_different_now": len(compare(read_text(version.path)[0], now)),
            "path": str(version.path),
        }
        for version in Store(path, str).versions()
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
    "  neurotouch profile test racing\n"
    '  neurotouch profile test mine --script "push left 5mm 300ms hold 1s; rest 500ms; pinch tap"\n'
    "  neurotouch profile test mine --file moves.txt --user"
)
@click.argument("name", shell_complete=complete_profile)
@click.option("--script", help="Gestures to play, ';' between them. Default: all, short and held.")
@click.option(
    "--file",
    "script_path",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="A file with gestures to play.",
)
@click.option("--user", "with_user", is_flag=True, help="With your own values.")
@json_option
def test(
    name: str, script: str | None, script_path: Path | None, with_user: bool, as_json: bool
) -> None:
    """Play scripted gestures and print what comes out.

    A step is GESTURE [WAY] [AMOUNT] [TIME] [hold TIME] [release TIME] [tap] [fingers N]
    [tremor HZ MM], or rest TIME.
    """
    from neurotouch_hid.profile import Mapping, load_profile, load_user, perform, rehearse
    from neurotouch_hid.profile.editing import read_text
    from neurotouch_hid.profile.editing.summary import TOUR

    if script is not None and script_path is not None:
        raise click.UsageError("--script and --file cannot go together")
    text = script if script is not None else read_text(script_path)[0] if script_path else TOUR
    mapping = Mapping(load_profile(name), load_user() if with_user else None)
    moments = perform(mapping, rehearse(text))
    if as_json:
        print_json(
            [
                {"t_us": moment.t_us, "gesture": moment.gesture, "changes": moment.changes}
                for moment in moments
            ]
        )
        return
    for moment in moments:
        click.echo(str(moment))


COMMANDS = (list_command, show, check, diff, history, test)
