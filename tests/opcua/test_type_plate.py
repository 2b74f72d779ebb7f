"""Type plates for OPC UA, read by asyncua.

``powertrain.xml`` replaces the nodesets of the OPC Foundation, which are not part of this repository. To read the
plates on the real types, check out the repository OPCFoundation/UA-Nodeset and set ``UA_NODESETS`` to its folder.
"""

from __future__ import annotations

import asyncio
import dataclasses
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from codewheel.model import Device
from codewheel.targets import Library
from codewheel_opcua import generate

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "examples/opcua-target"
POWERTRAIN, DI = "http://opcfoundation.org/UA/Powertrain/", "http://opcfoundation.org/UA/DI/"
#: Nodesets in the order of their dependencies, in the folder ``UA_NODESETS``.
REAL = (
    "DI/Opc.Ua.Di.NodeSet2.xml",
    "Machinery/Opc.Ua.Machinery.NodeSet2.xml",
    "PADIM/Opc.Ua.IRDI.NodeSet2.xml",
    "Powertrain/powertraindictionary.nodeset2.xml",
    "UAFX/opc.ua.fx.data.nodeset2.xml",
    "UAFX/opc.ua.fx.ac.nodeset2.xml",
    "AMB/Opc.Ua.AMB.NodeSet2.xml",
    "Powertrain/Opc.Ua.Powertrain.NodeSet2.xml",
)
SINGLE, MULTI = "ResolutionSingleturnAbsolute", "ResolutionMultiturnAbsolute"
#: Resolutions from the order codes in the manuals (AM36 over BiSS: defaults of registers 56h and 57h, 6.5). Names and
#: numbers from tables 79 and 88 of OPC 40400-1, positions per millimetre as its 7.8.11.2 demands.
EXPECTED: dict[str, tuple[tuple[int, str], dict[str, float], tuple[int, str] | None]] = {
    "AMM5A21/65KSC1": ((1, "ROT_MULTI_TURN"), {SINGLE: 2097152, MULTI: 65536}, (0, "BISS_C")),
    "AMM5A17/1BG1": ((0, "ROT_SINGLE_TURN"), {SINGLE: 131072}, (6, "SSI_BINARY")),
    "AMM5A23/65KJP1": ((1, "ROT_MULTI_TURN"), {SINGLE: 8388608, MULTI: 65536}, None),
    "AM3616/4096-I7": ((1, "ROT_MULTI_TURN"), {SINGLE: 1048576, MULTI: 65536}, (0, "BISS_C")),
    "AMC3619/4096-BG": ((1, "ROT_MULTI_TURN"), {SINGLE: 524288, MULTI: 4096}, (6, "SSI_BINARY")),
    "ASC8522/GG2": ((0, "ROT_SINGLE_TURN"), {SINGLE: 4194304}, (7, "SSI_GRAY_CODE")),
    "SMA21-SC4-0005": ((4, "LINEAR_ABSOLUTE"), {"ResolutionLinearAbsolute": 200}, (0, "BISS_C")),
    "SMA21-G14-0001": ((4, "LINEAR_ABSOLUTE"), {"ResolutionLinearAbsolute": 1000}, (7, "SSI_GRAY_CODE")),
    "SMA21-JP1-0010": ((4, "LINEAR_ABSOLUTE"), {"ResolutionLinearAbsolute": 100}, None),
}


def test_each_order_code_has_a_plate(library: Library) -> None:
    files = generate(library)
    # The meaning of the iC-MU's position depends on its configuration, so it has no plate.
    devices_with_plates = [device for device in library.devices if device.manufacturer.main]
    assert len(files) == sum(len(device.variants) for device in devices_with_plates) + 1 == 130
    assert "opcua/lika-amm5/AMM5A21-65KSC1.xml" in files
    for name, text in files.items():
        if name.endswith(".xml"):
            root = ElementTree.fromstring(text)
            ids = [node.get("NodeId") for node in root if node.get("NodeId")]
            assert len(ids) == len(set(ids)), name


def test_a_number_that_its_type_cannot_hold_is_left_out(amm5: Device) -> None:
    """UInt32 ends below 2^32, so an encoder with 32 bits per revolution has no such attribute."""
    only = tuple(variant for variant in amm5.variants if variant.code == "AMM5A23/65KSC1")
    for bits, has_it in ((31, True), (32, False)):
        variant = dataclasses.replace(only[0], parameters={**only[0].parameters, "singleturn_bits": bits})
        (_, text) = generate(Library((dataclasses.replace(amm5, variants=(variant,)),))).values()
        assert (f">{2**bits}<" in text) == (SINGLE in text) == has_it
        assert ">65536<" in text


