"""Parts of the language that are described by one class: the schema and the table of members follow from it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from codewheel.language.keys_of_specs import WrittenSpec
from codewheel.language.schemas import described_parts, part_schema, schema_with_parts
from codewheel.model.keys_and_members import data_notation, key_type
from codewheel.model.part import NOTHING, STEPS, Count, Name, Prose, fact, key, keys_of, part

SCHEMA = Path(__file__).parents[2] / "generator/language/device.schema.json"


def test_the_schema_is_as_the_classes_describe_it() -> None:
    text = SCHEMA.read_text(encoding="utf-8")
    assert schema_with_parts(text) == text, "run: make schema"


@part("A brake.", writing="Leave it out if there is none.", identity="level_mv")
class Brake:
    name: Name = key("Name of the brake.", data="Name.")
    level_mv: Count | None = key("Voltage that releases it.", reading="null if it is not known.", default=None)
    kinds: tuple[Name, ...] = key("Kinds.", writing=STEPS, default=(), most=4)
    is_wet: bool = key("True if it runs in oil.", default=False)
    derived: Prose = fact("Something that follows.", default="")


def test_the_schema_of_a_part_follows_from_its_class() -> None:
    assert part_schema(Brake) == {
        "type": "object",
        "additionalProperties": False,
        "required": ["name"],
        "description": "A brake. Leave it out if there is none.",
        "properties": {
            "name": {"description": "Name of the brake.", "$ref": "#/$defs/name"},
            "level_mv": {"description": "Voltage that releases it.", "$ref": "#/$defs/count"},
            "kinds": {
                "description": f"Kinds. {STEPS}",
                "type": "array",
                "minItems": 1,
                "maxItems": 4,
                "items": {"$ref": "#/$defs/name"},
            },
            "is_wet": {"description": "True if it runs in oil.", "type": "boolean"},
        },
    }


def test_a_changed_description_reaches_the_schema(monkeypatch: pytest.MonkeyPatch) -> None:
    text = SCHEMA.read_text(encoding="utf-8")
    changed_parts: dict[str, Any] = described_parts() | {"Led": Brake}
    monkeypatch.setattr("codewheel.language.schemas.described_parts", lambda: changed_parts)
    changed_lines = set(schema_with_parts(text).splitlines()) - set(text.splitlines())
    assert any('"level_mv"' in line for line in changed_lines)


@pytest.mark.parametrize(
    ("notation", "default", "expected"),
    [
        ("Name", "", "name"),
        ("Phrase", "", "string"),
        ("Count | None", None, "integer?"),
        ("tuple[Prose, ...]", (), "[text]"),
        ("bool", True, "boolean=true"),
        ("Literal['up', 'down']", None, "up|down"),
        ("LedState", None, "led_state"),
        ("tuple[LedState, ...]", (), "[led_state]"),
    ],
)
def test_the_type_in_the_data_follows_from_the_type_of_the_key(notation: str, default: object, expected: str) -> None:
    (described, *_) = keys_of(Brake)
    assert data_notation(described._replace(notation=notation, default=default)) == expected


def test_a_choice_names_its_words() -> None:
    assert key_type("Literal['', 'up', 'down']").choices == ("", "up", "down")


def test_a_part_is_created_by_the_names_of_its_keys() -> None:
    brake = Brake(name="main")
    assert (brake.level_mv, brake.kinds, brake.is_wet) == (None, (), False)
    assert dict(NOTHING) == {}


def test_the_keys_of_a_spec_are_required_where_they_have_no_default() -> None:
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    assert part_schema(WrittenSpec)["required"] == schema["required"]


def test_few_keys_have_a_schema_of_their_own() -> None:
    """Other keys have a type with a name, and at most a pattern and limits."""
    literal_keys = [
        f"{name}.{described.name}"
        for name, kind in described_parts().items()
        for described in keys_of(kind)
        if described.key.schema
    ]
    assert literal_keys == ["LayoutRange.wraps"]
