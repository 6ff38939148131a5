"""``neurotouch schema``: prints the file formats, for editors."""

import click

from neurotouch_hid.cli.ui.output import print_json


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch schema > profile-1.json\n"
    "  neurotouch schema user\n"
    "  neurotouch schema gel\n"
    "  neurotouch schema --line            the first line of a profile, for editors"
)
@click.argument("what", type=click.Choice(["profile", "user", "gel"]), default="profile")
@click.option("--line", is_flag=True, help="Print the line that refers an editor to the schema.")
def command(what: str, line: bool) -> None:
    """Print the JSON Schema of a profile, of your own values (user) or of a gel."""
    from neurotouch_hid.driver.gel_file import find_gel_folder
    from neurotouch_hid.driver.gel_settings import gel_schema
    from neurotouch_hid.players import find_user_file
    from neurotouch_hid.profile import profile_schema, user_schema
    from neurotouch_hid.profile.editing import MODELINE, find_schema
    from neurotouch_hid.profile.reading import find_user_folder

    if line:
        paths = {
            "profile": find_user_folder() / "any.yaml",
            "user": find_user_file(),
            "gel": find_gel_folder() / "gel.yaml",
        }
        path = paths[what]
        click.echo(MODELINE + find_schema(path, f"{what}-1.json"))
    else:
        print_json({"profile": profile_schema, "user": user_schema, "gel": gel_schema}[what]())
