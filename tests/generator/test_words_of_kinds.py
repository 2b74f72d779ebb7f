"""Schemas, builders and generated code use the same words for interfaces, steps and examples as the model."""

from __future__ import annotations

from typing import Any, get_args

import pytest
from codewheel.dump.schema import schema_of_device_data
from codewheel.language.schemas import load_schema
from codewheel.loading.examples import _EXAMPLES
from codewheel.loading.interfaces import _INTERFACES
from codewheel.loading.spec_parts import _STEPS
from codewheel.model import INTERFACES, Example, Step
from codewheel_runtime import Interface

DO = {kind.do for kind in get_args(Step)}
WORKED = {kind.kind for kind in get_args(Example)}


def allowed_words(schema: Any, name: str) -> list[set[str]]:
    """Return the words that a schema allows for members of this name, without the empty word."""
    allowed = []
    for key, inner in schema.items() if isinstance(schema, dict) else ():
        if key == name and isinstance(inner, dict):
            enumerations = (inner.get("enum"), inner.get("items", {}).get("enum"))
            allowed += [set(words) - {""} for words in enumerations if words]
        allowed += allowed_words(inner, name)
    return allowed


SCHEMAS = {"device": load_schema("device"), "show": schema_of_device_data()}


@pytest.mark.parametrize("name", SCHEMAS)
def test_schemas_allow_every_interface(name: str) -> None:
    schema = SCHEMAS[name]
    enumerations = [words for key in ("interface", "interfaces") for words in allowed_words(schema, key)]
    assert len(enumerations) >= 5
    assert all(words == set(INTERFACES) for words in enumerations)


def test_the_spec_has_every_interface() -> None:
    assert set(load_schema("device")["$defs"]["interfaces"]["properties"]) == set(INTERFACES)
    assert set(_INTERFACES) == set(INTERFACES)


@pytest.mark.parametrize("name", SCHEMAS)
def test_schemas_allow_every_step_and_example(name: str) -> None:
    definitions = SCHEMAS[name]["$defs"]
    assert allowed_words(definitions["step"], "do") == [DO]
    assert allowed_words(definitions["example"], "kind") == [WORKED]


def test_every_step_and_example_is_built() -> None:
    assert set(_STEPS) == DO
    assert set(_EXAMPLES) == WORKED


def test_generated_code_has_every_interface() -> None:
    assert [interface.value for interface in Interface] == list(INTERFACES)
