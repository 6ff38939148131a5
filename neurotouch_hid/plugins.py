"""Methods and sources of other packages, found by entry point.

A package offers a recogniser or a source under a name of its own, in its ``pyproject.toml``::

    [project.entry-points."neurotouch.methods"]
    mine = "my_package:make_method"
"""

from importlib.metadata import EntryPoint, entry_points
from typing import Any, Final, Literal

from neurotouch_hid.errors import PluginError

Group = Literal["neurotouch.methods", "neurotouch.sources"]

METHODS: Final[Group] = "neurotouch.methods"
SOURCES: Final[Group] = "neurotouch.sources"


def list_plugins(group: Group) -> tuple[str, ...]:
    """Returns the names that other packages offer, sorted."""
    return tuple(sorted({point.name for point in entry_points(group=group)}))


def load_plugin(group: Group, name: str) -> Any:
    """Returns what another package offers under a name; None if nobody offers it.

    Raises:
        PluginError: the package cannot be imported, or two packages offer the same name.
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
        return point.load()
    except Exception as error:
        raise PluginError(
            f"'{name}' of the package {find_owner(point)} cannot be loaded: "
            f"{type(error).__name__}: {error}.",
            hint="Update or uninstall that package.",
        ) from error


def find_owner(point: EntryPoint) -> str:
    """Returns the name of the package that offers an entry point."""
    return point.dist.name if point.dist is not None else point.module
