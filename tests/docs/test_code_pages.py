"""Each order code has a page, which is found by the code, and whose numbers match the manual."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import pytest
from codewheel.commands.outputs import targets_named
from codewheel.loading.library import load_library, load_valid
from codewheel.model import Device
from codewheel.model.expressions import Expression
from codewheel.order_codes.quantities import with_quantities
from codewheel.targets import Library
from codewheel.targets.docs.order_code_page import RESERVED_NAMES
from codewheel.targets.docs.order_code_tables import code_patterns
from codewheel.targets.docs.verdict_table import frame_facts
from codewheel.targets.registry import names_of_codes

Files = Mapping[str, str]

ENCODERS = Path(__file__).parents[2] / "specs"

#: A sum or product without its numeric value: ``singleturn_bits + 7``.
_OPEN = re.compile(r"(?:_bits|_bytes|per_turn|revolutions)\b.*[-+*^]|2\^")


def page_of(files: Files, code: str) -> str:
    """Return the page to which the index links from an order code."""
    links = re.findall(rf"\[`{re.escape(code)}`\]\(([^)]+)\)", files["docs/README.md"])
    assert len(set(links)) == 1, code
    return files[f"docs/{links[0]}"]


def order_code_pages(files: Files) -> Files:
    """Return the pages of order codes: those whose names have capital letters."""
    return {name: page for name, page in files.items() if re.fullmatch(r"docs/[^/]+/.*[A-Z].*\.md", name)}


@pytest.mark.slow
def test_the_index_leads_from_every_order_code_to_a_page_that_names_it(library: Library, pages: Files) -> None:
    for device in library.devices:
        for variant in device.variants:
            head = page_of(pages, variant.code).partition("## Frames")[0]
            assert variant.code in head
            assert device.interface(variant.interface).title in head


def test_parity_bits_are_named_in_place_of_a_crc() -> None:
    """AMT21 has two check bits: odd parity of the odd and of the even bits of the position."""
    (device,), _ = load_library([ENCODERS / "cui" / "amt21.yaml"])
    (layout,) = [layout for layout in device.interfaces[0].layouts if layout.name == "position_reply"]
    facts = list(frame_facts(device, layout, device.variants[0]))
    assert facts[0] == ("CRC", "none")
    assert [text for label, text in facts if label == "Parity"] == [
        "`k0` (byte 1, bit 6). Odd parity of the even bits of `position`",
        "`k1` (byte 1, bit 7). Odd parity of the odd bits of `position`",
    ]


@pytest.mark.parametrize(
    ("spec", "covered"),
    [
        ("infineon/tle5012b", "8 bits, over bits 47:16, `read` to `position`"),
        ("magntek/mt6835", "8 bits, over bits 31:8, `position` to `overspeed`"),
    ],
)
def test_a_crc_states_the_bits_that_it_covers(spec: str, covered: str) -> None:
    (device,), _ = load_library([ENCODERS / f"{spec}.yaml"])
    (variant,) = device.variants
    (layout,) = [layout for layout in device.interfaces[0].layouts if layout.name == "angle"]
    facts = dict(frame_facts(device, layout, variant))
    assert facts["CRC"].endswith(covered)


def test_there_is_no_page_beside_them(library: Library, pages: Files) -> None:
    linked = set(re.findall(r"\[`[^]]*\]\(([^)]+/[^)]+\.md)\)", pages["docs/README.md"]))
    assert linked == {name.removeprefix("docs/") for name in order_code_pages(pages)}


def test_numbers_stand_in_place_of_quantities(pages: Files) -> None:
    for name, page in order_code_pages(pages).items():
        before, _, after = page.partition('<a id="quantities"></a>')
        besides = before + after.partition("</details>")[2]
        spans = [span for line in besides.splitlines() for span in line.split("`")[1::2]]
        assert [span for span in spans if _OPEN.search(span)] == [], name


@pytest.mark.parametrize(
    ("code", "rows"),
    [
        # AMM5 6.2.1 p.32 and 6.4: the position of 37 bits above nE, nW and 6 bits of CRC; its preset from bit 12 on.
        (
            "AMM5A21/65KSC1",
            ["| bits 44:29 | Multiturn <small>`multiturn`", "| bit 7 | Error, nE <small>`error`</small>"],
        ),
        ("AMM5A21/65KSC1", ["| bits 48:33 | Multiturn <small>`multiturn`", "| bits 32:12 | Singleturn <small>"]),
        ("AMM5B17/1SC1", ["| bits 24:8 | Singleturn <small>`singleturn`", "| bits 32:16 | Singleturn <small>"]),
        # AM36 5.2: 16 + 12 bits, 19 + 12 bits; 5.3: 100 kHz to 3 MHz.
        ("AM3616/4096-BG", ["| bits 15:0 | Singleturn <small>`singleturn`", "- Clock: 100 kHz to 3 MHz (§5.3)."]),
        ("AMC3619/4096-GG", ["| bits 30:19 | Multiturn <small>`multiturn`", "`position` is in Gray code."]),
        # SMA21 6.2 p.25: 24 bits for the position at 50 µm, 20 of them used; 25 at 1 µm. 4.1 p.15: the supply.
        (
            "SMA21-SC4-0050",
            ["| bits 31:28 | Padding <small>`padding`", "5 V to 30 V (§4.1 p.15, §4.2 p.16) with `SMA21-SC4-"],
        ),
    ],
)
def test_the_numbers_are_those_of_the_manual(pages: Files, code: str, rows: list[str]) -> None:
    page = page_of(pages, code)
    assert [row for row in rows if row not in page] == []


@pytest.mark.slow
def test_requests_say_what_they_do() -> None:
    """Requests for something other than a position or register show the first sentence of their note."""
    (devices, _), (docs,) = load_library([ENCODERS / "cui"]), targets_named(["docs"])
    files = docs.files(Library(devices), {})
    turns, zero, reset = "Asks for the number of revolutions", "Sets the zero position", "Restarts the encoder"
    page = page_of(files, "AMT212A")
    assert [line.split("|")[-2].strip() for line in page.splitlines() if "_request`](" in line][:4] == [
        "Requests the position",
        turns,
        zero,
        reset,
    ]
    page = page_of(files, "AMT22-14")
    assert f"[`position`](#layout-position) | {zero} |" in page
    assert "[`position_and_turns`](#layout-position_and_turns) | Requests the position, in words of 32 bits |" in page


def test_a_field_without_bits_has_no_row(pages: Files) -> None:
    assert "`multiturn`" not in page_of(pages, "AMM5A17/1SC1").partition("## Errata")[0].partition("## Frames")[2]
    assert "`zero_below_multiturn`" not in page_of(pages, "AMM5A21/65KSC1")


def test_a_width_is_that_of_the_order_code(pages: Files) -> None:
    """AMM5 5.2 and 6.2.1: the position has 17 to 39 bits. That of AMM5A21/65K has 37."""
    biss, ssi = (page_of(pages, f"AMM5A21/65K{kind}").partition("## Errata")[0] for kind in ("SC1", "BG1"))
    assert "The position has 37 bits, most significant" in biss
    assert "The word has as many bits as the position, 37, and starts" in ssi
    assert "| 37 bits | Width of the whole position, including revolutions. The manual calls it" in biss
    for page in order_code_pages(pages).values():
        assert not re.search(r"\b(?:17 to 39|20 to 25)\b", page.partition('<a id="errata">')[0])
    assert "The position has 17 to 39 bits" in pages["docs/amm5/biss.md"]


def test_contacts_are_listed_by_the_name_of_their_connector(pages: Files) -> None:
    """ASC85 4: M12 and M23. SMA21 4.1: M12 with 8 or 12 pins."""
    assert "| M12 | M23 | Wire | Signal |" in page_of(pages, "ASC8525/SC1")
    assert "| Pin | Wire | Signal |" in page_of(pages, "SMA21-JP1-0050")
    assert "| 7, 8 (8 pins), 7 to 12 (12 pins) |" in page_of(pages, "SMA21-JP1-0050")


def test_the_frame_links_to_the_question_that_it_depends_on(pages: Files) -> None:
    frame = page_of(pages, "ASC8525/SC1").partition("## Frame")[2].partition("## What to send")[0]
    assert "an [open question](#alternative-zero_bit) with the answers `as_printed` and `left_out`." in frame
    assert "open question" not in page_of(pages, "ASC8525/BG1").partition("## Frame")[2].partition("- CRC")[0]


def test_the_first_paragraph_states_the_evidence(pages: Files) -> None:
    head = page_of(pages, "AMM5A21/65KSC1").partition("## Wiring")[0]
    assert "Evidence: manual (all pages of the manufacturer's document were read)." in head


def test_the_procedures_are_counted(pages: Files) -> None:
    assert "<summary><b>Procedures</b>: 4 procedures, step by step</summary>" in page_of(pages, "AMM5A21/65KSC1")


@pytest.mark.parametrize(
    ("codes", "names"),
    [
        (["A/B", "A-B", "A B"], ["A-B", "A-B-2", "A-B-3"]),
        (["ab1", "AB1", "aB1"], ["ab1", "AB1-2", "aB1-3"]),
        (["A-2", "A/2", "A-2-2"], ["A-2", "A-2-2", "A-2-2-2"]),
        (["Timing", "register"], ["Timing-2", "register-2"]),
    ],
)
def test_no_two_pages_have_one_name(codes: list[str], names: list[str]) -> None:
    assert names_of_codes(codes, RESERVED_NAMES) == names


def test_the_name_of_a_page_is_not_too_long() -> None:
    names = names_of_codes(["X" * 300, "X" * 301, "Y"])
    assert names == ["X" * 80, "X" * 78 + "-2", "Y"]


def test_many_order_codes_stand_as_patterns_and_nothing_else_fits_them(library: Library) -> None:
    for device in library.devices:
        for part in device.interfaces:
            listed = [variant.code for variant in device.variants if variant.interface == part.name]
            spelled_codes = [spelled for pattern in code_patterns(device, listed[1:]) for spelled in expanded(pattern)]
            assert sorted(spelled_codes) == sorted(listed[1:])


def expanded(pattern: str) -> list[str]:
    """Return the order codes of a pattern such as `A-x/y` with x = 1 or 2, y = B or C."""
    _, label, listed_texts = pattern.split("`")
    order_codes = [label]
    for letter, texts in re.findall(r"([xyzuvw]) = (.*?)(?=, [xyzuvw] = |$)", listed_texts):
        choices = re.split(", | or ", texts)
        order_codes = [order_code.replace(letter, text) for order_code in order_codes for text in choices]
    return order_codes


def test_no_page_has_braces_of_a_shell(pages: Files) -> None:
    braces = re.compile(r"(?<!\])\{[A-Za-z0-9-]+(,[A-Za-z0-9-]+)+\}")
    assert [name for name, page in pages.items() if name.endswith(".md") and braces.search(page)] == []


def test_patterns_as_the_manuals_have_their_order_codes(pages: Files) -> None:
    """AMM5 p.7 and 5 p.27; SMA21 cover: outputs, 5 V or 5 to 30 V, and five resolutions."""
    assert "| `AMM5xy/zBG1` with x = A or B, y = 17, 21 or 23, z = 1 or 65K |" in pages["docs/amm5.md"]
    assert "[`AMM5A21/65KSC1`, `AMM5B21/65KSC1`](amm5/AMM5A21-65KSC1.md)" in pages["docs/README.md"]
    sma21 = "`SMA21-xy-z` with x = GG or G1, y = 1 or 4, z = 0050, 0010, 0005, 0002 or 0001"
    assert sma21 in pages["docs/sma21-ssi-masters.md"]


def device(name: str) -> Device:
    return next(family for family in load_valid()[0] if family.name == name)


@pytest.mark.slow
def test_what_an_order_code_does_not_decide_stays_open() -> None:
    """AMM5 7.3: the user must decide the position of the address in an EEPROM request."""
    amm5 = device("amm5")
    narrowed = with_quantities(amm5, amm5.variant("AMM5A21/65KJP1"))
    request = narrowed.layout("eeprom_read_request")
    assert {name for field in request.fields for name in field.low.parameters} != set()
    assert narrowed.layout("multiturn_reply").fields[0].low.is_constant


def test_the_device_itself_is_as_it_was() -> None:
    amm5 = device("amm5")
    before = amm5.layout("single_cycle_data").bits
    with_quantities(amm5, amm5.variant("AMM5A21/65KSC1"))
    assert amm5.layout("single_cycle_data").bits is before
    assert not before.is_constant
    assert with_quantities(amm5, amm5.variant("AMM5A21/65KSC1")).layout("single_cycle_data").bits == Expression(45)


def test_errata_and_code_of_an_interface_are_on_its_pages(pages: Files) -> None:
    """SSI and RS-485 of the AMM5 came with edition 1.6. The AM36 sends Gray code or binary, by order code."""
    for name in ("ssi", "AMM5A17-1BG1", "rs485", "AMM5A17-1JP1"):
        assert "#erratum-edition_before_1_6_2)" in pages[f"docs/amm5/{name}.md"]
    assert "edition_before_1_6_2" not in pages["docs/amm5/biss.md"].partition("## Frames")[0]
    for code, output in (("BG", "binary"), ("GG", "Gray")):
        assert f"- Code: {output} <small>" in pages[f"docs/am36/AM3616-4096-{code}.md"]
