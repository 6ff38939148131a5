"""Completes names and keys in the shell."""

import click

from neurotouch_hid.errors import NeuroTouchError


def complete_profile(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes names of profiles."""
    from neurotouch_hid.profile.reading import list_profiles

    return [name for name in list_profiles() if name.startswith(incomplete)]


def complete_file(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes names of files that can be edited: profiles, and the person's own values."""
    from neurotouch_hid.profile.reading import OWN_VALUES, list_profiles

    return [name for name in (*list_profiles(), OWN_VALUES) if name.startswith(incomplete)]


def complete_key(ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes paths to values of the profile named before on the command line."""
    from neurotouch_hid.profile.editing import list_key_paths, take_file

    try:
        edited = take_file(ctx.params.get("name") or "default", str)
        paths = list_key_paths(edited.text.document, edited.model)
        return [path for path in paths if path.startswith(incomplete)]
    except NeuroTouchError:
        return []


def complete_code(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes codes of faults."""
    from neurotouch_hid.profile.diagnostics import CODES

    return [code for code in CODES if code.startswith(incomplete.upper())]
