"""Commands about what a profile was before, or is elsewhere."""

from contextlib import suppress

import click

from neurotouch_hid.cli.ui.completing import complete_profile
from neurotouch_hid.cli.ui.outcome import Outcome, report_lines
from neurotouch_hid.cli.ui.output import (
    echo,
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
    from neurotouch_hid.profile.editing import Store, adopt, compare, find_schema, read_text
    from neurotouch_hid.profile.reading import find_profile, find_shipped_folder

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
            f"There is nothing to compare '{name}' with: it is not a copy, and never changed.",
            hint=f"Compare with another: neurotouch profile diff {name} OTHER",
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
    echo(f"from: {base}")
    echo(f"to: {path}")
    show_changes(lines, plain=plain)
    if not lines:
        echo("no difference")


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile history mine\n"
    "  neurotouch profile undo mine --to 3            back to version 3"
)
@click.argument("name", shell_complete=complete_profile)
@json_option
def history(name: str, as_json: bool) -> None:
    """Print the versions of NAME that are kept, newest first."""
    from neurotouch_hid.profile.editing import compare, read_text, take_deleted, take_file

    edited = take_deleted(name, make_stamp) or take_file(name, make_stamp)
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
        words = "1 line differs" if n == 1 else f"{n} lines differ"
        difference = f"{words} from now" if n else "the same as now"
        replaced = _tell_time(str(row["replaced"]))
        echo(f"version {row['version']}: replaced {replaced}, {difference}")
    if not rows:
        echo(f"{path.stem} has never been changed")


def _tell_time(stamp: str) -> str:
    """Returns the name of a version, such as ``2026-11-24 02-13-08``, with colons in its time."""
    day, _, rest = stamp.partition(" ")
    time, _, kind = rest.partition(" ")
    return f"{day} {time.replace('-', ':')}" + (f" by a {kind}" if kind else "")


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
    """Take back the last change; a deleted profile comes back.

    Nothing is lost: what is undone stays in the history of NAME.
    """
    from neurotouch_hid.profile.editing import (
        compare,
        hand_over_restored,
        take_deleted,
        take_file,
    )

    edited = take_deleted(name, make_stamp) or take_file(name, make_stamp)
    version = edited.store.undo() if number is None else edited.store.restore(number)
    now = take_file(edited.name, make_stamp)
    lines = compare(edited.text, now.text)
    effect = hand_over_restored(now)
    was_deleted = edited.content is None and not edited.text.text
    outcome = Outcome(
        f"{edited.name} is back, as in version {version.number}."
        if was_deleted
        else f"{edited.name} is as in version {version.number} again.",
        effect.status,
        file=edited.store.path,
        changed=bool(lines),
        lines=lines if as_json or not was_deleted else (),
        notes=(effect.text,),
        fix=effect.fix,
    )
    outcome.tell(plain=plain, as_json=as_json)


@click.command(epilog="\b\nExamples:\n  neurotouch profile delete mine")
@click.argument("name", shell_complete=complete_profile)
@json_option
@plain_option
def delete(name: str, as_json: bool, plain: bool) -> None:
    """Delete the profile NAME of your own; 'undo' brings it back.

    A shipped profile is never deleted. Your own copy of one is, and then the shipped one is there
    again. A profile that is active, a favourite, or a base of another stays.
    """
    from neurotouch_hid.profile.editing import delete_profile, hand_over_saved

    hidden = delete_profile(name, make_stamp, _list_played())
    effect = hand_over_saved(name) if hidden is not None else None
    again = (f"The profile '{name}' is now: {hidden}",) if hidden is not None else ()
    outcome = Outcome(
        f"Deleted '{name}'.",
        "OK" if effect is None else effect.status,
        changed=True,
        notes=(*again, f"Back: neurotouch profile undo {name}"),
        fix="" if effect is None else effect.fix,
    )
    outcome.tell(plain=plain, as_json=as_json)


def _list_played() -> list[str]:
    """Returns the profiles that drivers play now, and those that applications have chosen."""
    from neurotouch_hid.client import ask_status
    from neurotouch_hid.driver.settings import load_driver_settings
    from neurotouch_hid.errors import DriverError
    from neurotouch_hid.players import list_players

    played = list(load_driver_settings().profile_of.values())
    for player in list_players():
        with suppress(DriverError):
            played.append(ask_status(player)["profile"])
    return played
