"""The idbiss file uses only publicly known facts about the format, and no text can end its comments."""

from __future__ import annotations

import dataclasses
import re
import shutil
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
from codewheel.dump.plain import device_dump
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.biss.data_channels import ascii_only, ascii_text, comment
from codewheel.targets.biss.files import generate
from codewheel.targets.biss.identity import device_bits
from codewheel.targets.docs.files import generate as generate_docs
from lxml import etree
from xml_reader import from_xml, read_xml

NAME = "biss/idbiss4C69.xml"
PROVEN = {
    "BiSS-Identifier": {"Version"},
    "Profile": set(),
    "Device": set(),
    "Id": {"Range", "type"},
    "Label": {"Pos"},
    "SCDS": set(),
    "CrcPoly": set(),
    "Length": set(),
}


def dtd() -> etree.DTD:
    with (resources.files("codewheel.language") / "idbiss.reconstructed.dtd").open("rb") as file:
        return etree.DTD(file)


def check_format(text: str) -> Any:
    """Return the root of a file, after checking that it has only proven elements, attributes and orders."""
    text.encode("ascii")
    assert text.startswith(
        '<?xml version="1.0" encoding="ISO-8859-1"?>\n<!DOCTYPE BiSS-Identifier SYSTEM "idbiss.dtd">\n'
    )
    root = read_xml(text.encode("ascii"))
    checker = dtd()
    assert checker.validate(root), checker.error_log
    for node in root.iter(etree.Element):
        assert set(node.attrib) <= PROVEN[str(node.tag)]
        if node.tag == "Id":
            high, low = map(int, node.get("Range", "").split(":"))
            assert re.fullmatch(f"0b[01]{{{high - low + 1}}}", node.text or "")
    return root


@pytest.fixture(scope="module")
def files(library: Library) -> dict[str, str]:
    return generate(library)


@pytest.mark.slow
def test_the_files(files: dict[str, str]) -> None:
    assert NAME in files
    assert "biss/lika-amm5.xml" in files
    assert "biss/device-description.xsd" in files
    assert "biss/idbiss.dtd" not in files


def test_amm5_is_known_by_its_ids(amm5: Device) -> None:
    root = check_format(generate(Library((amm5,)))[NAME])
    maker = root.find("Profile/Device")
    assert maker is not None
    assert [(id_node.get("Range"), int(id_node.text or "", 2)) for id_node in maker.findall("Id")] == [("15:0", 0x4C69)]
    amm5 = next(device for device in maker.findall("Device") if "AMM5" in (device.findtext("Label") or ""))
    assert [(id_node.get("Range"), int(id_node.text or "", 2)) for id_node in amm5.findall("Id")] == [
        ("63:32", 0x414D4D35)
    ]
    assert amm5.findtext("SCDS/CrcPoly") == "0x43"
    assert amm5.find(".//Length") is None
    label = amm5.find("Label")
    assert label is not None
    assert label.get("Pos") == "1"
    assert (label.text or "").startswith(", ")


def test_each_id_names_the_identity_that_it_counts(files: dict[str, str]) -> None:
    """Check the comment behind every Id: where each value is read, and the value in hex.

    That is 64 bits of device and manufacturer ID, or 16 bits of profile ID.
    """
    root = check_format(files[NAME])
    for id_node in root.iter("Id"):
        high, _ = map(int, id_node.get("Range", "").split(":"))
        behind = id_node.getnext()
        assert behind is not None
        assert behind.tag is etree.Comment
        value = f"{int(id_node.text or '', 2):X}h"
        of_profile = id_node.getparent().find("Label") is None
        start = "64-bit identity: manufacturer ID" if high == 15 else "64-bit identity: device ID, register"
        if of_profile:
            start = "16-bit profile ID, registers 42h and 43h"
        assert str(behind.text).strip().startswith(start), behind.text
        assert value in str(behind.text), behind.text


