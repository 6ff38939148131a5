"""Sets one value of a profile or of the user's file, or takes it back to its default."""

from collections.abc import Collection
from typing import Any

from pydantic import BaseModel

from neurotouch_hid.files.faults import Keys
from neurotouch_hid.profile.editing.key_paths import find_key_path, list_known
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.editing.yaml_values import parse_value
from neurotouch_hid.profile.schema.profile import Profile
from neurotouch_hid.profile.schema.tree import takes_list


def set_value(
    text: ProfileText, path: str, value: Any, model: type[BaseModel] = Profile
) -> ProfileText:
    """Returns the text with a value at the place a person names.

    Mappings that are missing on the path are added. Where a list belongs, words may come without
    brackets.

    Raises:
        ProfileError: there is no such key.
    """
    found = find_key_path(text.document, path, model)
    if isinstance(value, str) and takes_list(model, found.keys, text.document):
        value = [parse_value(word) for word in value.replace(",", " ").split()]
    if found.exists:
        return text.replace(found.keys, value)
    if found.widen is not None:
        keys, key = found.widen
        return text.replace(keys, {key: text.find(keys), found.keys[-1]: value})
    return insert_value(text, found.keys, value, model)


def reset_value(text: ProfileText, path: str, model: type[BaseModel] = Profile) -> ProfileText:
    """Returns the text without the value at the place a person names, so that the default applies.

    It is the same text if the value is not set.

    Raises:
        ProfileError: there is no such key.
    """
    found = find_key_path(text.document, path, model)
    return text.remove(found.keys) if found.exists else text


def take_back(
    text: ProfileText,
    before: ProfileText,
    after: ProfileText,
    names: Collection[str],
    model: type[BaseModel] = Profile,
) -> ProfileText:
    """Returns the text with some values as they were before a change, and all else as it is.

    Args:
        text: the file now.
        before: the file when the change began.
        after: the file when it was saved. What was changed again since then stays.
        names: the values, as people name them.
        model: the model of the file.
    """
    for name in names:
        keys = tuple(name.split("."))
        was, became, is_ = (each.find(keys) for each in (before, after, text))
        if was == became or is_ != became:
            continue
        text = text.remove(keys) if was is None else set_value(text, name, was, model)
    return text


def insert_value(
    text: ProfileText, keys: Keys, value: Any, model: type[BaseModel] = Profile
) -> ProfileText:
    """Returns the text with a value at a new place, with the mappings that are missing."""
    n = len(keys) - 1
    while n and text.find(keys[:n]) is None:
        value, n = {keys[n]: value}, n - 1
    order = list_known(text.find(keys[:n]), keys[:n], model)
    return text.insert(keys[:n], str(keys[n]), value, order)
