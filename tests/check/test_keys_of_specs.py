"""Parts of a spec as they are written: typed attributes, places, and the keys that were given."""

from __future__ import annotations

import ast
import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from codewheel.language import keys_of_masters, keys_of_specs
from codewheel.language.check import check_document
from codewheel.language.keys_of_fields import WrittenField, WrittenLayout, WrittenRegister
from codewheel.language.keys_of_order_codes import WrittenBiss
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.language.schemas import described_parts
from codewheel.language.written import LocatedPart, WrittenPart
from codewheel.model.expressions import Expression
from codewheel.model.keys_and_members import name_of_part
from codewheel.model.part import keys_of

#: Methods of written parts whose argument is a key.
_ASKING = ("has", "is_valid", "names_in", "path_of")
RULES = Path(keys_of_specs.__file__).parent / "rules"
#: Most places at which rules may ask by text whether a key was given.
MOST_PRESENCE_TESTS = 40
#: Most keys with a literal JSON Schema, and most keys with a second sentence.
MOST_OWN_SCHEMAS, MOST_SECOND_SENTENCES = 5, 110
#: Most reads of a map by text in rules, most of them of maps with a type.
MOST_UNTYPED_READS = 125
SPEC = Path(__file__).parents[2] / "specs/lika/amm5.yaml"


def test_attributes_have_the_values_of_the_spec() -> None:
    spec = yaml.safe_load(SPEC.read_text(encoding="utf-8"))
    registers = [WrittenRegister(data) for data in spec["registers"]]
    assert [register.name for register in registers] == [data["name"] for data in spec["registers"]]
    biss = WrittenBiss(spec["interfaces"]["biss"], ("interfaces", "biss"))
    data = spec["interfaces"]["biss"]
    (clock,) = biss.clock
    assert clock.part.max_hz == data["clock"]["max_hz"]
    assert clock.path == ("interfaces", "biss", "clock")
    assert [layout.name for layout in biss.layouts] == [layout["name"] for layout in data["layouts"]]
    assert biss.layouts[0].fields[0].path == ("interfaces", "biss", "layouts", 0, "fields", 0)


def test_a_key_can_be_a_reserved_word() -> None:
    layout = WrittenLayout({"from": "master"}, ("here",))
    assert layout.from_ == "master"
    assert layout.has("from")
    assert layout.path_of("from") == ("here", "from")


@pytest.mark.parametrize(
    ("data", "attribute", "expected"),
    [
        ({"name": 3}, "name", ""),
        ({"bits": [1]}, "bits", None),
        ({"bits": True}, "bits", None),
        ({"active": "sideways"}, "active", ""),
        ({"sums_up": "overflow"}, "sums_up", ()),
        ({"sums_up": ["overflow", 3]}, "sums_up", ("overflow",)),
        ({"parity_of": "position"}, "parity_of", ("position",)),
        ({"implemented": "no"}, "implemented", True),
        ({"values": {"off": 3}}, "values", {}),
    ],
)
def test_a_value_of_a_wrong_type_is_missing_but_its_key_was_given(
    data: dict[str, object], attribute: str, expected: object
) -> None:
    field = WrittenField(data)
    assert getattr(field, attribute) == expected
    assert field.has(attribute)
    assert not field.has("note")


def test_a_part_of_any_shape_can_be_read() -> None:
    for data in (None, 3, "text", [], {}):
        field = WrittenField(data)
        assert (field.name, field.bits, field.scale, dict(field.values)) == ("", None, None, {})


def test_a_part_of_the_model_has_its_place_and_its_keys() -> None:
    biss = WrittenBiss({"measurement": {"of": "position", "turns": "2^turn_bits", "modulus": "2^"}}, ("biss",))
    measurement = biss.measurement
    assert measurement is not None
    assert measurement.part.turns == Expression.parse("2^turn_bits")
    assert measurement.part.modulus is None
    assert measurement.has("modulus")
    assert measurement.path == ("biss", "measurement")


def test_one_part_and_a_list_of_parts_read_as_a_tuple() -> None:
    row = {"max_hz": 1_000_000, "source": "5"}
    for data, paths in ((row, [("biss", "clock")]), ([row, row], [("biss", "clock", 0), ("biss", "clock", 1)])):
        biss = WrittenBiss({"clock": data}, ("biss",))
        assert [(clock.part.max_hz, clock.path) for clock in biss.clock] == [(1_000_000, path) for path in paths]


def test_every_key_of_every_part_can_be_read_from_an_empty_map() -> None:
    written_classes = [kind for kind in described_parts().values() if issubclass(kind, WrittenPart)]
    assert len(written_classes) > 25
    for kind in written_classes:
        part = kind({})
        for described in keys_of(kind):
            name = described.name if hasattr(kind, described.name) else f"{described.name}_"
            value = getattr(part, name)
            if isinstance(value, tuple) and len(value) == 1:  # One of several rows.
                (value,) = value
            is_empty = not value or (isinstance(value, (WrittenPart, LocatedPart)) and not value.data)
            assert is_empty or value is described.default, f"{kind.__name__}.{name}"


