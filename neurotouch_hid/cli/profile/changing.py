"""Commands that change profiles, one thing at a time."""

from contextlib import suppress
from pathlib import Path

import click

from neurotouch_hid.cli.profile.saving import save_edited, tell_old_words
from neurotouch_hid.cli.ui.completing import complete_file, complete_key, complete_profile
from neurotouch_hid.cli.ui.outcome import Outcome
from neurotouch_hid.cli.ui.output import json_option, make_stamp, plain_option
from neurotouch_hid.cli.ui.usage_errors import SignedCommand, WrongUsage
from neurotouch_hid.errors import ProfileError


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
    from neurotouch_hid.profile import list_profiles, load_unused
    from neurotouch_hid.profile.editing import hand_over_saved, make_profile, remap_unused

    edited = make_profile(name, template, make_stamp)
    edited.check(edited.text).require()
    mine = remap_unused(edited.text, load_unused())
    path = edited.store.path
    before = list_profiles()
    of_own = template in before and before[template].parent == path.parent
    checked = edited.save(mine.text)
    effect = hand_over_saved(name)
    outcome = Outcome(
        f"Saved {path}",
        effect.status,
        fix=effect.fix,
        file=path,
        changed=True,
        checked=checked,
        notes=(
            effect.text,
            *((f"It begins as your own '{template}' is now.",) if of_own else ()),
            *((_tell_hidden(name, before[name]),) if name in before else ()),
            *(f"For you: {what}" for what in mine.moved),
            *(f"For you, without a gesture: {what}" for what in mine.left),
            f"Next: neurotouch profile edit {name}",
        ),
    )
    outcome.tell(plain=plain, as_json=as_json)


def _refuse_name(name: str, other: str | None) -> None:
    """Lets a profile's name be only that of its file, which commands find it by.

    Raises:
        ProfileError: it would be another one.
    """
    if other != name:
        raise ProfileError(
            "A profile is called as its file is, so 'name' was not changed.",
            hint=f"Make a copy: neurotouch profile new {other or 'NAME'} --template {name}",
        )


def _tell_hidden(name: str, hidden: Path) -> str:
    """Returns that a person's new profile takes the place of one for everybody."""
    return (
        f"From now on '{name}' means yours everywhere, and no longer {hidden}. "
        f"Back to that one: neurotouch profile delete {name}"
    )


@click.command(
    "set",
    cls=SignedCommand,
    epilog="\b\nExamples:\n"
    "  neurotouch profile set mine push.curve.expo 0.4\n"
    '  neurotouch profile set mine zoom.range_mm "[1, 3.5]"\n'
    "  neurotouch profile set mine layers.menu.push_left_tap.dpad up\n"
    "  neurotouch profile set mine timing steady\n"
    "  neurotouch profile set mine push.gain --default\n"
    "  neurotouch profile set user filter strong",
)
@click.argument("name", shell_complete=complete_file)
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
    from neurotouch_hid.profile.editing import (
        list_namesakes,
        parse_value,
        reset_value,
        set_value,
        take_file,
    )
    from neurotouch_hid.profile.reading import find_user_folder

    if to_default and value is not None:
        raise WrongUsage(
            "A VALUE and --default cannot go together.", hint="Leave one of them away."
        )
    if not to_default and value is None:
        raise WrongUsage(
            "VALUE is missing.", hint=f"Give one, or: neurotouch profile set {name} {key} --default"
        )
    edited = take_file(name, make_stamp)
    if key == "name" and edited.store.path.parent == find_user_folder():
        _refuse_name(edited.name, value)
    text = (
        reset_value(edited.text, key, edited.model)
        if value is None
        else set_value(edited.text, key, parse_value(value), edited.model)
    )
    own, *others = list_namesakes(edited.text, key, edited.model) or ("",)
    note = f"This was {own}. The same gesture has more bindings: {', '.join(others)}."
    refused = f"'{key}' was not changed"
    notes = (note,) if others else ()
    save_edited(edited, text, notes, refused=refused, plain=plain, as_json=as_json)


@click.command(
    epilog="\b\nExamples:\n"
    '  neurotouch profile bind mine "pinch hold" "button a"\n'
    '  neurotouch profile bind mine "push left tap" "key ctrl+c"\n'
    '  neurotouch profile bind mine "push left then pinch" "layer menu"\n'
    '  neurotouch profile bind mine twist_cw "axis right_x +" --layer fly',
    cls=SignedCommand,
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
    """Bind a gesture to an action.

    WHEN is a gesture (push, pinch, zoom, twist cw, twist ccw, twist, scale, any), perhaps with a
    direction (left, up right), tap, double, hold or long, soft or hard, from 7 mm, at the centre,
    with 2 fingers; or gestures with then between them.

    DO is stick, axis, trigger, button, dpad, key, mouse or layer and which one, or pause, panic,
    rezero or next profile; perhaps after toggle, sticky, oneshot or turbo.
    """
    from neurotouch_hid.profile.editing import bind as bind_text
    from neurotouch_hid.profile.editing import list_company, parse_do, parse_when, take_profile

    edited = take_profile(name, make_stamp)
    condition = parse_when(when)
    text = bind_text(edited.text, condition, parse_do(do), layer, add=add)
    others = list_company(text, condition, layer, added=add)
    note = (
        f"The same gesture also does: {', '.join(others)}. 'unbind' removes what you do not want."
    )
    refused = f"'{when}' was not bound to '{do}'"
    notes = (*((note,) if others else ()), *tell_old_words(edited, text))
    save_edited(edited, text, notes, refused=refused, plain=plain, as_json=as_json)


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
    """Remove what a gesture does.

    Without DO, WHEN no longer does anything. The words are those of bind; of several bindings for
    the same gesture, pinch#2 is the second.
    """
    from neurotouch_hid.profile.editing import parse_do, parse_when, take_profile
    from neurotouch_hid.profile.editing import unbind as unbind_text

    edited = take_profile(name, make_stamp)
    what = parse_do(do) if do is not None else None
    text = unbind_text(edited.text, when if "#" in when else parse_when(when), what, layer)
    save_edited(edited, text, tell_old_words(edited, text), plain=plain, as_json=as_json)


@click.command(epilog="\b\nExamples:\n  neurotouch profile upgrade mine")
@click.argument("name", shell_complete=complete_profile)
@json_option
@plain_option
def upgrade(name: str, as_json: bool, plain: bool) -> None:
    """Rewrite a profile in the present format.

    The old one stays in the history of NAME.
    """
    from neurotouch_hid.profile.editing import find_schema, take_profile
    from neurotouch_hid.profile.editing import upgrade as upgrade_text

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
    from neurotouch_hid.client import ask, get_text
    from neurotouch_hid.errors import NotRunningError
    from neurotouch_hid.profile.editing import compare, hand_over_saved, make_favourite
    from neurotouch_hid.profile.reading import OWN_VALUES

    stem, edited, text = make_favourite(name, make_stamp)
    effect = hand_over_saved(OWN_VALUES)
    note = effect.text
    if effect.status == "OK":
        with suppress(NotRunningError):
            note = get_text(ask("use", profile=stem))
    outcome = Outcome(
        f"{stem} is the first of your favourites.",
        effect.status,
        fix=effect.fix,
        file=edited.store.path,
        changed=text != edited.text,
        lines=compare(edited.text, text) if as_json else (),
        notes=(note,),
    )
    outcome.tell(plain=plain, as_json=as_json)