def test_each_inferred_place_says_so(files: dict[str, str], amm5: Device) -> None:
    """Sections 1.3 and 1.4 of the public facts.

    They cover the wrapper, the unit of Range, refinement by inner devices, labels, and the unit of Length.
    """
    root = check_format(files[NAME])
    maker = root.find("Profile/Device")
    assert maker is not None

    def comments(parent: Any) -> str:
        return " ".join(" ".join(str(child.text).split()) for child in parent if child.tag is etree.Comment)

    assert "Inferred: Profile is the only publicly known parent of Device" in comments(root)
    for words in (
        "Inferred: Range counts the bits of the 64-bit identity",
        "Inferred: a Device inside a Device refines it",
        "Inferred: Label of a Device names the manufacturer",
    ):
        assert words in comments(maker)
    one_length = tuple(variant for variant in amm5.variants if variant.code in ("AMM5A23/1SC1", "AMM5B23/1SC1"))
    first = (
        next(check_format(generate(Library((dataclasses.replace(amm5, variants=one_length),)))[NAME]).iter("Length"))
        .getparent()
        .getparent()
    )
    assert "Inferred: Length counts all data bits on the line" in comments(first)
    assert "Inferred: the Label next to it" in comments(first)


def device_named(root: Any, name: str) -> Any:
    """Return the Device element whose label contains ``name``."""
    return next(device_node for device_node in root.iter("Device") if name in (device_node.findtext("Label") or ""))


def test_a_length_for_each_profile_id_stands_in_the_comment(files: dict[str, str]) -> None:
    """SMA21, 6.4 p.28: 2814h, 2816h, 2817h and 2818h have 24 bits of position and zeros above it, 2819h has 25."""
    text = files[NAME]
    sma21 = device_named(check_format(text), "SMA21")
    assert [(id_node.get("Range"), int(id_node.text or "", 2)) for id_node in sma21.findall("Id")] == [
        ("63:32", 0x534D3231)
    ]
    assert sma21.findall("Device") == []
    assert list(sma21.iter("Length")) == []
    stated_lengths = re.findall(
        r"profile ID ([0-9A-F]{4})h, registers 42h and 43h \(SMA21[^)]*\): ([0-9]+) bits", " ".join(text.split())
    )
    assert stated_lengths == [("2814", "24"), ("2816", "24"), ("2817", "24"), ("2818", "24"), ("2819", "25")]


@pytest.mark.slow
def test_no_two_ids_on_the_way_down_contradict_each_other(files: dict[str, str], amm5: Device) -> None:
    """The Ids from the outermost Device to an inner one can all match one encoder: they agree on common bits."""
    two_codes = tuple(variant for variant in amm5.variants if variant.code in ("AMM5A23/1SC1", "AMM5B23/1SC1"))
    for outputs in (files, generate(Library((dataclasses.replace(amm5, variants=two_codes),)))):
        for inner in check_format(outputs[NAME]).iter("Device"):
            bits_by_place: dict[int, str] = {}
            parts = (inner, *inner.iterancestors("Device"))
            for id_node in [id_node for part in parts for id_node in part.findall("Id")]:
                high = int(id_node.get("Range", "").partition(":")[0])
                for place, bit in enumerate((id_node.text or "").removeprefix("0b")):
                    assert bits_by_place.setdefault(high - place, bit) == bit, (id_node.get("Range"), id_node.text)


def test_the_label_of_data_has_no_comma(amm5: Device) -> None:
    """In profilebiss.xml, the label of an inner Device begins with a comma (", Sensor"), unlike an SCDS ("Data")."""
    two_codes = tuple(variant for variant in amm5.variants if variant.code in ("AMM5A23/1SC1", "AMM5B23/1SC1"))
    root = check_format(generate(Library((dataclasses.replace(amm5, variants=two_codes),)))[NAME])
    assert [(label.get("Pos"), label.text) for label in root.iterfind(".//SCDS/Label")] == [("1", "position")]
    assert [(label.text or "")[:2] for label in root.iterfind("Profile/Device/Device/Label")] == [", "]


def test_no_length_where_the_identity_does_not_tell_it(files: dict[str, str]) -> None:
    """The length of AM36 depends on registers 56h and 57h. ASC85 prints one profile ID, which fits 25 bits only."""
    text = files[NAME]
    root = check_format(text)
    for name in ("AM36", "ASC85", "AMM5A"):
        assert device_named(root, name).findtext("SCDS/CrcPoly") == "0x43"
        assert list(device_named(root, name).iter("Length")) == []
    plain = " ".join(text.split())
    assert (
        "it depends on the current content of register 56h (singleturn_bits_used.bits) and register 57h "
        "(multiturn_bits_used.bits)"
    ) in plain
    assert "multiturn 16 + singleturn 20 = 36 bits, with status bits 38, with CRC 44" in plain
    # ASC85 with its 0 bit, as printed in 6.2.1, and without it, as read by OnStepX.
    codes = "ASC8525/SC1, ASC8525/SC2"
    assert f"{codes} with as_printed: position 25 + zero 1 = 26 bits, with status bits 28, with CRC 34" in plain
    assert f"{codes} with left_out: position 25 = 25 bits, with status bits 27, with CRC 33" in plain
    assert "one device ID covers 7 data lengths. You choose zero_bit (" in plain
    assert f"281Ah, for all lengths. Its low byte, 26, is the data length of {codes} with as_printed only" in plain
    assert "profile ID, registers 42h and 43h: 0000h, which means no profile" in plain


