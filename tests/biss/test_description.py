"""The full description is lossless, follows its own schema, and suffices to decode a frame with only an XML parser."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
from codewheel.dump import xml as xsd
from codewheel.dump.plain import device_dump, variant_dump
from codewheel.dump.xml import to_xml
from codewheel.model import Device
from codewheel.order_codes.labels import find_code
from codewheel.targets import Library
from lxml import etree
from xml_reader import from_xml, read_xml


def schema() -> etree.XMLSchema:
    return etree.XMLSchema(read_xml(xsd.schema_text().encode()))


@pytest.mark.slow
def test_every_device_validates_and_comes_back(devices: Mapping[str, Device]) -> None:
    checker = schema()
    for device in devices.values():
        dump = device_dump(device)
        xml = to_xml(dump)
        checker.assertValid(read_xml(xml.encode()))
        assert from_xml(xml.encode()) == dump


@pytest.mark.slow
def test_addresses_and_ids_are_hexadecimal(devices: Mapping[str, Device]) -> None:
    """Numbers are as in manuals: AMM5's preset at 11h to 17h, Lika's ID 4C69h, SMA21's 2814h. Counts are decimal."""
    roots = {name: read_xml(to_xml(device_dump(device)).encode()) for name, device in devices.items()}
    space = {"d": "urn:codewheel:device-description:1"}
    preset = roots["amm5"].find("d:registers/d:register[@name='preset']", space)
    assert preset is not None
    assert (preset.get("address"), preset.get("last_address"), preset.get("length")) == (
        "0x11",
        "0x17",
        "7",
    )
    assert roots["amm5"].xpath("string(d:manufacturer/@biss_id)", namespaces=space) == "0x4C69"
    assert roots["amm5"].xpath("string(//d:crc[@name='biss_6']/@poly_with_top_bit)", namespaces=space) == "0x43"
    entries = ".//d:order_code[@code='SMA21-SC1-0050']/d:parameters/d:entry"
    parameters = {node.get("name"): node.text for node in roots["sma21"].iterfind(entries, space)}
    assert (parameters["profile_id"], parameters["resolution_um"], parameters["position_bits"]) == (
        "0x2814",
        "50",
        "20",
    )
    for root in roots.values():
        nodes = [node for node in root.iter() if isinstance(node.tag, str) and "memory" not in node.tag]
        addresses = [node.get(name) for node in nodes for name in ("address", "last_address")]
        values = [address for address in addresses if address is not None]
        assert values
        assert all(str(value).startswith("0x") for value in values)
        assert [int(str(value), 16) for value in values] == [int(str(value), 0) for value in values]


CODES = [
    "AMM5A21/65KSC1",
    "AMM5B17/1BG1-X",
    "AMM5A23/65KJP1/S123",
    "SMA21-SC4-0050",
    "AMC3616/4096-GG",
    "AM3619/4096-I7",
    "ASC8525/SC2",
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "code"), list(zip(["amm5", "amm5", "amm5", "sma21", "am36", "am36", "asc85"], CODES, strict=True))
)
def test_an_order_code_comes_back_too(devices: Mapping[str, Device], name: str, code: str) -> None:
    device = devices[name]
    dump = variant_dump(device, find_code(device, code))
    xml = to_xml(dump)
    schema().assertValid(read_xml(xml.encode()))
    assert from_xml(xml.encode()) == dump


@pytest.mark.slow
def test_hostile_text_stays_text(hostile: Library) -> None:
    for device in hostile.devices:
        dump = device_dump(device)
        xml = to_xml(dump).encode()
        assert from_xml(xml) == dump
        assert b"<script" not in xml


@pytest.mark.slow
@pytest.mark.parametrize("text", ["line\nline", "tab\there", "return\rhere", " spaces around ", "\U0001f600", "\xa0"])
def test_spaces_and_line_ends_survive(amm5: Device, text: str) -> None:
    dump = device_dump(amm5)
    dump["title"] = text
    dump["characteristics"][0]["value"] = text
    rebuilt = from_xml(to_xml(dump).encode())
    assert (rebuilt["title"], rebuilt["characteristics"][0]["value"]) == (text, text)


@pytest.mark.slow
def test_characters_that_xml_forbids_are_replaced(amm5: Device) -> None:
    dump = device_dump(amm5)
    dump["title"] = "a\x00b\x1fc\ufffed"
    assert from_xml(to_xml(dump).encode())["title"] == "a\ufffdb\ufffdc\ufffdd"
