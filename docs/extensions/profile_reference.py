"""Renders the profile's JSON Schema as tables, one for each model: ``{profile-schema} profile``.

The schema comes from the models of the installed program, so that the page cannot go out of date.
"""

from collections.abc import Mapping
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from neurotouch_hid.profile import profile_schema, user_schema

SCHEMAS = {"profile": profile_schema, "user": user_schema}
WIDTHS = (20, 30, 50)


class ProfileSchema(SphinxDirective):
    """Shows the keys of the whole file first, then each model that they use."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Returns a section for the file and one for each model."""
        name = self.arguments[0]
        if name not in SCHEMAS:
            raise self.error(f"No such schema: '{name}'. There are: {', '.join(SCHEMAS)}.")
        schema = SCHEMAS[name]()
        models = schema.get("$defs", {})
        titles = _order(schema, models)
        return [
            _section(name, "The whole file", schema),
            *(_section(name, title, models[title]) for title in titles),
        ]


def _order(schema: Mapping[str, Any], models: Mapping[str, Any]) -> list[str]:
    """The models as a reader of the first table meets them."""
    titles: list[str] = []
    ahead = [schema]
    while ahead:
        found = [title for title in _references(ahead.pop(0)) if title not in titles]
        titles += found
        ahead += [models[title] for title in found]
    return titles


def _references(part: object) -> list[str]:
    """All models that a part of the schema names, once each; not those among ``$defs``."""
    if isinstance(part, Mapping):
        if "$ref" in part:
            return [str(part["$ref"]).rsplit("/", 1)[1]]
        inner = [value for key, value in part.items() if key != "$defs"]
    else:
        inner = part if isinstance(part, list) else []
    return list(dict.fromkeys(title for value in inner for title in _references(value)))


def _section(prefix: str, title: str, model: Mapping[str, Any]) -> nodes.section:
    section = nodes.section(ids=[_anchor(prefix, title)], names=[])
    section += nodes.title(text=title)
    if model.get("description"):
        for paragraph in str(model["description"]).split("\n\n"):
            section += _plain(paragraph)
    if "properties" in model:
        section += _table(prefix, model)
    else:
        section += nodes.paragraph("", "", *_values(prefix, model))
    return section


def _table(prefix: str, model: Mapping[str, Any]) -> nodes.table:
    table = nodes.table(classes=["profile-keys"])
    group = nodes.tgroup(cols=len(WIDTHS))
    table += group
    for width in WIDTHS:
        group += nodes.colspec(colwidth=width)
    head = nodes.thead()
    head += _row(*(nodes.paragraph(text=text) for text in ("key", "value", "meaning")))
    body = nodes.tbody()
    required = model.get("required", ())
    for key, value in model["properties"].items():
        named = nodes.paragraph("", "", nodes.literal(text=key))
        if key in required:
            named += nodes.Text(" (needed)")
        body += _row(
            named,
            nodes.paragraph("", "", *_values(prefix, value)),
            _plain(str(value.get("description", ""))),
        )
    group += [head, body]
    return table


def _row(*cells: nodes.paragraph) -> nodes.row:
    row = nodes.row()
    for cell in cells:
        entry = nodes.entry()
        entry += cell
        row += entry
    return row


def _plain(words: str) -> nodes.paragraph:
    """A description of the schema; only its double backticks mean something."""
    paragraph = nodes.paragraph()
    for i, part in enumerate(" ".join(words.split()).split("``")):
        paragraph += nodes.literal(text=part) if i % 2 else nodes.Text(part)
    return paragraph


def _values(prefix: str, value: Mapping[str, Any]) -> list[nodes.Node]:
    """What may stand there: a type, the words, the limits, or a link to a model."""
    if "$ref" in value:
        name = str(value["$ref"]).rsplit("/", 1)[1]
        return [nodes.reference("", name, internal=True, refid=_anchor(prefix, name))]
    for key in ("oneOf", "anyOf"):
        if key in value:
            return _joined([_values(prefix, one) for one in value[key]], " or ")
    if "const" in value:
        return [nodes.literal(text=_yaml(value["const"]))]
    if "enum" in value:
        return _joined([[nodes.literal(text=_yaml(word))] for word in value["enum"]], ", ")
    if value.get("type") == "array":
        return _list(prefix, value)
    return [nodes.Text(_scalar(value))]


def _list(prefix: str, value: Mapping[str, Any]) -> list[nodes.Node]:
    items = value.get("prefixItems") or [value.get("items", {})]
    size = _range(value.get("minItems"), value.get("maxItems"))
    words = _joined([_values(prefix, item) for item in items], ", ")
    return [nodes.Text(f"list of {size}: " if size else "list of: "), *words]


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


def _joined(parts: list[list[nodes.Node]], between: str) -> list[nodes.Node]:
    joined: list[nodes.Node] = []
    for part in parts:
        joined += [nodes.Text(between), *part] if joined else part
    return joined


def _yaml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _anchor(prefix: str, name: str) -> str:
    return nodes.make_id(f"{prefix}-{name}")


def setup(app: Sphinx) -> dict[str, bool]:
    """Adds the directive."""
    directive: type[Directive] = ProfileSchema
    app.add_directive("profile-schema", directive)
    return {"parallel_read_safe": True}