def test_the_comment_tells_what_the_format_cannot(files: dict[str, str]) -> None:
    text = " ".join(files[NAME].split())
    assert "one device ID covers 6 data lengths" in text
    for code, length in (("AMM5A17/1SC1", 17), ("AMM5A21/65KSC1", 37), ("AMM5B23/65KSC1", 39)):
        assert re.search(rf"{code}[^:]*: [a-z0-9 +]*= {length} bits", text), code
    assert "Not validated against idbiss.dtd" in text
    assert "Inferred" in text


def test_each_file_begins_with_what_must_not_be_done(files: dict[str, str]) -> None:
    """AM36 6.1: the manufacturer supplies a file of the same name, which the master needs."""
    identifiers = {name: text for name, text in files.items() if name.rpartition("/")[2].startswith("idbiss")}
    assert len(identifiers) > 1
    for name, text in identifiers.items():
        first = " ".join(text.partition("<!--")[2].partition("-->")[0].split())
        assert first.startswith("No BiSS master is known to accept this file."), name
        assert "its own idbiss4C69.xml. If you have it, install it in the master, and never replace it" in first, name
    readme = " ".join(files["biss/README.md"].split())
    assert readme.startswith("# BiSS files **No BiSS master is known to accept `idbiss4C69.xml`.")
    assert "never replace it with the file from this folder" in readme


@pytest.mark.slow
def test_one_length_is_stated_below_the_identity(amm5: Device) -> None:
    two_codes = tuple(variant for variant in amm5.variants if variant.code in ("AMM5A23/1SC1", "AMM5B23/1SC1"))
    root = check_format(generate(Library((dataclasses.replace(amm5, variants=two_codes),)))[NAME])
    assert [length.text for length in root.iter("Length")] == ["23"]


#: Data bits as the manuals print them: AMM5 6.1 has 16 bits of multiturn for 65K, SMA21 6.4 p.28 the profile IDs, AM36
#: 6.5 the defaults of registers 56h and 57h, ASC85 6.2.1 p.20 position and 0 bit.
LENGTHS = {
    "lika-amm5/idbiss-AMM5A21-65KSC1.xml": 37,
    "lika-amm5/idbiss-AMM5B17-1SC1.xml": 17,
    "lika-sma21/idbiss-SMA21-SC4-0050.xml": 24,
    "lika-sma21/idbiss-SMA21-SC1-0001.xml": 25,
    "lika-am36/idbiss-AM3619-4096-I7.xml": 36,
    "lika-asc85/idbiss-ASC8525-SC1-as-printed.xml": 26,
    "lika-asc85/idbiss-ASC8525-SC1-left-out.xml": 25,
}


def test_each_order_code_has_a_file_with_its_length(files: dict[str, str], library: Library) -> None:
    roots = {name: check_format(text) for name, text in files.items() if "/idbiss-" in name}
    # There are two files for each of the twelve order codes of ASC85, because its manual leaves the zero bit open.
    # The iC-MU has none, because its spec has no device ID.
    main_devices = [device for device in library.devices if device.manufacturer.main]
    biss_variants = [variant for device in main_devices for variant in device.variants if variant.interface == "biss"]
    assert len(roots) == len(biss_variants) + sum(variant.code.startswith("ASC85") for variant in biss_variants) == 50
    for name, root in roots.items():
        assert len(root.findall(".//Length")) == 1, name
        assert [crc_poly.text for crc_poly in root.iter("CrcPoly")] == ["0x43"], name
        assert "Inferred: Length counts all data bits" in files[name]
        assert "A master cannot distinguish them" in " ".join(files[name].split())
    for name, length in LENGTHS.items():
        assert roots[f"biss/{name}"].findtext(".//Length") == str(length), name


