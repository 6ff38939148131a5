"""Commands that say which profiles there are and what they do."""

import shlex
import shutil
import textwrap
from pathlib import Path

import click

from neurotouch_hid.cli.ui.completing import complete_profile
from neurotouch_hid.cli.ui.output import echo, json_option, plain_option, print_json, say


@click.command(
    "list",
    epilog="\b\nExamples:\n  neurotouch profile list\n  neurotouch profile list --json | jq .",
)
@json_option
@plain_option
def list_command(as_json: bool, plain: bool) -> None:
    """Print every profile: yours and those shipped."""
    from neurotouch_hid.profile import list_profiles, load_user
    from neurotouch_hid.profile.reading import check_listed, find_shipped_folder, find_user_folder

    places = {find_user_folder(): "yours", find_shipped_folder(): "shipped"}
    favourites = load_user().slots
    rows = []
    for name, path in list_profiles().items():
        checked = check_listed(path)
        rows.append(
            {
                "name": name,
                "path": str(path),
                "own": path.parent in places and places[path.parent] == "yours",
                "status": "FAILED" if checked.written is None else "OK",
                "in_use": name == favourites[0],
                "description": checked.written.description if checked.written else "",
            }
        )
    if as_json:
        print_json(rows)
        return
    for row in rows:
        place = places.get(Path(str(row["path"])).parent, "for all")  # as the machine's are
        notes = [place, *(["in use"] if row["in_use"] else [])]
        said = " ".join(str(row["description"]).split())
        if row["status"] != "OK":
            said = f"it has errors, see: neurotouch profile check {row['name']}"
        text = said or "no description"
        if plain:
            wrong = "FAILED " if row["status"] != "OK" else ""
            echo(f"{wrong}{row['name']}, {', '.join(notes)}: {text}")
        else:
            mark = "!" if row["status"] != "OK" else "*" if row["in_use"] else " "
            head = f"{mark} {row['name']:<18} {notes[0]:<8} "
            width = shutil.get_terminal_size().columns
            indent = " " * (len(head) if width > 2 * len(head) else 4)
            echo(textwrap.fill(f"{head}{text}", width, subsequent_indent=indent))
    show_misnamed(plain=plain)


def show_misnamed(*, plain: bool) -> None:
    """Says which files among the profiles are not used, because of their names."""
    from neurotouch_hid.profile.reading import list_misnamed

    for path, free in list_misnamed().items():
        fix = shlex.join(["mv", str(path), str(free)])
        say("WARNING", f"'{path}' is not used, because of its name.", fix, plain=plain)


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile show racing\n"
    "  neurotouch profile show mine --effective      with all it is built on, and your own values\n"
    "  neurotouch profile show user                  your own values"
)
@click.argument("name", shell_complete=complete_profile)
@click.option(
    "--effective",
    is_flag=True,
    help="What applies in the end: with its base profiles, your values, all times.",
)
@json_option
@plain_option
def show(name: str, effective: bool, as_json: bool, plain: bool) -> None:
    """Say in words what the profile NAME does."""
    from neurotouch_hid.profile import check_profile, load_user
    from neurotouch_hid.profile.editing import summarize
    from neurotouch_hid.profile.reading import OWN_VALUES, find_profile

    if name == OWN_VALUES:
        _show_values(as_json=as_json)
        return
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
    echo(f"file: {path}")
    for line in summarize(written, user):
        echo(line.strip() if plain else line)


def _show_values(*, as_json: bool) -> None:
    from neurotouch_hid.players import find_user_file
    from neurotouch_hid.profile import load_user
    from neurotouch_hid.profile.editing import format_value
    from neurotouch_hid.profile.reading import find_values

    path, applied = find_user_file(), find_values()
    values = load_user().model_dump(mode="json", exclude_none=True)
    if as_json:
        print_json({"file": str(path), "user": values})
        return
    echo(f"file: {path}{'' if path.exists() else ', not there yet'}")
    if applied != path and applied.exists():
        echo(f"until then, the machine's: {applied}")
    for key, value in values.items():
        echo(f"{key}: {format_value(value)}")
