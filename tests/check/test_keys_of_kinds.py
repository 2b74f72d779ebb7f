"""Every key on every kind of field, step and example that cannot have it, each with the message of its rule."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, get_args

import pytest
import yaml
from codewheel.language.check import check_document
from codewheel.language.keys_of_fields import KIND_KEYS, WrittenField
from codewheel.language.keys_of_specs import WrittenExample, WrittenStep
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.language.schemas import load_schema
from codewheel.loading.fields import LayoutContext, build_kind
from codewheel.model import Kind, Number
from codewheel.model.expressions import Expression
from codewheel.model.kinds import DIGIT_CODES

BASE = Path(__file__).parent / "ok" / "minimal.yaml"
NUMBER = "number"
#: A field of each kind.
FIELDS: Mapping[str, dict[str, Any]] = {
    NUMBER: {"bits": 8},
    "constant": {"bits": 8, "constant": 1},
    "unused": {"bits": 8, "unused": 0},
    "active": {"active": "high"},
    "values": {"bits": 4, "values": {"on": {"value": 1}}},
    "values_of": {"bits": 4, "values_of": "data_ids"},
    "crc": {"crc": "biss_6"},
    "parity_of": {"parity_of": "data"},
    "digits": {"bits": 7, "digits": [{"name": "tens", "digits": 1}, {"name": "ones", "digits": 1}]},
    "text": {"bits": 8, "text": "ascii"},
}
#: Keys of every kind of field.
ANY_FIELD = frozenset(
    "name printed_name names use bits at top_bit low_bit padded_to implemented reserved explained_by default meaning"
    " note source".split()
)
#: The kinds that can have a key, with a value of it, and the beginning of the message if a field has another kind.
OWNERS: Mapping[str, tuple[tuple[str, ...], Any, str]] = {
    **{
        key: (("active",), value, f"'{key}' is only for flags; to make ")
        for key, value in (
            ("when_active", "Hot"),
            ("when_inactive", "Cold"),
            ("makes_position_if", {"answer": "usable_with_warning"}),
            ("sums_up", ["data"]),
            ("only", "MIN12"),
            ("remedy", "Wait."),
            ("by_hand", ["repair"]),
        )
    },
    "makes_position": (("active", "unused"), "usable", "'makes_position' is only for flags; to make "),
    "others": (("values",), "reserved", "'others' names the values that 'values' does not list; "),
    "crc_of": (("crc",), ["data"], "'crc_of' is only for CRCs; to make "),
    "byte_order": (
        (NUMBER, "values", "constant", "digits", "crc"),
        "low_byte_first",
        "'byte_order' is only for numbers, named values, constants and CRCs; ",
    ),
    "parity": (("parity_of",), "odd", "'parity' is only for parity bits; to make "),
    "over": (("parity_of",), "odd_bits", "'over' is only for parity bits; to make "),
    "equals": ((NUMBER, "values", "text"), "1", "'equals' is only for numbers, text and named values; "),
    **{
        key: ((NUMBER,), value, f"'{key}' is only for numbers; ")
        for key, value in (
            ("signed", True),
            ("zero_means", 256),
            ("power_of_two", True),
            ("digit_code", "bcd"),
            ("unit", "counts"),
            ("scale", {"unit": "°C", "numerator": 1, "denominator": 10, "offset": 0}),
        )
    },
}
#: The message if the kind has a reason of its own.
OWN_REASONS = {("makes_position", "values"): "'case' has named values, and not each of them has the same effect"}
STEPS: Mapping[str, dict[str, Any]] = {
    "write": {"register": "bank", "value": "number"},
    "read": {"register": "bank"},
    "poll": {"register": "bank", "field": "bank", "until": 0},
    "wait": {"at_least_ms": 1},
    "send": {"data_id": "data_0"},
}
ANY_STEP = frozenset(("do", "meaning", "source"))
OWNERS_OF_STEPS: Mapping[str, tuple[tuple[str, ...], Any]] = {
    "register": (("write", "read", "poll"), "bank"),
    "value": (("write",), "number"),
    "field": (("write", "read", "poll"), "bank"),
    "until": (("poll",), 1),
    "at_least_ms": (("wait",), 1),
    "data_id": (("send",), "data_0"),
    "times": (("send",), 2),
    "every_at_least_us": (("send",), 1),
    "in_succession": (("send",), True),
}
EXAMPLES: Mapping[str, dict[str, Any]] = {
    "frame": {"layout": "single_cycle_data", "from": "encoder", "bits": "1", "values": {"position": 1}},
    "register": {"register": "bank", "bytes": "01", "values": {"bank": 1}},
    "crc": {"crc": "biss_6", "bytes": "01", "check": 1},
    "procedure": {"procedure": "procedure", "writes": [{"address": 0x40, "value": 1}]},
    "measure": {"order_code": "MIN12SC", "counts": 1, "micrometres": 1},
}
ANY_EXAMPLE = frozenset(("name", "kind", "source", "erratum", "note"))
OWNERS_OF_EXAMPLES: Mapping[str, tuple[tuple[str, ...], Any]] = {
    "counts": (("measure",), 1),
    "micrometres": (("measure",), 1),
    "order_code": (("frame", "register", "procedure", "measure"), "MIN12SC"),
    "alternatives": (("frame",), {"question": "answer"}),
    "layout": (("frame",), "single_cycle_data"),
    "register": (("register",), "bank"),
    "procedure": (("procedure",), "procedure"),
    "crc": (("crc",), "biss_6"),
    "from": (("frame",), "encoder"),
    "bytes": (("frame", "register", "crc"), "01"),
    "bits": (("frame",), "1"),
    "check": (("crc",), 1),
    "arguments": (("procedure",), {"number": 1}),
    "values": (("frame", "register"), {"position": 1}),
    "writes": (("procedure",), [{"address": 0x40, "value": 1}]),
    "refused": (("frame",), "crc"),
}
#: A part with a key that its kind cannot have: its map, the key at which it is reported, and the start of the message.
Case = tuple[dict[str, Any], str, str]


def problems_of(data: dict[str, Any], folder: Path) -> dict[str, list[str]]:
    """Return the messages about a spec, by their path in it."""
    path = folder / "spec.yaml"
    path.write_text(yaml.safe_dump(data, allow_unicode=True, sort_keys=False), encoding="utf-8")
    report = ProblemReport()
    document = read_document(path, report, path.name)
    assert document is not None
    check_document(document, report)
    messages: dict[str, list[str]] = {}
    for problem in report.problems:
        messages.setdefault(problem.path, []).append(f"{problem.rule}: {problem.message}")
    return messages


def base() -> dict[str, Any]:
    data: dict[str, Any] = yaml.safe_load(BASE.read_text(encoding="utf-8"))
    return data


def cases_of_fields() -> Iterator[Case]:
    """Yield a field of each kind with each key of other kinds, and a field with each two kinds."""
    for kind, keys in FIELDS.items():
        for key, (owners, value, message) in OWNERS.items():
            if kind not in owners:
                field = {"name": "case", **keys, key: value}
                yield field, key, f"layout-keys: {OWN_REASONS.get((key, kind), message)}"
    kinds = [kind for kind in FIELDS if kind != NUMBER]
    for index, first in enumerate(kinds):
        for second in kinds[index + 1 :]:
            field = {"name": "case", **FIELDS[first], **FIELDS[second]}
            message = f"'{first}' and '{second}' exclude each other; keep one of them"
            yield field, second, f"layout-keys: {message}"


def cases_of_steps() -> Iterator[Case]:
    for kind, keys in STEPS.items():
        for key, (owners, value) in OWNERS_OF_STEPS.items():
            if kind not in owners:
                yield {"do": kind, **keys, key: value}, key, f"step-shape: '{key}' does not apply to a {kind} step"


def cases_of_examples() -> Iterator[Case]:
    for kind, keys in EXAMPLES.items():
        for key, (owners, value) in OWNERS_OF_EXAMPLES.items():
            if kind not in owners:
                example = {"name": "case", "kind": kind, "source": "6", **keys, key: value}
                yield example, key, f"example-shape: '{key}' does not apply to a {kind} example"


def spec_with_fields(cases: list[Case]) -> tuple[dict[str, Any], list[str]]:
    """Return a spec with the fields, each in a group of its own, and the path of each in messages."""
    data = base()
    fields_with_data = [{"name": "data", "bits": 8}]
    data["field_groups"] = [
        {"name": f"case_{index}", "bits": 8, "source": "6", "fields": [*fields_with_data, part]}
        for index, (part, _, _) in enumerate(cases)
    ]
    return data, [f"field_groups.case_{index}.fields.case" for index, _ in enumerate(cases)]


def spec_with_steps(cases: list[Case]) -> tuple[dict[str, Any], list[str]]:
    data = base()
    argument = {"name": "number", "of": "bank", "meaning": "Number"}
    data["procedures"] = [
        {
            "name": "procedure",
            "title": "Procedure",
            "interface": "biss",
            "arguments": [argument],
            "steps": [part for part, _, _ in cases],
            "source": "6",
        }
    ]
    return data, [f"procedures.procedure.steps[{index + 1}]" for index, _ in enumerate(cases)]


def spec_with_examples(cases: list[Case]) -> tuple[dict[str, Any], list[str]]:
    data = base()
    data["examples"] = [{**part, "name": f"case_{index}"} for index, (part, _, _) in enumerate(cases)]
    return data, [f"examples.case_{index}" for index, _ in enumerate(cases)]


PARTS = {
    "field": (cases_of_fields, spec_with_fields),
    "step": (cases_of_steps, spec_with_steps),
    "example": (cases_of_examples, spec_with_examples),
}


def test_each_key_of_a_part_with_kinds_belongs_to_some_of_them() -> None:
    """A new key needs a line in the tables here, or is a key of all kinds. Its class names the same kinds."""
    tables: tuple[tuple[Any, frozenset[str], Mapping[str, tuple[Any, ...]]], ...] = (
        (WrittenField, ANY_FIELD | {*KIND_KEYS}, OWNERS),
        (WrittenStep, ANY_STEP, OWNERS_OF_STEPS),
        (WrittenExample, ANY_EXAMPLE, OWNERS_OF_EXAMPLES),
    )
    for part_class, keys_of_all, owners_by_key in tables:
        owners_in_class = {described.name: {*described.key.owners} for described in part_class.described_keys}
        expected_owners: dict[str, set[str]] = {name: set() for name in keys_of_all}
        expected_owners |= {name: {*owners} for name, (owners, *_) in owners_by_key.items()}
        assert owners_in_class == expected_owners


@pytest.mark.parametrize("name", PARTS)
def test_a_key_on_a_wrong_kind_is_reported(name: str, tmp_path: Path) -> None:
    cases_of, spec_with = PARTS[name]
    cases = list(cases_of())
    data, paths = spec_with(cases)
    messages = problems_of(data, tmp_path)
    unreported_cases = []
    for (part, key, message), path in zip(cases, paths, strict=True):
        messages_at_key = messages.get(f"{path}.{key}", [])
        if not any(reported.startswith(message) for reported in messages_at_key):
            unreported_cases.append((key, part, messages_at_key))
    assert len(cases) > 30
    assert unreported_cases == []


def test_a_field_of_each_kind_is_valid_without_them(tmp_path: Path) -> None:
    """Otherwise another mistake could hide the mistake of a key."""
    cases: list[Case] = [({"name": "case", **keys}, "", "") for keys in FIELDS.values()]
    data, _ = spec_with_fields(cases)
    shape_problems = [text for texts in problems_of(data, tmp_path).values() for text in texts if "layout-keys" in text]
    assert shape_problems == []


def test_each_key_of_a_kind_makes_its_own_kind() -> None:
    """Without its case in ``build_kind``, a field with the key would silently be a number."""
    context = LayoutContext(
        ProblemReport(),
        group_and_path_by_name={},
        definitions={},
        parameter_sets_by_interface={},
        crc_by_name={},
        data_ids_by_interface={"rs485": ()},
    )
    kinds = {}
    for key in KIND_KEYS:
        kinds[key] = type(build_kind({"name": "level", **FIELDS[key]}, context, "rs485", Expression(8)))
    assert Number not in kinds.values()
    assert {Number, *kinds.values()} == set(get_args(Kind))


def test_specs_can_name_each_code_of_digits() -> None:
    codes_in_schema = load_schema("device")["$defs"]["field"]["properties"]["digit_code"]["enum"]
    assert codes_in_schema == [*DIGIT_CODES]
