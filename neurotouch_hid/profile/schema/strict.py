"""The rules all parts of a profile keep: strict types, no unknown keys, no NaN, described keys."""

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict


class Strict(BaseModel):
    """A part of a profile.

    What the program itself makes of valid values comes from ``model_construct``: a model that only
    checks as a part of another one need not be compiled, which takes milliseconds.
    """

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        allow_inf_nan=False,
        frozen=True,
        hide_input_in_errors=True,
        defer_build=True,  # only what is used is compiled: a third less to import
    )


def give_unit(unit: str) -> dict[str, Any]:
    """Returns the unit of a key, for editors."""
    return {"x-unit": unit}


def make_optional(unit: str | None = None) -> Callable[[dict[str, Any]], None]:
    """Returns a key that may be left out but not be empty.

    A document's null never gets this far.
    """

    def describe(schema: dict[str, Any]) -> None:
        schema.pop("default")
        schema.update(schema.pop("anyOf")[0])
        if unit is not None:
            schema["x-unit"] = unit

    return describe


def find_tag(value: object, models: Mapping[str, type[Strict]]) -> str | None:
    """Returns the tag of the one form of a value, ``<key>`` for the key only that form has.

    Tags are in angle brackets, so that no error's place takes one for a key of the document.
    None, an error, if the value has none or several of the keys.
    """
    if isinstance(value, dict):
        forms = [key for key in models if key in value]
    else:
        forms = [key for key, model in models.items() if type(value) is model]
    return f"<{forms[0]}>" if len(forms) == 1 else None
