"""Methods and sources of other packages, found by entry point.

A package offers a recogniser or a source under a name of its own, in its ``pyproject.toml``::

    [project.entry-points."neurotouch.methods"]
    mine = "my_package:make_method"
"""

import inspect
import traceback
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Final, Literal

from neurotouch_hid.errors import PluginError

Group = Literal["neurotouch.methods", "neurotouch.sources"]

METHODS: Final[Group] = "neurotouch.methods"
SOURCES: Final[Group] = "neurotouch.sources"
_WHOLE_TRACEBACK: Final = "To see the whole traceback, set PYTHONDEVMODE=1."


def list_plugins(group: Group) -> tuple[str, ...]:
    """Returns the names that other packages offer, sorted."""
    return tuple(sorted({point.name for point in entry_points(group=group)}))


def make_plugin(group: Group, name: str, *arguments: object, **options: object) -> Any:
    """Returns the object made by another package's function; None if no package offers the name.

    Raises:
        PluginError: the package cannot be imported, its function takes other arguments, or two
            packages offer the same name.
    """
    found = {point.value: point for point in entry_points(group=group, name=name)}
    if not found:
        return None
    if len(found) > 1:
        owners = ", ".join(sorted(map(find_owner, found.values())))
        raise PluginError(
            f"'{name}' ({group}) is offered by more than one package: {owners}.",
            hint="Uninstall all but one of them.",
        )
    (point,) = found.values()
    try:
        make = point.load()
    except Exception as error:
        raise PluginError(
            f"'{name}' of the package {find_owner(point)} cannot be loaded: "
            f"{type(error).__name__}: {error}.",
            hint="Update or uninstall that package.",
        ) from error
    check_call(f"'{point.value}' of the package {find_owner(point)}", make, *arguments, **options)
    return make(*arguments, **options)


def check_call(
    what: str, function: Callable[..., Any], *arguments: object, **options: object
) -> None:
    """Checks that a function takes these arguments.

    Raises:
        PluginError: it takes other arguments, or is no function.
    """
    try:
        inspect.signature(function).bind(*arguments, **options)
    except (TypeError, ValueError) as error:
        raise PluginError(
            f"{what} cannot be called: {error}.",
            hint="GestureMethod and Source (docs/api.md) say which arguments it must take.",
        ) from error


def blame_plugin(error: Exception) -> PluginError | None:
    """Returns the error of a plug-in as one sentence.

    Args:
        error: the exception, with its traceback.

    Returns:
        None if no code of a plug-in was running.
    """
    owners = {
        point.module.partition(".")[0]: (group, point)
        for group in (METHODS, SOURCES)
        for point in entry_points(group=group)
    }
    for frame, line in reversed(list(traceback.walk_tb(error.__traceback__))):
        found = owners.get(frame.f_globals.get("__name__", "").partition(".")[0])
        if found is not None:
            group, point = found
            kind = "method" if group == METHODS else "source"
            return PluginError(
                f"The {kind} '{point.name}' of the package {find_owner(point)} failed: "
                f"{type(error).__name__}: {error} "
                f"({frame.f_code.co_filename}, line {line}).",
                hint=f"Fix it there, or uninstall that package. {_WHOLE_TRACEBACK}",
            )
    return None


def find_owner(point: EntryPoint) -> str:
    """Returns the name of the package that offers an entry point."""
    return point.dist.name if point.dist is not None else point.module
