"""Writes the tables of the profile's keys into the documents, from the schema of the program.

``python docs/extensions/profile_reference.py`` renews ``profile-format.md``,
``user-format.md`` and ``gel-format.md``.
"""

import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from neurotouch_hid.driver.gel_settings import gel_schema
from neurotouch_hid.profile import profile_schema, user_schema

DOCS = Path(__file__).parents[1]
SCHEMAS = {
    "profile-format.md": profile_schema,
    "user-format.md": user_schema,
    "gel-format.md": gel_schema,
}
MARK = "<!-- generated: python docs/extensions/profile_reference.py -->\n"
COLUMNS = 120


def renew(page: str, text: str) -> str:
    """Returns a page with today's tables below the mark; what is above it stays."""
    above, mark, _ = text.partition(MARK)
    if not mark:
        raise ValueError(f"{page} has no line '{MARK.strip()}'")
    return f"{above}{MARK}\n{render_schema(SCHEMAS[page]())}"


def render_schema(schema: Mapping[str, Any]) -> str:
    """Returns Markdown: a section for the whole file, then one for each model that it uses."""
    models = schema.get("$defs", {})
    sections = [_section("The whole file", schema)]
    sections += [_section(title, models[title]) for title in _order(schema, models)]
    return "\n".join(sections)


def _order(schema: Mapping[str, Any], models: Mapping[str, Any]) -> list[str]:
    """Returns the models in the order in which a reader of the first table meets them."""
    titles: list[str] = []
    ahead = [schema]
    while ahead:
        found = [title for title in _references(ahead.pop(0)) if title not in titles]
        titles += found
        ahead += [models[title] for title in found]
    return titles


def _references(part: object) -> list[str]:
    """Returns all models that a part of the schema names, once each, without ``$defs``."""
    if isinstance(part, Mapping):
        if "$ref" in part:
            return [str(part["$ref"]).rsplit("/", 1)[1]]
        inner = [value for key, value in part.items() if key != "$defs"]
    else:
        inner = part if isinstance(part, list) else []
    return list(dict.fromkeys(title for value in inner for title in _references(value)))


def _section(title: str, model: Mapping[str, Any]) -> str:
    paragraphs = [f"## {title}\n"]
    for paragraph in str(model.get("description", "")).split("\n\n"):
        if paragraph:
            # A hyphen or a long word stays whole: a code span must not be cut.
            wrapped = textwrap.fill(
                _escape(paragraph), COLUMNS, break_long_words=False, break_on_hyphens=False
            )
            paragraphs.append(wrapped + "\n")
    paragraphs.append(_table(model) if "properties" in model else _values(model) + "\n")
    return "\n".join(paragraphs)


def _table(model: Mapping[str, Any]) -> str:
    required = model.get("required", ())
    rows = ["| key | value | meaning |", "| --- | --- | --- |"]
    for key, value in model["properties"].items():
        name = f"`{key}`" + (" (needed)" if key in required else "")
        cells = (name, _values(value), _escape(str(value.get("description", ""))))
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows).replace("|  |", "| |") + "\n"


def _escape(words: str) -> str:
    """Returns a description of the schema, in which only backticks mean something."""
    parts = " ".join(words.split()).replace("``", "`").split("`")
    for i in range(0, len(parts), 2):
        for mark in "*_<[":
            parts[i] = parts[i].replace(mark, f"\\{mark}")
    return "`".join(parts)


def _values(value: Mapping[str, Any]) -> str:
    """Returns the values that a key takes: a type, the words, the limits, or a link to a model."""
    if "$ref" in value:
        name = str(value["$ref"]).rsplit("/", 1)[1]
        return f"[{name}](#{name.lower()})"
    for key in ("oneOf", "anyOf"):
        if key in value:
            return " or ".join(_values(one) for one in value[key])
    if "const" in value:
        return _yaml(value["const"])
    if "enum" in value:
        return ", ".join(_yaml(word) for word in value["enum"])
    if value.get("type") == "array":
        return _list(value)
    return _scalar(value)


def _list(value: Mapping[str, Any]) -> str:
    items = value.get("prefixItems") or [value.get("items", {})]
    size = _range(value.get("minItems"), value.get("maxItems"))
    return (f"list of {size}: " if size else "list of: ") + ", ".join(map(_values, items))


def _scalar(value: Mapping[str, Any]) -> str:
    kinds = {"integer": "whole number", "string": "text", "boolean": "true or false"}
    kind = str(value.get("type", "any value"))
    words = kinds.get(kind, kind)
    low = value.get("minimum", value.get("exclusiveMinimum"))
    limits = _range(low, value.get("maximum", value.get("exclusiveMaximum")))
    unit = f" {value['x-unit']}" if "x-unit" in value else ""
    return f"{words}, {limits}{unit}" if limits else f"{words}{unit and ',' + unit}"


def _range(low: object, high: object) -> str:
    if low is None and high is None:
        return ""
    if low == high:
        return f"{low}"
    if high is None:
        return f"{low} or more"
    return f"up to {high}" if low is None else f"{low} to {high}"


def _yaml(value: object) -> str:
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


if __name__ == "__main__":
    for name in SCHEMAS:
        path = DOCS / name
        path.write_text(renew(name, path.read_text(encoding="utf-8")), encoding="utf-8")
