"""The words of the spec language and their users. No word is specific to one manufacturer."""

from __future__ import annotations

import copy
import functools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import pytest
from codewheel.language.schemas import load_schema
from spec_words import nodes_of, read_specs

#: Manufacturer whose whole manuals were read. Its words existed before other encoders were described.
WHOLE = "lika"
#: Words that only one other manufacturer uses, with the reason to keep them.
ALONE = {
    **dict.fromkeys(
        (
            "layout.combinations",
            *(f"combination.{key}" for key in ("name", "when", "meaning", "makes_position", "note", "source")),
            "combination.makes_position.not_usable",
            "combination.makes_position.usable_with_warning",
        ),
        "two flags of the AS5045 that together mean a field out of range, and two of the AS5055A that mean an error",
    ),
    **dict.fromkeys(
        ("timeout.only", "timeout.rule.fixed", "timeout.typical_ns"),
        "fixed timeouts by a setting, of the iC-MN. Other public documents give one timeout for all models",
    ),
    **dict.fromkeys(
        ("biss.channels", "biss.channels.order", "biss.channels.source", "layout.channel"),
        "the temperature channel of the iC-MR. No second encoder with a public source is known",
    ),
    "spi.timings": "as the timings of other interfaces",
    "biss.bank_select": "banks are part of BiSS, and iC-Haus documents two more chips with them",
    "register.bank": "as bank_select",
    "parameter.by_code": "codes for widths in four iC-Haus chips, and in LENZ encoders without a public document",
    "evidence.grade.quoted": "a grade of the issue on evidence",
    "field.makes_position.usable": "one of three verdicts",
    "values.makes_position.usable_with_warning": "as field.makes_position.usable",
    "field.over": "check bits over alternate bits, of the AMT21 and the AMT22. No second manufacturer is known",
    "field.over.even_bits": "as over",
    "field.over.odd_bits": "as over",
    "field.parity": "odd parity, for a UART or an encoder with odd parity",
    "field.parity.odd": "as parity",
    "layout.byte_order.high_byte_first": "the opposite of low_byte_first",
    "measurement.per_counts": "the ratio for steps that are not whole nanometres, as in binary interpolators",
    "rs485.port.parity.even": "one of the three parities of a UART",
    "spi.exchanges.purpose.other": "requests that neither read nor write",
    "ssi.alignment.lsb_right": "the opposite of msb_left",
    "ssi.output_code.gray": "one of three values. Most manufacturers offer both codes",
}
#: Words that no encoder uses, with the reason to keep them.
UNUSED = {
    **dict.fromkeys(
        ("position_range.highest", "position_range.modulus", "position_range.source", "position_range.turns"),
        "the words of measurement, for a reply that wraps around elsewhere than others",
    ),
    **dict.fromkeys(
        (
            "biss.network.topology.bus",
            "change.add",
            "change.severity.omission",
            "change.severity.wrong_data",
            "change.value",
            "connector.interfaces.spi",
            "example.refused.constant",
            "example.refused.crc",
            "example.refused.range",
            "field_group.other_bits",
            "input.names",
            "field.makes_position_if.not_usable",
            "layout.other_bits",
            "manual_edition.date",
            "parameter.interface.spi",
            "procedure.interface.ssi",
            "register.above_max.refused",
            "register.interface.rs485",
            "register.interface.ssi",
            "rs485.port.flow_control.hardware",
            "rs485.port.flow_control.software",
            "rs485.port.parity.odd",
            "spi.measurement",
        ),
        "completes a list, or is the same key as in other places",
    ),
    "ssi.cable_lengths.only": "as clock.only. No encoder with a public source has cable lengths by order code",
    **dict.fromkeys(
        tuple(f"biss.channels.{key}" for key in ("compared", "compared_bits", "tolerance")),
        "the two words of BiSS Safety. No public document of an encoder with them gives all facts",
    ),
    "combination.printed_name": "as of a field",
    "combination.remedy": "as of a field",
    **dict.fromkeys(
        ("field.digit_code", "field.digit_code.bcd"),
        "positions in BCD over SSI. No public document of such an encoder is at hand",
    ),
    **dict.fromkeys(
        ("field.byte_order", "field.byte_order.low_byte_first", "field.byte_order.high_byte_first"),
        "the CRC of MODBUS RTU, whose encoders have only documents of sellers. Shown on a spec for tests",
    ),
    "ssi.cable_lengths.at_most_hz": "the highest clock, of linear encoders without a public document",
    "layout.gray.excess": "360 or 720 counts per turn, which so far only encoders with parallel outputs have",
    "values.makes_position.usable": "one of three verdicts",
    "code_value.meaning_differs": "the answer to a finding in words that is wrong",
    "field.parity.even": "the opposite of odd",
    "field.others": "values that a manual reserves. No encoder's spec uses it yet",
    "field.others.reserved": "as others",
}
#: Units and quantities are names of physics, not words of the language.
PHYSICS = re.compile(r"(quantity\.(unit|quantity)|scale\.unit)\.")


