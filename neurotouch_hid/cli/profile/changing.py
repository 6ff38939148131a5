"""Commands that change profiles, one thing at a time."""

import click

from neurotouch_hid.cli.profile.saving import save_edited
from neurotouch_hid.cli.ui.completing import complete_key, complete_paper, complete_profile
from neurotouch_hid.cli.ui.outcome import Outcome
from neurotouch_hid.cli.ui.output import json_option, make_stamp, plain_option


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
@json_option
@plain_option
def new(name: str, template: str, as_json: bool, plain: bool) -> None:
    """Make a profile of your own as a copy of another.

    What needs a movement that you do not use goes to another one, as far as one is free.
    """
    from neurotouch_hid.profile import load_unused
    from neurotouch_hid.profile.editing import avoid, make_profile

    edited = make_profile(name, template, make_stamp)
    edited.check(edited.text).require()
    mine = avoid(edited.text, load_unused())
    edited.save(mine.text)
    path = edited.store.path
    outcome = Outcome(
        f"Saved {path}",
        file=path,
        changed=True,
        checked=edited.check(mine.text),
        notes=(
            *(f"For you: {what}" for what in mine.moved),
            *(f"For you, without a gesture: {what}" for what in mine.left),
            f"Next: neurotouch profile edit {name}",
        ),
    )
    outcome.tell(plain=plain, as_json=as_json)


@click.command(
    "set",
    context_settings={"ignore_unknown_options": True},
    epilog="\b\nExamples:\n"
    "  neurotouch profile set mine push.curve.expo 0.4\n"
    '  neurotouch profile set mine zoom.range_mm "[1, 3.5]"\n'
    "  neurotouch profile set mine layers.menu.push_left_tap.dpad up\n"
    "  neurotouch profile set mine timing steady\n"
    "  neurotouch profile set mine push.gain --default\n"
    "  neurotouch profile set user filter strong",
)
@click.argument("name", shell_complete=complete_paper)
@click.argument("key", shell_complete=complete_key)
@click.argument("value", required=False)
@click.option(
    "--default", "to_default", is_flag=True, help="Remove it, so that its default applies."
)
@json_option
@plain_option
def set_command(
    name: str, key: str, value: str | None, to_default: bool, as_json: bool, plain: bool
) -> None:
    """Set one value; nothing else in the file changes.

    A KEY is the gesture of a binding and what is set in it, or any key of the file. The NAME user
    is your own values: filter, timing, handedness, feedback.sound and others.
    """
    from neurotouch_hid.profile.editing import parse_value, reset_value, set_value, take_paper

    if to_default == (value is not None):
        raise click.UsageError("give a VALUE, or --default")
    edited = take_paper(name, make_stamp)
    text = (
        reset_value(edited.text, key, edited.model)
        if value is None
        else set_value(edited.text, key, parse_value(value), edited.model)
    )
    save_edited(edited, text, plain=plain, as_json=as_json)


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
@json_option
@plain_option
def bind(
    name: str, when: str, do: str, layer: str | None, add: bool, as_json: bool, plain: bool
) -> None:
    """Let a gesture do something.

    WHEN is a gesture (push, pinch, zoom, twist cw, twist ccw, twist, scale, any), perhaps with a
    direction (left, up right), tap, double, hold or long, soft or hard, from 7 mm, at the centre,
    with 2 fingers; or gestures with then between them.

    DO is stick, axis, trigger, button, dpad, key, mouse or layer and which one, or pause, panic,
    rezero or next profile; perhaps after toggle, sticky, oneshot or turbo.
    """
    from neurotouch_hid.profile.editing import bind as bind_text
    from neurotouch_hid.profile.editing import parse_do, parse_when, take_profile

    edited = take_profile(name, make_stamp)
    text = bind_text(edited.text, parse_when(when), parse_do(do), layer, add=add)
    save_edited(edited, text, plain=plain, as_json=as_json)


@click.command(
    epilog="\b\nExamples:\n"
    '  neurotouch profile unbind mine "pinch hold"\n'
    '  neurotouch profile unbind mine "push left tap" "key ctrl+c" --layer menu'
)
@click.argument("name", shell_complete=complete_profile)
@click.argument("when")
@click.argument("do", required=False)
@click.option("--layer", help="The layer. Default: the first.")
@json_option
@plain_option
def unbind(
    name: str, when: str, do: str | None, layer: str | None, as_json: bool, plain: bool
) -> None:
    """Let a gesture no longer do something.

    Without DO, WHEN no longer does anything. The words are those of bind.
    """
    from neurotouch_hid.profile.editing import parse_do, parse_when, take_profile
    from neurotouch_hid.profile.editing import unbind as unbind_text

    edited = take_profile(name, make_stamp)
    what = parse_do(do) if do is not None else None
    save_edited(
        edited,
        unbind_text(edited.text, parse_when(when), what, layer),
        plain=plain,
        as_json=as_json,
    )


@click.command(epilog="\b\nExamples:\n  neurotouch profile upgrade mine")
@click.argument("name", shell_complete=complete_profile)
@json_option
@plain_option
def upgrade(name: str, as_json: bool, plain: bool) -> None:
    """Rewrite a profile in the present format.

    The old one stays in the history of NAME.
    """
    from neurotouch_hid.profile.editing import take_profile
    from neurotouch_hid.profile.editing import upgrade as upgrade_text
    from neurotouch_hid.profile.editing.edited_file import find_schema

    edited = take_profile(name, make_stamp)
    text = upgrade_text(edited.text, find_schema(edited.store.path))
    if text == edited.text:
        current = Outcome(f"{edited.name} is of the current version.", file=edited.store.path)
        current.tell(plain=plain, as_json=as_json)
        return
    save_edited(edited, text, plain=plain, as_json=as_json)


@click.command(epilog="\b\nExamples:\n  neurotouch profile use racing")
@click.argument("name", shell_complete=complete_profile)
@json_option
@plain_option
def use(name: str, as_json: bool, plain: bool) -> None:
    """Play with a profile from now on.

    A running driver switches to NAME, and NAME becomes the first of your favourites.
    """
    from neurotouch_hid.client import ask
    from neurotouch_hid.errors import NotRunningError, ProfileError
    from neurotouch_hid.profile import load_profile, load_user
    from neurotouch_hid.profile.editing import compare, set_value, take_user
    from neurotouch_hid.profile.reading.library import find_profile, list_profiles
    from neurotouch_hid.profile.schema.user import UserSettings

    load_profile(name)
    path = find_profile(name)
    stem = path.stem
    known = list_profiles().get(stem)
    if known is None or known.resolve() != path.resolve():
        raise ProfileError(
            f"{path} is not among your profiles",
            hint=f"Import it first: neurotouch profile import {name}",
        )
    slots = [stem, *(slot for slot in load_user().slots if slot != stem)]
    edited = take_user(make_stamp)
    text = set_value(edited.text, "slots", slots[:8], UserSettings)
    edited.save(text, keep=False)  # no version: the versions kept are calibrations
    try:
        note = str(ask("use", profile=stem)["text"])
    except NotRunningError:
        note = "No driver is running; it holds from the next start."
    outcome = Outcome(
        f"{stem} is the first of your favourites.",
        file=edited.store.path,
        changed=text != edited.text,
        lines=compare(edited.text, text) if as_json else (),
        notes=(note,),
    )
    outcome.tell(plain=plain, as_json=as_json)