def test_a_file_for_one_encoder_says_what_can_change_its_length(files: dict[str, str]) -> None:
    am36 = " ".join(files["biss/lika-am36/idbiss-AM3616-4096-I7.xml"].split())
    assert "Inferred: Length is that of the factory defaults of register 56h (singleturn_bits_used.bits)" in am36
    asc85 = " ".join(files["biss/lika-asc85/idbiss-ASC8520-SC1-left-out.xml"].split())
    assert "The manual leaves zero_bit open" in asc85
    assert "This file is for left_out: " in asc85
    assert "ASC8520/SC1 with left_out: position 20 = 20 bits, with status bits 22, with CRC 28" in asc85
    assert "ASC8521" not in asc85
    amm5 = " ".join(files["biss/lika-amm5/idbiss-AMM5A21-65KSC1.xml"].split())
    assert "Length is that of the factory defaults" not in amm5


@pytest.mark.slow
def test_a_device_without_a_device_id_is_named_as_left_out(amm5: Device, devices: Mapping[str, Device]) -> None:
    bare = dataclasses.replace(
        amm5, registers=tuple(register for register in amm5.registers if register.name != "device_id")
    )
    text = generate(Library((bare, devices["am36"])))[NAME]
    check_format(text)
    assert device_bits(bare) == ()
    assert f"Not listed, because the spec has no device ID: {bare.title}" in text


def test_a_manufacturer_without_an_id_has_no_file(amm5: Device) -> None:
    nameless = dataclasses.replace(amm5, manufacturer=dataclasses.replace(amm5.manufacturer, biss_id=None))
    expected_names = {"LICENSE", "README.md", "lika-amm5.xml", "device-description.xsd"}
    assert set(generate(Library((nameless,)))) == {f"biss/{name}" for name in expected_names}


@pytest.mark.slow
def test_another_maker(tmp_path: Path) -> None:
    """A small spec of another manufacturer works as well, since no code is specific to one device."""
    shutil.copy(Path(__file__).parents[1] / "check" / "ok" / "minimal.yaml", tmp_path)
    (tmp_path / "manufacturer.yaml").write_text(
        'codewheel: 1\nmanufacturer: acme\ntitle: Acme\nbiss_id: 0x4163\nsource: "1"\n', encoding="utf-8"
    )
    devices, report = load_library([tmp_path])
    assert not report.problems
    files = generate(Library(devices))
    # If a master can identify no encoder, there is no idbiss file.
    expected_names = {"LICENSE", "README.md", "acme-minimal.xml", "device-description.xsd"}
    assert set(files) == {f"biss/{name}" for name in expected_names}
    assert from_xml(files["biss/acme-minimal.xml"].encode()) == device_dump(devices[0])
    assert "docs/minimal.md" in generate_docs(Library(devices))


@pytest.mark.slow
def test_hostile_text_stays_text(hostile: Library) -> None:
    text = generate(hostile)[NAME]
    root = check_format(text)
    assert {str(node.tag) for node in root.iter(etree.Element)} <= set(PROVEN)
    for comment_text in re.findall(r"<!--(.*?)-->", text, re.DOTALL):
        assert "--" not in comment_text
        assert not comment_text.endswith("-")


@pytest.mark.parametrize(
    "text",
    [
        "a\x00b\x1b[31mc",
        "-\x00-\x01->",
        "-\u00ad-",
        "\uff0d\uff0d>",
        "\ufe63\ufe63>",
        "\u2014\u2014>",
        "x\x85y\u2028z",
        "-" * 400,
        "\ud800",
        "--!>",
        "<!--",
    ],
)
def test_no_character_leaves_a_comment_or_an_element(text: str) -> None:
    """Control characters, characters that become hyphens in ASCII, and long runs of hyphens.

    They are placed in both forms of a comment and in an element.
    """
    for comment_text in (str(comment(text, "  ")), str(comment(f"{text}\n{text} {'word ' * 60}{text}", "  "))):
        root = read_xml(f"<a>{comment_text}<b>{ascii_text(text)}</b></a>".encode("ascii"))
        assert [child.tag for child in root] == [etree.Comment, "b"]
        assert len(root[1]) == 0
        assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f]", comment_text)
        assert "--" not in comment_text.strip()[4:-3]


def test_comments_are_ascii() -> None:
    assert ascii_only("±5 % − 20 µs → 3 × 1 Ω é") == "+/-5 % - 20 us to 3 x 1 Ohm e"
    assert str(comment("a----b-", "")) == "<!-- a- - - -b-  -->"