@pytest.mark.exhaustive
@pytest.mark.slow
def test_the_installed_target(tmp_path: Path) -> None:
    """The commands of its README, with ``--target`` so that nothing is installed into this environment."""
    shutil.copytree(PACKAGE, tmp_path / "source", ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(tmp_path / "site")]
    subprocess.run([*pip, str(tmp_path / "source")], check=True, timeout=300)
    generate_plates = [sys.executable, "-m", "codewheel", "generate", "specs/lika", "-o", str(tmp_path / "out")]
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
    subprocess.run([*generate_plates, "--target", "opcua"], cwd=ROOT, env=environment, check=True, timeout=300)
    assert ">AMM5A21/65KSC1<" in (tmp_path / "out/opcua/lika-amm5/AMM5A21-65KSC1.xml").read_text(encoding="utf-8")


@pytest.mark.slow
def test_hostile_text_stays_text(hostile: Library) -> None:
    for name, text in generate(hostile).items():
        if name.endswith(".xml"):
            tags = {str(node.tag).partition("}")[2] for node in ElementTree.fromstring(text)}
            assert tags == {"NamespaceUris", "Models", "Aliases", "UAObject", "UAVariable"}


@pytest.mark.slow
def test_a_server_reads_the_plates(library: Library, tmp_path: Path) -> None:
    files = {name.rpartition("/")[2]: text for name, text in generate(library).items()}
    for code in EXPECTED:
        name = f"{code.replace('/', '-')}.xml"
        (tmp_path / name).write_text(files[name], encoding="utf-8")
    plates = asyncio.run(_read(sorted(tmp_path.iterdir())))
    assert plates == {code: ("Lika Electronic", None, *content) for code, content in EXPECTED.items()}


async def _read(plates: list[Path]) -> dict[str, Any]:
    """Return the content of each plate after a server has loaded it, by its product code."""
    from asyncua import Server

    server = Server()
    await server.init()
    folder = os.environ.get("UA_NODESETS")
    if folder:
        for name in REAL:
            # Two of these nodesets have nodes that asyncua rejects in its strict mode.
            await server.import_xml(str(Path(folder, name)), strict_mode=False, auto_load_definitions=False)
    else:
        await server.import_xml(str(Path(__file__).with_name("powertrain.xml")))
    powertrain, di = [await server.get_namespace_index(uri) for uri in (POWERTRAIN, DI)]
    plates_by_code = {}
    for plate in plates:
        nodes = await server.import_xml(str(plate))
        root = server.get_node(nodes[0])
        kind = (await server.get_node(await root.read_type_definition()).read_browse_name()).Name
        of_type = kind.removeprefix("PtAssetEncoder").removesuffix("Type")
        attributes = await root.get_child(f"{powertrain}:PtEncoder{of_type}Attributes")
        # "C62" of UN/CEFACT's recommendation 20, as a number. There is no code for 1/mm.
        unit = (int.from_bytes(b"C62", "big"), "1") if of_type == "Rotary" else (-1, "1/mm")
        resolutions = await _resolutions(attributes, unit)
        interface = [f"{powertrain}:PtEncoderInterface{name}" for name in ("Attributes", "ProtocolAttributes")]
        children = [(await child.read_browse_name()).to_string() for child in await root.get_children()]
        protocol = None
        if interface[0] in children:
            protocol = await _choice(await root.get_child([*interface, f"{powertrain}:EncoderProtocol"]))
        identity = [await root.get_child(f"{di}:{name}") for name in ("Manufacturer", "ProductCode", "SerialNumber")]
        maker, code, serial = [await node.read_value() for node in identity]
        encoder_type = await _choice(await attributes.get_child(f"{powertrain}:EncoderType"))
        plates_by_code[code] = (maker.Text, serial, encoder_type, resolutions, protocol)
    return plates_by_code


async def _resolutions(attributes: Any, unit: tuple[int, str]) -> dict[str, Any]:
    """Return the resolutions of a plate by name, after comparing their units with the expected unit."""
    resolutions = {}
    for child in await attributes.get_children():
        name = (await child.read_browse_name()).Name
        if name.startswith("Resolution"):
            resolutions[name] = await child.read_value()
            unit_read = await (await child.get_child("0:EngineeringUnits")).read_value()
            assert (unit_read.UnitId, unit_read.DisplayName.Text) == unit
    return resolutions


async def _choice(node: Any) -> tuple[int, str]:
    """Return a value of an enumeration and its name, after comparing both with the standard."""
    value = await node.read_value()
    text = (await (await node.get_child("0:ValueAsText")).read_value()).Text
    names = await (await node.get_child("0:EnumValues")).read_value()
    assert {enum_value.Value: enum_value.DisplayName.Text for enum_value in names}[value] == text
    return value, text
