"""A description of each order code has numbers instead of sums, under the same schema."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from codewheel.dump import xml
from codewheel.dump.plain import variant_dump
from codewheel.order_codes.labels import find_code
from codewheel.targets import Library
from codewheel.targets.biss.files import generate
from codewheel.targets.registry import names_of_codes
from lxml import etree
from xml_reader import from_xml, read_xml

# Generates the XML of every order code.
pytestmark = pytest.mark.slow

SPACE = {"d": "urn:codewheel:device-description:1"}
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def files(library: Library) -> Mapping[str, str]:
    return generate(library, {"order-codes": "each"})


def test_each_listed_code_has_a_file_and_no_other(library: Library, files: Mapping[str, str]) -> None:
    families = generate(library, {"order-codes": "none"})
    assert families == generate(library)
    assert {name: content for name, content in files.items() if name in families} == families
    codes = [variant.code for device in library.devices for variant in device.variants]
    assert len(files) - len(families) == len(codes)
    assert {"biss/lika-amm5/AMM5A21-65KSC1.xml", "biss/lika-sma21/SMA21-BG1-0050.xml"} <= set(files)


def test_each_is_what_show_prints(library: Library, files: Mapping[str, str]) -> None:
    checker = etree.XMLSchema(read_xml(xml.schema_text().encode()))
    for device in library.devices:
        for variant in device.variants[::5]:
            content = files[f"biss/{device.manufacturer.name}-{device.name}/{variant.code.replace('/', '-')}.xml"]
            checker.assertValid(read_xml(content.encode()))
            assert from_xml(content.encode()) == variant_dump(device, find_code(device, variant.code))


def test_places_are_numbers(files: Mapping[str, str]) -> None:
    """AMM5 6.2 p.32, 21 and 16 bits: nE is bit 7, so the position begins at bit 8."""
    root = read_xml(files["biss/lika-amm5/AMM5A21-65KSC1.xml"].encode())
    fields = root.iterfind(".//d:layout[@name='single_cycle_data']/d:fields/d:field", SPACE)
    assert [(field.get("name"), field.get("high"), field.get("low")) for field in fields] == [
        ("multiturn", "44", "29"),
        ("singleturn", "28", "8"),
        ("error", "7", "7"),
        ("warning", "6", "6"),
        ("crc", "5", "0"),
    ]
    for name, content in files.items():
        if name.count("/") > 1:
            fields = read_xml(content.encode()).iter(f"{{{SPACE['d']}}}field")
            places = [place for field in fields for place in (field.get("high"), field.get("low"))]
            assert all(place is None or place.isdecimal() for place in places), name


def test_a_word_that_does_not_mislead(files: Mapping[str, str]) -> None:
    """AMM5 6.4 p.35: a preset that is not saved is lost at power-off."""
    root = read_xml(files["biss/lika-amm5.xml"].encode())
    preset = root.find("d:registers/d:register[@name='preset']", SPACE)
    assert preset is not None
    assert preset.get("lost_unless_saved") == "true"
    assert preset.get("volatile") is None


def test_names_of_files() -> None:
    long = "A" * 200
    assert names_of_codes(["A/1", "a-1", "A 1", "...", long, long + "B"]) == [
        *("A-1", "a-1-2", "A-1-3", "-2", "A" * 80, "A" * 78 + "-2")
    ]


def test_the_counts_of_the_page_on_exports(library: Library) -> None:
    registers = [(device.name, register) for device in library.devices for register in device.registers]
    odd = [register for _, register in registers if register.length not in (1, 2, 4, 8)]
    assert f"({len(odd)} of the {len(registers)} in our families)" in (ROOT / "docs/master/biss-xml.md").read_text(
        encoding="utf-8"
    )
    written = {(device, register.name) for device, register in registers if register.writable and register.length > 1}
    assert written == {
        ("am36", "information_per_revolution"),
        ("am36", "number_of_revolutions"),
        ("am36", "preset"),
        ("amm5", "preset"),
        ("sma21", "preset_offset"),
    }
