"""What the shell offers while a name or a key is typed."""

import click

from neurotouch_hid.errors import NeuroTouchError


def complete_profile(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Names of profiles."""
    from neurotouch_hid.profile.reading.library import list_profiles

    return [name for name in list_profiles() if name.startswith(incomplete)]


def complete_paper(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Names of profiles, and the one of the person's own values."""
    from neurotouch_hid.profile.reading.library import OWN_VALUES, list_profiles

    return [name for name in (*list_profiles(), OWN_VALUES) if name.startswith(incomplete)]


def complete_key(ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes paths to values of the profile named before on the command line."""
    from neurotouch_hid.files.yaml_document import parse_document
    from neurotouch_hid.profile.editing import list_ways, take_file

    try:
        paper = take_file(ctx.params.get("name") or "default", str)
    except NeuroTouchError:
        return []
    root, _ = parse_document(paper.text)
    ways = list_ways(root.value, paper.model) if root is not None else ()
    return [way for way in ways if way.startswith(incomplete)]


def complete_code(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Codes of faults."""
    from neurotouch_hid.profile.diagnostics.codes import CODES

    return [code for code in CODES if code.startswith(incomplete.upper())]
