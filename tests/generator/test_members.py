"""The table of members: it describes the whole model, and every output takes its members from there."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest
from codewheel import model
from codewheel.changes import compare as changes
from codewheel.changes.families import compare_family
from codewheel.changes.rules import RULES
from codewheel.dump import plain, schema
from codewheel.dump.xml import schema_text, to_xml
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.language.schemas import described_parts
from codewheel.language.written import WrittenPart
from codewheel.model import Device, Register
from codewheel.model.keys_and_members import name_of_part
from codewheel.model.members import PARTS, PARTS_BY_CLASS, ModelMember, ModelPart
from codewheel.model.part import keys_of
from codewheel.model.record import dataclass
from codewheel.readings import stated
from codewheel.readings.compare_readings import compare
from codewheel.readings.reading import FactClass, SpecReading
from codewheel.readings.second_readings import facts_of
from codewheel.targets.python import facts
from codewheel.targets.python.facts import record_by_register

SPEC = Path(__file__).parents[2] / "specs/lika/amm5.yaml"
#: Records with another name than the part of the model.
RECORDS = {
    "BissFacts": "interface",
    "DataIdFacts": "data_id",
    "FieldFacts": "field",
    "NamedValue": "value",
    "OrderCode": "order_code_grammar",
    "Part": "code_part",
    "PartValue": "code_value",
    "Rs485Facts": "interface",
    "SpiFacts": "interface",
    "SsiFacts": "interface",
}
#: Parts of a spec whose data have another name.
NAMES_IN_DATA = {
    **dict.fromkeys(("ssi", "biss", "rs485", "spi"), "interface"),
    **dict.fromkeys(("rs485_exchange", "spi_exchange"), "exchange"),
    "order_code": "order_code_grammar",
}
#: Parts of a spec that the data do not have: their keys become members of other parts, or only ``check`` reads them.
ONLY_IN_SPECS = {"spec", "interfaces", "control_data", "gray", "printed_default", "reading", "section", "change"}
#: Keys of a spec that the data do not have: other members follow from them, or only ``check`` reads them.
KEYS_ONLY_IN_SPECS = {
    "field": "use bits at top_bit low_bit padded_to makes_position_if others values_of text",
    "field_group": "other_bits fields",
    "layout": "when gray",
    "register_meaning": "is",
    "register": "addresses volatile",
    "code_value": "meaning_differs",
    "code_part": "label_is",
    "alternative": "values",
    "argument": "as",
    "step": "until at_least_ms every_at_least_us",
    "procedure": "printed_writes",
    "erratum": "readings",
    "manual": "contents",
    "manual_edition": "before then",
    "document": "pages",
}
#: Members that Python users have elsewhere: in the classes of frames and registers, in ``VARIANTS``, or as bytes.
ELSEWHERE = {
    "FieldFacts": """kind high low width group container padding_of makes_position sums_up only only_while
        verdict_parameter verdict_if_set remedy by_hand values crc
        crc_of parity_of parity over digits equals equals_text""",
    "Register": "interface last_address default_bytes min max limits_of wait_at_least_ms other_bits join",
    "Timing": "interface",
    "Crc": "poly_with_top_bit",
    "NamedValue": "printed_name names makes_position",
    "ControlField": "names",
    "Alarm": "group",
    "Erratum": "overlay edition",
    "PartValue": "interface sets only_with supply",
}


def test_each_key_of_a_spec_is_a_member_of_the_data() -> None:
    """Otherwise a new key would be read from specs and then dropped without a word."""
    members = {part.name: {member.name for member in part.members} for part in PARTS}
    written_classes = [kind for kind in described_parts().values() if issubclass(kind, WrittenPart)]
    dropped_keys = {}
    for written_class in written_classes:
        name = name_of_part(written_class.__name__)
        if name in ONLY_IN_SPECS:
            continue
        keys = {described.name for described in keys_of(written_class)} - {"source"}
        dropped_keys[name] = keys - members[NAMES_IN_DATA.get(name, name)]
    expected_keys = {name: {*keys.split()} for name, keys in KEYS_ONLY_IN_SPECS.items()}
    assert {name: keys for name, keys in dropped_keys.items() if keys} == expected_keys


@pytest.mark.parametrize("kind", sorted(PARTS_BY_CLASS))
def test_every_member_of_the_model_is_in_the_table(kind: str) -> None:
    """A new member must have a rule, or none for a reason."""
    names = {member.name for member in fields(getattr(model, kind))} - {"source"}
    assert names <= set(PARTS_BY_CLASS[kind].by_attribute)


def test_the_table_names_rules_and_classes_of_facts_that_exist() -> None:
    members = [member for part in PARTS for member in part.members]
    assert {member.rule for member in members} - {""} <= set(RULES)
    assert {member.read for member in members} - {""} <= {sort.value for sort in FactClass}


def parts_of_records() -> Iterator[tuple[str, ModelPart]]:
    parts_by_name = {part.name: part for part in PARTS}
    for record in facts.runtime_records().members:
        name = RECORDS.get(record) or re.sub(r"(?<=[a-z])(?=[A-Z])", "_", record).lower()
        if name in parts_by_name and name != "interface":
            yield record, parts_by_name[name]


@pytest.mark.parametrize(
    ("record", "part"), list(parts_of_records()), ids=lambda value: value if isinstance(value, str) else ""
)
def test_records_of_python_have_the_members(record: str, part: ModelPart) -> None:
    """A member of the data that the class of a record lacks would be missing from the Python package."""
    names = {member.name for member in facts.runtime_records().members[record]} | set(ELSEWHERE.get(record, "").split())
    assert {
        member.name for member in part.members if member.data_type and member.attribute not in names
    } - names == set()


NEW = ModelMember("needs_restart", "boolean=false", "True if it needs a restart.", "register-rule", read="behaviour")
#: The class of registers with one more property. The table finds it by its name.
NEW_REGISTER: Any = dataclass(frozen=True)(
    type("Register", (Register,), {"__annotations__": {"needs_restart": "bool"}, "needs_restart": False})
)


@pytest.fixture
def property_(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A property of registers that is only documented, described in the table and in the class of the record."""
    old = PARTS_BY_CLASS["Register"]
    part = ModelPart(old.name, old.about, *old.members, NEW)
    by_class: Mapping[str, ModelPart] = {**PARTS_BY_CLASS, "Register": part}
    for module in (plain, changes, stated):
        monkeypatch.setattr(module, "PARTS_BY_CLASS", by_class)
    monkeypatch.setattr(schema, "PARTS", tuple(part if candidate is old else candidate for candidate in PARTS))
    original_records = facts.runtime_records()
    members = (*original_records.members["Register"], facts.RecordMember("needs_restart", frozenset(), default=False))
    extended_records = replace(original_records, members={**original_records.members, "Register": members})
    monkeypatch.setattr(facts, "runtime_records", lambda: extended_records)
    schema.schema_of_device_data.cache_clear()
    schema_text.cache_clear()
    yield
    schema.schema_of_device_data.cache_clear()
    schema_text.cache_clear()


