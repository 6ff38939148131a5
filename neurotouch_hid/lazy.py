"""Loads a name of a package when it is first asked for, so that the others cost nothing."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def load_lazily(package: str, names: Mapping[str, str]) -> Callable[[str], Any]:
    """Returns the ``__getattr__`` of a package.

    Args:
        package: the package's name.
        names: the names it offers, with spaces between, by the module that they are in.
    """
    modules = {name: module for module, inside in names.items() for name in inside.split()}

    def load(name: str) -> Any:
        if name not in modules:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        return getattr(import_module(f"{package}.{modules[name]}"), name)

    return load
