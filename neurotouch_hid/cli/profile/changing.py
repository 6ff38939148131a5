"""Commands that change profiles, one thing at a time."""

import click

from neurotouch_hid.cli.completing import complete_key, complete_profile
from neurotouch_hid.cli.output import make_stamp, plain_option, say, show_changes
from neurotouch_hid.cli.profile.saving import save_paper


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile new mine\n"
    "  neurotouch profile new mine --template push-only"
)
@click.argument("name")
@click.option(
    "--template",
    default="default",
    show_default=True,
    shell_complete=complete_profile,
    help="The profile to begin with.",
)
@plain_option
def new(name: str, template: str, plain: bool) -> None:
    """Make a profile of your own as a copy of another."""
    from neurotouch_hid.profile.editing import make_profile

    paper = make_profile(name, template, make_stamp)
    paper.save(paper.text)
    say("OK", f"Saved {paper.store.path}", plain=plain)
    click.echo(f"Next: neurotouch profile edit {name}")


@click.command(
    "set",
    context_settings={"ignore_unknown_options": True},
    epilog="\b\nExamples:\n"
    "  neurotouch profile set mine push.curve.expo 0.4\n"
    '  neurotouch profile set mine zoom.range_mm "[1, 3.5]"\n'
    "  neurotouch profile set mine layers.menu.push_left_tap.dpad up\n"
    "  neurotouch profile set mine timing steady\n"
    "  neurotouch profile set mine push.gain --default",
)
@click.argument("name", shell_complete=complete_profile)
@click.argument("key", shell_complete=complete_key)
@click.argument("value", required=False)
@click.option("--default", "to_default", is_flag=True, help="Remove it, so its default holds.")
@plain_option
def set_command(name: str, key: str, value: str | None, to_default: bool, plain: bool) -> None:
    """Set one value; nothing else in the file changes.

    A KEY is the gesture of a binding and what is set in it, or any key of the file.
    """
    from neurotouch_hid.profile.editing import parse_value, reset_value, set_value, take_profile

    if to_default == (value is not None):
        raise click.UsageError("give a VALUE, or --default")
    paper = take_profile(name, make_stamp)
    text = (
        reset_value(paper.text, key)
        if value is None
        else set_value(paper.text, key, parse_value(value))
    )
    save_paper(paper, text, plain=plain)


@click.command(
    epilog="\b\nExamples:\n"
    '  neurotouch profile bind mine "pinch hold" "button a"\n'
    '  neurotouch profile bind mine "push left tap" "key ctrl+c"\n'
    '  neurotouch profile bind mine "push left then pinch" "layer menu"\n'
    '  neurotouch profile bind mine twist_cw "axis right_x +" --layer fly',
    context_settings={"ignore_unknown_options": True},
)
@click.argument("name", shell_complete=complete_profile)
@click.argument("when")
@click.argument("do")
@click.option("--layer", help="The layer. Default: the first.")
@click.option("--add", is_flag=True, help="Keep what WHEN does already, and do this too.")
@plain_option
def bind(name: str, when: str, do: str, layer: str | None, add: bool, plain: bool) -> None:
    """Let a gesture do something.

    WHEN is a gesture (push, pinch, zoom, twist cw, twist ccw, twist, scale, any), perhaps with a
    direction (left, up right), tap, double, hold or long, soft or hard, from 7 mm, at the centre,
    with 2 fingers; or gestures with then between them.

    DO is stick, axis, trigger, button, dpad, key, mouse or layer and which one, or pause, panic,
    rezero or next profile; perhaps after toggle, sticky, oneshot or turbo.
    """
    from neurotouch_hid.profile.editing import bind as bind_text
    from neurotouch_hid.profile.editing import parse_do, parse_when, take_profile

    paper = take_profile(name, make_stamp)
    text = bind_text(paper.text, parse_when(when), parse_do(do), layer, add=add)
    save_paper(paper, text, plain=plain)


@click.command(
    epilog="\b\nExamples:\n"
    '  neurotouch profile unbind mine "pinch hold"\n'
    '  neurotouch profile unbind mine "push left tap" "key ctrl+c" --layer menu'
)
@click.argument("name", shell_complete=complete_profile)
@click.argument("when")
@click.argument("do", required=False)
@click.option("--layer", help="The layer. Default: the first.")
@plain_option
def unbind(name: str, when: str, do: str | None, layer: str | None, plain: bool) -> None:
    """Let a gesture no longer do something.

    Without DO, WHEN no longer does anything. The words are those of bind.
    """
    from neurotouch_hid.profile.editing import parse_do, parse_when, take_profile
    from neurotouch_hid.profile.editing import unbind as unbind_text

    paper = take_profile(name, make_stamp)
    what = parse_do(do) if do is not None else None
    save_paper(paper, unbind_text(paper.text, parse_when(when), what, layer), plain=plain)


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch profile undo mine              take back the last change; again, the one before\n"
    "  neurotouch profile undo mine --to 3       back to version 3 of 'profile history'"
)
@click.argument("name", shell_complete=complete_profile)
@click.option("--to", "number", type=click.IntRange(min=1), help="The version to go back to.")
@plain_option
def undo(name: str, number: int | None, plain: bool) -> None:
    """Take back the last change.

    Nothing is lost: what is undone stays in the history of NAME.
    """
    from neurotouch_hid.profile.editing import compare, read_text, take_profile

    paper = take_profile(name, make_stamp)
    version = paper.store.undo() if number is None else paper.store.restore(number)
    show_changes(compare(paper.text, read_text(paper.store.path)[0]), plain=plain)
    say("OK", f"{paper.name} is as in version {version.number} again.", plain=plain)


@click.command(epilog="\b\nExamples:\n  neurotouch profile upgrade mine")
@click.argument("name", shell_complete=complete_profile)
@plain_option
def upgrade(name: str, plain: bool) -> None:
    """Rewrite a profile in the present format.

    The old one stays in the history of NAME.
    """
    from neurotouch_hid.profile.editing import take_profile
    from neurotouch_hid.profile.editing import upgrade as upgrade_text
    from neurotouch_hid.profile.editing.desk import find_schema

    paper = take_profile(name, make_stamp)
    text = upgrade_text(paper.text, find_schema(paper.store.path))
    if text == paper.text:
        say("OK", f"{paper.name} is of the present version.", plain=plain)
        return
    save_paper(paper, text, plain=plain)


@click.command(epilog="\b\nExamples:\n  neurotouch profile use racing")
@click.argument("name", shell_complete=complete_profile)
@plain_option
def use(name: str, plain: bool) -> None:
    """Play with a profile from now on.

    A running driver switches to NAME, and NAME becomes the first of your favourites.
    """
    from neurotouch_hid.driver import ask
    from neurotouch_hid.errors import NotRunningError
    from neurotouch_hid.profile import load_profile, load_user
    from neurotouch_hid.profile.editing import set_value, take_user
    from neurotouch_hid.profile.library import find_profile
    from neurotouch_hid.profile.user import UserSettings

    load_profile(name)
    stem = find_profile(name).stem
    slots = [stem, *(slot for slot in load_user().slots if slot != stem)]
    paper = take_user(make_stamp)
    # no version: the versions kept are calibrations
    paper.save(set_value(paper.text, "slots", slots[:8], UserSettings), keep=False)
    say("OK", f"{stem} is the first of your favourites.", plain=plain)
    try:
        say("OK", str(ask("use", profile=stem)["text"]), plain=plain)
    except NotRunningError:
        click.echo("No driver is running; it holds from the next start.")


COMMANDS = (new, set_command, bind, unbind, undo, upgrade, use)