def words_of(schema: Mapping[str, Any], specs: Sequence[Any] | None) -> Iterator[str]:
    """Yield the words of a schema, or those that the specs use."""
    return chain.from_iterable(node.words for node in nodes_of(schema, specs))


@functools.cache
def specs() -> dict[str, list[dict[str, Any]]]:
    """Return the specs of all real encoders, by manufacturer."""
    return read_specs()


def users(schema: Mapping[str, Any]) -> dict[str, set[str]]:
    """Return the manufacturers that use each word of the language."""
    users_by_word: dict[str, set[str]] = {word: set() for word in words_of(schema, None) if not PHYSICS.match(word)}
    for name, data in specs().items():
        for word in words_of(schema, data):
            if word in users_by_word:
                users_by_word[word].add(name)
    return users_by_word


def words_of_one_manufacturer(schema: Mapping[str, Any]) -> set[str]:
    """Return the words that need a second manufacturer."""
    words = set()
    for word, manufacturers in users(schema).items():
        if len(manufacturers) == 1 and WHOLE not in manufacturers:
            words.add(word)
    return words


def unused_words(schema: Mapping[str, Any]) -> set[str]:
    """Return the words that no encoder uses."""
    return {word for word, manufacturers in users(schema).items() if not manufacturers}


def test_each_word_has_users_at_two_manufacturers() -> None:
    """Words are counted in the specs of real encoders. Words that only whole manuals need are older than the rule."""
    schema = load_schema("device")
    assert words_of_one_manufacturer(schema) - {*ALONE} == set()
    assert unused_words(schema) - {*UNUSED} == set()


def test_the_exceptions_are_words_of_the_language() -> None:
    assert {*ALONE, *UNUSED} <= {*words_of(load_schema("device"), None)}
    assert ALONE.keys().isdisjoint(UNUSED)


def test_a_word_of_one_encoder_is_found() -> None:
    """A key that one spec uses is lonely, and a key or value that none uses is unused."""
    schema: Any = copy.deepcopy(load_schema("device"))
    schema["$defs"]["spi"]["properties"]["quirk"] = {"enum": ["a", "b"]}
    assert {"spi.quirk", "spi.quirk.a", "spi.quirk.b"} <= unused_words(schema)
    [spec] = [spec for spec in specs()["mps"] if spec["device"] == "ma732"]
    spec["interfaces"]["spi"]["quirk"] = "a"
    try:
        assert {"spi.quirk", "spi.quirk.a"} <= words_of_one_manufacturer(schema)
        assert "spi.quirk.b" in unused_words(schema)
        specs()["ams"][0]["interfaces"]["spi"]["quirk"] = "a"
        assert "spi.quirk" not in words_of_one_manufacturer(schema)
    finally:
        specs.cache_clear()


def names() -> set[str]:
    """Return the names of manufacturers and families, and the parts of them that are words."""
    families = [spec["device"] for specs_of_manufacturer in specs().values() for spec in specs_of_manufacturer]
    return {part for name in (*specs(), *families) for part in (name, *name.split("_")) if len(part) > 2}


def words_with_names(words: Iterable[str]) -> set[str]:
    """Return the words that contain the name of a manufacturer or a family."""
    forbidden = names() - {"linear", "parity"}
    return {word for word in words if not forbidden.isdisjoint(re.split(r"[^a-z0-9]+", word.casefold()))}


@pytest.mark.slow
def test_no_word_names_a_manufacturer() -> None:
    for kind in ("device", "manufacturer"):
        assert words_with_names(words_of(load_schema(kind), None)) == set()
    assert words_with_names(["spi.as5047p_mode", "register.ichaus", "field.lika_bit", "ssi.clock"]) == {
        "spi.as5047p_mode",
        "register.ichaus",
        "field.lika_bit",
    }