def master_classes() -> list[type[WrittenPart]]:
    """Return the classes of the parts of a master."""
    classes = [value for value in vars(keys_of_masters).values() if isinstance(value, type)]
    return [kind for kind in classes if issubclass(kind, WrittenPart) and kind is not WrittenPart]


def schema_of(kind: type[WrittenPart]) -> dict[str, Any]:
    """Return the schema of a class of ``master_classes``."""
    master = json.loads((Path(keys_of_specs.__file__).parent / "master.schema.json").read_text(encoding="utf-8"))
    schemas = {"master": master, **master["$defs"]}
    schema: dict[str, Any] = schemas[name_of_part(kind.__name__).removeprefix("master_")]
    return schema


def test_classes_of_masters_have_the_keys_of_their_schema() -> None:
    classes = master_classes()
    assert len(classes) > 10
    for kind in classes:
        schema = schema_of(kind)
        for described in keys_of(kind):
            assert described.name in schema["properties"], f"{kind.__name__}.{described.name}"
            is_required = described.name in schema.get("required", ())
            assert described.is_required == is_required, f"{kind.__name__}.{described.name}"


def sites_of_presence_tests() -> set[tuple[str, int]]:
    """Return each call in the rules that asks by text whether a key was given, as its module and line."""
    sites = set()
    for path in RULES.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            is_presence_test = isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "has"
            if is_presence_test and any(isinstance(argument, ast.Constant) for argument in node.args):
                sites.add((path.name, node.lineno))
    return sites


@pytest.mark.slow
def test_each_presence_test_asks_for_a_key_of_its_class(monkeypatch: pytest.MonkeyPatch) -> None:
    """mypy sees misspelt attributes, but not keys in texts. The broken specs reach every place that asks for a key."""
    keys_by_class = {kind: set(schema_of(kind)["properties"]) for kind in master_classes()}
    keys_by_class |= {kind: {described.name for described in keys_of(kind)} for kind in described_parts().values()}
    reached_sites: set[tuple[str, int]] = set()
    foreign_keys: set[tuple[str, str]] = set()

    def ask(part: Any, *names: str) -> bool:
        caller = sys._getframe(1)
        reached_sites.add((Path(caller.f_code.co_filename).name, caller.f_lineno))
        kind = type(part.part if isinstance(part, LocatedPart) else part)
        foreign_keys.update((kind.__name__, name) for name in names if name not in keys_by_class[kind])
        return any(name in part.data for name in names)

    monkeypatch.setattr(WrittenPart, "has", ask)
    monkeypatch.setattr(LocatedPart, "has", ask)
    broken_specs = [*Path(__file__).parent.glob("broken/*.yaml"), *Path(__file__).parents[1].glob("masters/broken/*")]
    for path in broken_specs:
        report = ProblemReport()
        document = read_document(path, report, path.name)
        if document is not None:
            check_document(document, report)
    assert foreign_keys == set()
    sites = sites_of_presence_tests()
    assert 10 < len(sites) <= MOST_PRESENCE_TESTS
    assert sites - reached_sites == set()


def test_rules_ask_only_for_keys_that_exist() -> None:
    """mypy sees misspelt attributes, but not keys in texts."""
    classes = (*described_parts().values(), *master_classes())
    known_keys = {described.name for kind in classes for described in keys_of(kind)}
    asked_keys = set()
    for path in RULES.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in _ASKING:
                asked_keys |= {argument.value for argument in node.args if isinstance(argument, ast.Constant)}
    assert "crc_of" in asked_keys
    assert asked_keys - known_keys == set()


def test_rules_have_no_values_that_mypy_does_not_check() -> None:
    """A value of any type is an object, whose type a rule must ask for."""
    modules_with_any = [path.name for path in RULES.glob("*.py") if re.search(r"\bAny\b", path.read_text("utf-8"))]
    assert modules_with_any == []


def test_classes_describe_types_and_keys_in_words() -> None:
    """A schema of its own, or a second sentence for readers of the data, needs a reason: mostly the type has both."""
    described_keys = [described.key for kind in described_parts().values() for described in keys_of(kind)]
    own_schemas = [key for key in described_keys if key.schema]
    second_sentences = [key for key in described_keys if key.reading or (key.about and key.data)]
    assert len(own_schemas) <= MOST_OWN_SCHEMAS
    assert len(second_sentences) <= MOST_SECOND_SENTENCES


def test_rules_read_few_values_without_a_type() -> None:
    texts = [path.read_text(encoding="utf-8") for path in RULES.glob("*.py")]
    untyped_reads = [match for text in texts for match in re.findall(r'\.get\(|\["', text)]
    assert len(untyped_reads) <= MOST_UNTYPED_READS
