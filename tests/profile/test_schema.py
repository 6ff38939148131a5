"""The schema that editors read."""

import json

import pytest
from pydantic import TypeAdapter

from neurotouch_hid.driver.gel_settings import gel_schema
from neurotouch_hid.messages import Button, GestureKind
from neurotouch_hid.profile import profile_schema, user_schema
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.profile.schema.conditions import CONDITION_KEYS, Condition, GestureName
from neurotouch_hid.profile.schema.shaping import Curve

SCHEMA = profile_schema()
USER = user_schema()
GEL = gel_schema()
MODELS = {"Profile": SCHEMA, **SCHEMA["$defs"], "UserSettings": USER, **USER["$defs"]}
MODELS |= {"GelSettings": GEL, **GEL["$defs"]}
FIELDS = [
    (name, key, field)
    for name, model in MODELS.items()
    for key, field in model.get("properties", {}).items()
]


def test_the_ordered_keys_of_a_condition_are_keys_of_the_model() -> None:
    assert set(CONDITION_KEYS) <= set(Condition.model_fields)


@pytest.mark.parametrize(
    ("name", "schema"), [("profile-1", SCHEMA), ("user-1", USER), ("gel-1", GEL)]
)
def test_the_shipped_schema_is_current(name: str, schema: dict) -> None:
    shipped = find_shipped_folder() / "schema" / f"{name}.json"
    assert json.loads(shipped.read_text(encoding="utf-8")) == schema, (
        "write it anew: json.dumps(..., indent=2, ensure_ascii=False)"
    )


@pytest.mark.parametrize(("model", "key", "field"), FIELDS)
def test_every_key_says_what_it_is(model: str, key: str, field: dict) -> None:
    assert field["description"].endswith(".")
    assert "efault: " in field["description"] or "No default." in field["description"]
    assert ("No default." in field["description"]) == (key in MODELS[model].get("required", []))
    for suffix, unit in (("_mm", "mm"), ("_ms", "ms"), ("_mm_s", "mm/s"), ("_deg", "deg")):
        if key.endswith(suffix):
            assert field["x-unit"] == unit
            assert {"deg": "degrees"}.get(unit, unit) in field["description"]


@pytest.mark.parametrize("model", [name for name, m in MODELS.items() if "properties" in m])
def test_nothing_else_is_allowed(model: str) -> None:
    assert MODELS[model]["additionalProperties"] is False


def test_every_number_has_bounds_and_nothing_may_be_empty() -> None:
    def walk(node: object) -> None:
        if isinstance(node, dict):
            if node.get("type") in ("number", "integer") and not {"const", "enum"} & set(node):
                assert "minimum" in node, node
                assert "maximum" in node, node
            assert node.get("type") != "null"
            for child in node.values():
                walk(child)
        elif isinstance(node, list):
            for child in node:
                walk(child)

    walk(SCHEMA)
    walk(USER)


def test_no_key_or_value_reads_as_true_or_false_in_yaml_1_1() -> None:
    words = {field for _, field, _ in FIELDS}
    words |= {value for _, _, field in FIELDS for value in field.get("enum", [])}
    assert not words & {"on", "off", "yes", "no"}


def test_it_covers_the_records() -> None:
    assert MODELS["Button"]["enum"] == [button.value for button in Button]
    gestures = TypeAdapter(GestureName).json_schema()["enum"]
    assert gestures[:5] == [kind.label for kind in GestureKind if kind != GestureKind.NONE]


def test_models_survive_a_round_trip() -> None:
    curves: TypeAdapter[Curve] = TypeAdapter(Curve)
    for value in ("linear", {"expo": 0.5}, {"power": 2.0}):
        model = curves.validate_python(value)
        assert curves.validate_python(model) == model
