"""Output of ``show --json``: its structure, and that it contains every fact of the spec."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from codewheel.commands.decode.plain_data import decoded_data
from codewheel.dump.plain import device_dump, variant_dump
from codewheel.dump.schema import schema_of_device_data
from codewheel.language.files import is_second, is_word_sheet
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.language.schemas import load_schema
from codewheel.loading.spec_parts import parse_sources
from codewheel.model import Device, FrameExample, Variant
from codewheel.model.expressions import Expression, ExpressionError
from codewheel.order_codes.labels import find_code
from codewheel.reference.codec import decode_bytes
from codewheel.reference.findings import findings
from codewheel.targets import Library

# Checks all families against the schemas of data, which do not depend on wording or rules of check.
pytestmark = pytest.mark.slow

SPECS = Path(__file__).parents[2] / "specs"


def validator(schema: Any) -> Any:
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def faults(checker: Any, data: object) -> list[str]:
    return [f"{'.'.join(map(str, error.path))}: {error.message[:160]}" for error in checker.iter_errors(data)]


def test_families_have_the_shape(devices: Mapping[str, Device]) -> None:
    checker = validator(schema_of_device_data())
    for device in devices.values():
        assert faults(checker, device_dump(device)) == []


def test_order_codes_have_the_shape_and_no_expressions(devices: Mapping[str, Device]) -> None:
    """Validation is slow, so only the last order code of each interface is validated."""
    checker = validator(schema_of_device_data())
    for device in devices.values():
        last = {variant.interface: variant for variant in device.variants}
        for variant in device.variants:
            dump = variant_dump(device, find_code(device, variant.code))
            _check_order_code(dump, variant)
            if variant == last[variant.interface]:
                assert faults(checker, dump) == []


def _check_order_code(dump: Any, variant: Variant) -> None:
    fields = [field for layout in [*dump["layouts"], *dump["registers"]] for field in layout["fields"]]
    places = [field[key] for field in fields for key in ("high", "low", "width")]
    assert all(isinstance(place, int) for place in places)
    other_interfaces = {"ssi": {"biss", "rs485"}, "biss": {"ssi", "rs485"}, "rs485": {"ssi", "biss"}}[variant.interface]
    assert not other_interfaces & {parameter["interface"] for parameter in dump["parameter_definitions"]}
    assert dump["parameters"].items() <= dict(variant.parameters).items()
    assert dump["order_codes"][0]["parameters"] == dump["parameters"]
    assert set(dump["interfaces"]) == {variant.interface}


def test_the_schema_refuses_another_shape(amm5: Device) -> None:
    checker = validator(schema_of_device_data())
    assert not checker.is_valid(device_dump(amm5) | {"more": 1})
    assert not checker.is_valid({key: value for key, value in device_dump(amm5).items() if key != "crcs"})


def test_decode_has_the_shape(amm5: Device) -> None:
    checker = validator(load_schema("decode"))
    for example in amm5.examples:
        if isinstance(example, FrameExample) and example.bytes:
            variant = find_code(amm5, example.order_code).variant
            decoded = decode_bytes(amm5, variant, example.sender, example.bytes)
            assert (
                faults(checker, decoded_data(amm5, variant, example.sender, decoded, findings(amm5, variant, decoded)))
                == []
            )


def named_parts(value: Any) -> Iterator[dict[str, Any]]:
    if isinstance(value, dict):
        if isinstance(value.get("name"), str):
            yield value
        for key, inner in value.items():
            if not (
                key == "values" and isinstance(inner, dict)
            ):  # The values of an example have the names of fields as keys.
                yield from named_parts(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from named_parts(inner)


def test_every_named_item_has_a_source(devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        dump = device_dump(device)
        del dump["manufacturer"]
        unsourced = [named["name"] for named in named_parts(dump) if not named.get("source")]
        assert unsourced == []


def leaves(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for name, inner in value.items():
            if name not in TOLD_TO_CHECK:
                yield from leaves(inner, name)
    elif isinstance(value, list):
        for inner in value:
            yield from leaves(inner, key)
    else:
        yield key, value


#: Keys that describe how the spec is written. Positions, kinds and widths contain the same facts.
WRITTEN = {"codewheel", "use", "at", "top_bit", "values_of", "text", "active"}
#: Places where an edition changes something. The change itself is described in words.
WRITTEN |= {"set", "add", "remove", "unknown"}


#: Statements of errata about the second reading and about repeated facts. Only check reads them.
TOLD_TO_CHECK = frozenset(("readings", "addresses", "printed_writes", "printed_defaults", "contents"))
# The pages of other documents that were read.
TOLD_TO_CHECK |= {"pages"}


def is_expression(text: str) -> bool:
    try:
        return bool(Expression.parse(text).terms)
    except ExpressionError:
        return False


def number_or_text(text: str) -> int | str:
    """Return the number that a power such as 2^16 represents, or else the text."""
    power = re.fullmatch(r"2\^(\d+)", text)
    return text if power is None else 1 << int(power[1])


def _encoder_specs() -> list[Path]:
    paths = [path for path in SPECS.glob("*/*.yaml") if path.stem != "manufacturer" and path.parent.name != "masters"]
    return sorted(path for path in paths if not is_second(path) and not is_word_sheet(path))


@pytest.mark.parametrize("path", _encoder_specs(), ids=lambda path: path.stem)
def test_every_fact_of_the_spec_is_there(path: Path, every_encoder: Library) -> None:
    document = read_document(path, ProblemReport())
    assert document is not None
    device = next(device for device in every_encoder.devices if device.name == document.data["device"])
    dump = device_dump(device)
    dumped_values = [value for _, value in leaves(dump)]
    dumped_texts = {value for value in dumped_values if isinstance(value, str)}
    dumped_words = {word for text in dumped_texts for word in text.split()}
    dumped_numbers = {value for value in dumped_values if isinstance(value, int)}
    dumped_citations = {(source["document"], source["section"], source["page"]) for source in sources(dump)}
    dumped_keys = set(map(str, keys(dump)))
    missing_facts = []
    for key, written in leaves(document.data):
        if key in WRITTEN or isinstance(written, bool) or (isinstance(written, str) and is_expression(written)):
            continue
        value = number_or_text(written) if isinstance(written, str) else written
        if key == "source" or key.endswith("_source"):
            named = [(source, (source.document, source.section, source.page)) for source in parse_sources(value)]
            missing_facts += [str(source) for source, citation in named if citation not in dumped_citations]
        elif isinstance(value, int):
            # The dump has some quantities in thousandths of the unit of the spec.
            is_dumped = not dumped_numbers.isdisjoint({value, value * 1000}) or str(value) in dumped_texts
            missing_facts += [] if is_dumped else [f"{key}: {value}"]
        elif isinstance(value, str):
            plain = value.strip()
            is_dumped = not {plain, plain.upper()}.isdisjoint(dumped_texts) or plain in dumped_keys | dumped_words
            missing_facts += [] if is_dumped or key == "manufacturer" else [f"{key}: {plain}"]
    assert missing_facts == []


def sources(value: Any) -> Iterator[dict[str, Any]]:
    if isinstance(value, dict):
        if set(value) == {"document", "section", "page"}:
            yield value
        for inner in value.values():
            yield from sources(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from sources(inner)


def keys(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        yield from value
        for inner in value.values():
            yield from keys(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from keys(inner)


def test_an_order_code_as_worked_out_by_hand(amm5: Device) -> None:
    dump = variant_dump(amm5, find_code(amm5, "AMM5A21/65KSC1-LABEL"))
    assert (dump["order_code"], dump["interface"], dump["label"]["tail"]) == ("AMM5A21/65KSC1", "biss", "-LABEL")
    (layout,) = dump["layouts"]
    assert layout["bits"] == 45
    places = {field["name"]: (field["high"], field["low"]) for field in layout["fields"]}
    assert places == {"multiturn": (44, 29), "singleturn": (28, 8), "error": (7, 7), "warning": (6, 6), "crc": (5, 0)}
    preset = next(register for register in dump["registers"] if register["name"] == "preset")
    assert (preset["address"], preset["length"], preset["min"], preset["max"]) == (0x11, 7, 0, 2**37 - 1)
    assert preset["source"] == {"document": "", "section": "6.4", "page": 35}


def test_what_belongs_to_another_interface_is_left_out(amm5: Device) -> None:
    dump = variant_dump(amm5, find_code(amm5, "AMM5A23/1JP1"))
    assert dump["registers"] == []
    assert {crc["name"] for crc in dump["crcs"]} == {"rs485_8"}
    assert "scd_length" not in {erratum["name"] for erratum in dump["errata"]}
    assert "mem_busy_position" in {erratum["name"] for erratum in dump["errata"]}
    assert all(timing["interface"] in ("", "rs485") for timing in dump["timings"])


def test_an_order_code_has_only_the_modulus_that_holds_for_it(devices: Mapping[str, Device]) -> None:
    """Over RS-485, the position at 1 µm has 24 bits [SMA21 7.3.3], although it has 25 over SSI and BiSS [5.2]."""
    sma21 = devices["sma21"]
    dumps = {code: variant_dump(sma21, find_code(sma21, code)) for code in ("SMA21-JP1-0001", "SMA21-BG1-0001")}
    assert dumps["SMA21-JP1-0001"]["measurement"]["modulus"] == 2**24
    assert dumps["SMA21-BG1-0001"]["measurement"]["modulus"] == 2**25
    assert "modulus" not in dumps["SMA21-JP1-0001"]["parameters"]
    assert dumps["SMA21-BG1-0001"]["parameters"]["modulus"] == 2**25
    ranges = {layout["name"]: layout["position_range"] for layout in dumps["SMA21-JP1-0001"]["layouts"]}
    assert [name for name, position_range in ranges.items() if position_range is not None] == ["wide_position_reply"]
    assert ranges["wide_position_reply"]["wraps"] is False
