"""Methods and sources of other packages, found by entry point.

A package offers a recogniser or a source under a name of its own, in its ``pyproject.toml``::

    [project.entry-points."neurotouch.methods"]
    mine = "my_package:make_method"
"""

import inspect
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

from neurotouch_hid.errors import NeuroTouchError, PluginError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint, EntryPoints

Group = Literal["neurotouch.methods", "neurotouch.sources"]

METHODS: Final[Group] = "neurotouch.methods"
SOURCES: Final[Group] = "neurotouch.sources"
_WHOLE_TRACEBACK: Final = "To see the whole traceback, set PYTHONDEVMODE=1."


def list_plugins(group: Group) -> tuple[str, ...]:
    """Returns the names that other packages offer, sorted."""
    return tuple(sorted({point.name for point in _find(group)}))


def find_plugin(group: Group, name: str) -> "Plugin | None":
    """Returns what another package offers under a name; None if no package does.

    Raises:
        PluginError: two packages offer the same name.
    """
    found = {point.value: point for point in _find(group).select(name=name)}
    if not found:
        return None
    if len(found) > 1:
        owners = ", ".join(sorted(map(find_owner, found.values())))
        raise PluginError(
            f"'{name}' ({group}) is offered by more than one package: {owners}.",
            hint="Uninstall all but one of them.",
        )
    (point,) = found.values()
    return Plugin(point)


@dataclass(frozen=True, slots=True)
class Plugin:
    """A method or a source of another package.

    Attributes:
        point: its entry point.
    """

    point: "EntryPoint"

    def make(self, *arguments: object, **options: object) -> Any:
        """Returns what the function of the package makes.

        Raises:
            PluginError: the package cannot be imported, or its function takes other arguments or
                fails.
        """
        try:
            make = self.point.load()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise PluginError(
                f"'{self.point.name}' of the package {find_owner(self.point)} cannot be loaded: "
                f"{_name_error(error)}.",
                hint="Fix it, update it, or uninstall it.",
            ) from error
        what = f"'{self.point.value}' of the package {find_owner(self.point)}"
        check_call(what, make, *arguments, **options)
        with self.running():
            return make(*arguments, **options)

    @contextmanager
    def running(self) -> Iterator[None]:
        """A block that runs code of the package; our own errors pass unchanged.

        Raises:
            PluginError: the code fails; it names the package, the file and the line.
        """
        try:
            yield
        except (NeuroTouchError, KeyboardInterrupt, GeneratorExit):
            raise
        except BaseException as error:  # a SystemExit would end us without a word
            kind = "method" if self.point.group == METHODS else "source"
            raise PluginError(
                f"The {kind} '{self.point.name}' of the package {find_owner(self.point)} failed: "
                f"{_name_error(error)} ({self._locate(error)}).",
                hint=f"Fix it there, or uninstall that package. {_WHOLE_TRACEBACK}",
            ) from error

    def _locate(self, error: BaseException) -> str:
        """Returns file and line of the innermost call in the package, else of the innermost."""
        calls = list(traceback.walk_tb(error.__traceback__))
        package = self.point.module.partition(".")[0]
        inside = [
            call
            for call in calls
            if call[0].f_globals.get("__name__", "").partition(".")[0] == package
        ]
        frame, line = (inside or calls)[-1]
        return f"{frame.f_code.co_filename}, line {line}"


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


def find_owner(point: "EntryPoint") -> str:
    """Returns the name of the package that offers an entry point."""
    return point.dist.name if point.dist is not None else point.module


def _name_error(error: BaseException) -> str:
    said = str(error)
    return f"{type(error).__name__}: {said}" if said else type(error).__name__


def _find(group: Group) -> "EntryPoints":
    # Its import takes 15 ms, and an ordinary start asks for no plug-in.
    from importlib.metadata import entry_points  # noqa: PLC0415

    return entry_points(group=group)
