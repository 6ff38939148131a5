"""Commands that find out whether a profile does what it should."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neurotouch_hid.cli.profile.looking import show_misnamed
from neurotouch_hid.cli.ui.completing import complete_profile
from neurotouch_hid.cli.ui.outcome import report_faults, show_faults
from neurotouch_hid.cli.ui.output import echo, json_option, plain_option, print_json, say
from neurotouch_hid.cli.ui.usage_errors import WrongUsage
from neurotouch_hid.errors import NeuroTouchError, ProfileError
from neurotouch_hid.printable import make_printable

if TYPE_CHECKING:
    from neurotouch_hid.profile import Checked


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile check                     all profiles, and your own values\n"
    "  neurotouch profile check mine ./draft.yaml\n"
    "  neurotouch profile check user                your own values only\n"
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
    from neurotouch_hid.players import find_user_file
    from neurotouch_hid.profile import check_profile, list_profiles, load_unused
    from neurotouch_hid.profile.reading import OWN_VALUES

    found: list[Checked[Any]] = []
    failures: list[NeuroTouchError] = []
    unused = load_unused()
    own = [OWN_VALUES] if find_user_file().exists() else []
    for name in names or [*list_profiles(), *own]:
        try:
            found.append(_check_values(name) or check_profile(name, unused))
        except ProfileError as error:
            failures.append(error)
    n_errors = len(failures)
    for checked in found:
        errors = [fault for fault in checked.faults if fault.severity == "error"]
        n_errors += len(errors)
        if not as_json:
            show_faults(checked, plain=plain)
            if not errors:
                n_warnings = len(checked.faults)
                count = f"{n_warnings} warning{'s' if n_warnings != 1 else ''}"
                say("OK", f"{checked.name}: {count if n_warnings else 'no faults'}", plain=plain)
    if as_json:
        print_json([*map(_report_failure, failures), *(r for c in found for r in report_faults(c))])
    for failure in failures if not as_json else ():
        say("FAILED", failure.message, failure.hint or "", plain=plain)
    if not names and not as_json:
        show_misnamed(plain=plain)
    if n_errors:
        if not as_json:
            say("FAILED", f"{n_errors} error{'s' if n_errors != 1 else ''}", plain=plain)
        sys.exit(ProfileError.exit_code)


def _check_values(name: str) -> "Checked[Any] | None":
    """Returns the faults of a person's own values; None if the name or path is of a profile."""
    from neurotouch_hid.files.small_file import means_path
    from neurotouch_hid.profile import check_user
    from neurotouch_hid.profile.editing import read_text, take_user
    from neurotouch_hid.profile.reading import OWN_VALUES, holds_values

    if name == OWN_VALUES:
        edited = take_user(str)
        return edited.check(edited.text)
    if not means_path(name) or not Path(name).is_file():
        return None
    content = read_text(Path(name))[1]
    return check_user(content, make_printable(name)) if holds_values(content) else None


def _report_failure(error: NeuroTouchError) -> dict[str, Any]:
    nowhere = dict.fromkeys(("file", "line", "col", "end", "code"))
    return nowhere | {"severity": "error", "message": error.message, "fix": error.hint}


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
    from neurotouch_hid.profile.editing import TOUR, read_text

    if script is not None and script_path is not None:
        raise WrongUsage(
            "Options --script and --file cannot go together.", hint="Leave one of them away."
        )
    text = script if script is not None else read_text(script_path)[0].text if script_path else TOUR
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
        echo(str(moment))
