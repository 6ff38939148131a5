"""``neurotouch schema``: prints the file formats, for editors."""

import click

from neurotouch_hid.cli.ui.output import print_json


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch schema > profile-1.json\n"
    "  neurotouch schema user\n"
    "  neurotouch schema --line            the first line of a profile, for editors"
)
@click.argument("what", type=click.Choice(["profile", "user"]), default="profile")
@click.option("--line", is_flag=True, help="Print the line that refers an editor to the schema.")
def command(what: str, line: bool) -> None:
    """Print the JSON Schema of a profile, or of your own values (user)."""
    from neurotouch_hid.players import find_user_file
    from neurotouch_hid.profile import profile_schema, user_schema
    from neurotouch_hid.profile.editing import MODELINE, find_schema
    from neurotouch_hid.profile.reading import find_user_folder

    if line:
        path = find_user_file() if what == "user" else find_user_folder() / "any.yaml"
        click.echo(MODELINE + find_schema(path, f"{what}-1.json"))
    else:
        print_json(profile_schema() if what == "profile" else user_schema())