def with_property(device: Device, value: bool) -> Device:
    """Return the device, with this value of the property in its first register."""
    registers = []
    for index, register in enumerate(device.registers):
        members = {member.name: getattr(register, member.name) for member in fields(Register)}
        registers.append(NEW_REGISTER(**members, needs_restart=value and not index))
    return replace(device, registers=tuple(registers))


@pytest.mark.slow
@pytest.mark.usefixtures("property_")
def test_a_documented_property_reaches_every_output_diff_and_the_second_reading(amm5: Device) -> None:
    old, new = with_property(amm5, False), with_property(amm5, True)
    name = new.registers[0].name
    dump = plain.device_dump(new)
    assert [register["name"] for register in dump["registers"] if register["needs_restart"]] == [name]
    assert 'needs_restart="true"' in to_xml(dump)
    assert 'name="needs_restart"' in schema_text()
    assert schema.schema_of_device_data()["$defs"]["register"]["properties"]["needs_restart"]["type"] == "boolean"
    assert [key for key, row in record_by_register(new).items() if "needs_restart=True" in row.flat] == [name]
    (change,) = compare_family(old, new)
    assert change.text.endswith(f" {name}: needs restart no → yes")
    assert change.rule.name == "register-rule"
    document = read_document(SPEC, ProblemReport())
    assert document is not None
    (found,) = compare(facts_of(SpecReading(old, document)), facts_of(SpecReading(new, document))).disagreements
    values = found.spec_value, found.second_value
    assert (found.description.partition(" of ")[0], *values) == (
        "needs restart",
        "nothing",
        "yes",
    )
