"""Completes names and keys in the shell."""

import os
from contextlib import suppress
from typing import Final

import click
from click.shell_completion import CompletionItem

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.vocabulary import RECORDING_ENDINGS, RUNNING_DRIVER

_KINDS: Final = ("davis", "video", "events", "driver")


def complete_profile(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes names of profiles."""
    return [name for name in _list_names() if name.startswith(incomplete)]


def complete_profile_or_path(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Completes names of profiles, and files."""
    names = complete_profile(ctx, param, incomplete)
    return [*map(CompletionItem, names), CompletionItem(incomplete, type="file")]


def complete_scene(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes names of the simulator's scenes."""
    from neurotouch_hid.source.simulator.scenes import scene_names

    return [name for name in scene_names() if name.startswith(incomplete)]


def complete_source(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes sources: kinds, scenes of the simulator, recordings."""
    from neurotouch_hid.plugins import SOURCES, list_plugins
    from neurotouch_hid.source.simulator.scenes import scene_names

    kinds = (*_KINDS, *list_plugins(SOURCES))
    path = incomplete.removeprefix("file:") if incomplete.startswith("file:") else ""
    found = [f"{kind}:" for kind in kinds]
    found += [f"sim:{name}" for name in scene_names()]
    found += [f"file:{each}" for each in _list_recordings(path)]
    return [each for each in found if each.startswith(incomplete)]


def complete_own_source(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Completes the sources that a command opens itself: the running driver is none."""
    found = complete_source(ctx, param, incomplete)
    return [each for each in found if each != RUNNING_DRIVER]


def _list_recordings(start: str) -> list[str]:
    """Returns the paths of recordings and folders that start so."""
    folder, slash, name = start.rpartition("/")
    found = []
    with suppress(OSError), os.scandir(folder + slash or ".") as entries:
        for entry in entries:
            if not entry.name.startswith(name) or not entry.name.isprintable():
                continue
            if entry.is_dir():
                found.append(f"{folder}{slash}{entry.name}/")
            elif entry.name.lower().endswith(RECORDING_ENDINGS):
                found.append(f"{folder}{slash}{entry.name}")
    return sorted(found)


def complete_file(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes names of files that can be edited: profiles, and the person's own values."""
    from neurotouch_hid.profile.reading import OWN_VALUES

    return [name for name in (*_list_names(), OWN_VALUES) if name.startswith(incomplete)]


def complete_key(ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes paths to values of the profile named before on the command line."""
    from neurotouch_hid.profile.editing import list_key_paths, take_file

    try:
        edited = take_file(ctx.params.get("name") or "default", str)
        paths = list_key_paths(edited.text.document, edited.model)
        return [path for path in paths if path.startswith(incomplete)]
    except NeuroTouchError:
        return []


def _list_names() -> list[str]:
    """Returns the names of profiles; none if their folder cannot be looked into."""
    from neurotouch_hid.profile.reading import list_profiles

    with suppress(NeuroTouchError):
        return list(list_profiles())
    return []


def complete_code(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[str]:
    """Completes codes of faults."""
    from neurotouch_hid.profile.diagnostics import CODES

    return [code for code in CODES if code.startswith(incomplete.upper())]
