"""Finds the model that describes a place of a profile, from the models themselves."""

from dataclasses import dataclass, field
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, Discriminator, Tag

from neurotouch_hid.files.faults import Keys


@dataclass(slots=True)
class _Place:
    """The models that one key of a model allows.

    Attributes:
        forms: the models of the value, by their tag; "" where a value has no tag.
        choose: finds the tag of a value.
        is_list: the value is a list of these.
    """

    forms: dict[str, type[BaseModel]] = field(default_factory=dict)
    choose: Discriminator | None = None
    is_list: bool = False


def find_model(root: type[BaseModel], keys: Keys, value: Any = None) -> type[BaseModel] | None:
    """Returns the model of the mapping at a place; None if no mapping belongs there.

    Args:
        root: the model of the whole document.
        keys: the path of the place, with a number for an item of a list. It may hold the tags by
            which pydantic tells the forms of a value apart.
        value: the mapping; it decides between several forms.
    """
    place = _Place({"": root})
    for key in keys:
        if isinstance(key, int):
            place.is_list = False
        elif key in place.forms:
            place = _Place({"": place.forms[key]})
        else:
            known = (form.model_fields.get(key) for form in place.forms.values())
            info = next((each for each in known if each is not None), None)
            if place.is_list or info is None:
                return None
            place = _Place()
            _read(info.annotation, info.metadata, place)
    if place.is_list:
        return None
    if len(place.forms) > 1 and place.choose is not None:
        tag = place.choose.discriminator(value)  # type: ignore[operator]  # ours are functions
        return place.forms.get(str(tag))
    return next(iter(place.forms.values()), None)


def takes_list(root: type[BaseModel], keys: Keys, document: Any) -> bool:
    """Returns whether only a list belongs at a place: of words, or of two numbers.

    Args:
        root: the model of the whole document.
        keys: the path of the place.
        document: the plain value of the document; it decides between several forms.
    """
    value = document
    for key in keys[:-1]:
        known = isinstance(value, list) or (isinstance(value, dict) and key in value)
        value = value[key] if known else None
    parent = find_model(root, keys[:-1], value)
    info = parent.model_fields.get(str(keys[-1])) if parent is not None and keys else None
    return info is not None and _is_list(info.annotation)


def _is_list(annotation: Any) -> bool:
    """Returns whether every form of a value is a list or a tuple; a missing one does not count."""
    origin = get_origin(annotation)
    if origin is Annotated:
        return _is_list(get_args(annotation)[0])
    if origin in (Union, UnionType):
        forms = [each for each in get_args(annotation) if each is not NoneType]
        return all(map(_is_list, forms))
    return origin in (list, tuple)


def _read(annotation: Any, metadata: Any, place: _Place) -> None:
    """Adds what an annotation allows to a place."""
    place.choose = next((m for m in metadata if isinstance(m, Discriminator)), place.choose)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        tag = next((m.tag for m in metadata if isinstance(m, Tag)), "")
        place.forms[tag] = annotation
    elif get_origin(annotation) is Annotated:
        inner, *more = get_args(annotation)
        _read(inner, more, place)
    else:
        place.is_list = place.is_list or get_origin(annotation) is list
        for each in get_args(annotation):
            _read(each, (), place)
