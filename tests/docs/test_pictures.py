"""The pictures of frames, registers and connectors are readable on a phone, and have the bits computed by hand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from xml.etree import ElementTree

import pytest

SVG = "{http://www.w3.org/2000/svg}"
#: A screen of 375 pixels less margins of 16 on each side.
PHONE = 343

Files = Mapping[str, str]


def drawn(pages: Files) -> Iterator[tuple[str, ElementTree.Element]]:
    for name, content in pages.items():
        if name.endswith(".svg") and "/timing-" not in name:
            yield name, ElementTree.fromstring(content)


def texts(pages: Files, name: str) -> list[str]:
    root = ElementTree.fromstring(pages[f"docs/{name}.svg"])
    return ["".join(element.itertext()) for element in root.iter(f"{SVG}text")]


def desc(pages: Files, name: str) -> str:
    return ElementTree.fromstring(pages[f"docs/{name}.svg"]).findtext(f"{SVG}desc", "")


def test_text_has_11_pixels_on_a_phone(pages: Files) -> None:
    for name, root in drawn(pages):
        # A frame as one line is shown on wide screens only.
        room = 720 if name.endswith("-wide.svg") else PHONE
        scale = min(1.0, room / float(root.attrib["width"]))
        assert all(float(element.attrib["font-size"]) * scale >= 11 for element in root.iter(f"{SVG}text")), name


def test_no_text_leaves_the_card_or_its_box(pages: Files) -> None:
    """A letter is taken as half the font size wide, which is more than the average in the fonts of browsers."""
    for name, root in drawn(pages):
        for element in root.iter(f"{SVG}text"):
            size, x = float(element.attrib["font-size"]), float(element.attrib["x"])
            wide = size * 0.5 * len("".join(element.itertext()))
            x_left = x - {"start": 0.0, "middle": wide / 2, "end": wide}[element.attrib["text-anchor"]]
            assert x_left >= 0, name
            assert x_left + wide <= float(root.attrib["width"]), (name, element.text)


@pytest.mark.slow
def test_a_picture_and_the_words_beside_it_say_the_same(pages: Files) -> None:
    for name, root in drawn(pages):
        words = root.findtext(f"{SVG}desc", "")
        assert words, name
        picture = name.rpartition("/")[2]
        contents = [content for page_name, content in pages.items() if page_name.endswith(".md")]
        assert any(f"{picture})" in content or f'{picture}"' in content for content in contents), name


def test_the_bits_of_a_frame_as_counted_by_hand(pages: Files) -> None:
    """AMM5 6.2 p.32, 21 and 16 bits: position in 44:8, nE in 7, nW in 6, CRC in 5:0."""
    assert desc(pages, "amm5/AMM5A21-65KSC1-single_cycle_data") == (
        "45 bits: multiturn 44:29, singleturn 28:8, error 7 (0 = active), warning 6 (0 = active), crc 5:0"
    )
    words = texts(pages, "amm5/AMM5A21-65KSC1-single_cycle_data")
    assert [word for word in words if word[0].isdigit()] == [
        *("44:40", "44:40", "39:32", "39:32", "31:24", "31:29", "28:24", "23:16", "23:16", "15:8", "15:8"),
        *("7:0", "7", "6", "5:0"),
    ]
    assert "error (bit 7, 0 = active)" in words


def test_the_bytes_of_a_register_as_counted_by_hand(pages: Files) -> None:
    """AMM5 6.4 p.35: the preset ends at bit 48 of 17h to 11h, low byte at 11h. With 21 bits, 12h has its last four."""
    rows = rows_of(pages, "amm5/AMM5A21-65KSC1-register-preset")
    assert rows == {
        "11h": ["0", "7:0"],
        "12h": ["singleturn", "15:12", "0", "11:8"],
        "13h": ["singleturn", "23:16"],
        "14h": ["singleturn", "31:24"],
        "15h": ["multiturn", "39:33", "32"],
        "16h": ["multiturn", "47:40"],
        "17h": ["0", "55:49", "48"],
    }


def test_the_bytes_of_a_reply_in_the_order_of_the_line(pages: Files) -> None:
    """AMM5 7.4 p.44, data ID 3: CF, SF, ABS0 to ABS2, ENID, ABM0 to ABM2, ALMC, CRC; low byte first."""
    rows = rows_of(pages, "amm5/complete_reply")
    assert list(rows) == [f"byte {number}" for number in range(11)]
    assert rows["byte 2"] == ["singleturn", "7:0"]
    assert rows["byte 4"] == ["singleturn", "23:16"]
    assert rows["byte 5"] == ["encoder id"]
    assert rows["byte 9"] == ["alarm field"]


def test_bytes_that_an_encoder_has_no_use_for_are_zeros(pages: Files) -> None:
    """AMM5 7.4 p.43: unused high bits are 0. A singleturn model uses none of ABM0 to ABM2."""
    rows = rows_of(pages, "amm5/AMM5A21-1JP1-complete_reply")
    assert [rows[f"byte {number}"][0] for number in (5, 6, 7, 8, 9)] == ["encoder id", "0", "0", "0", "alarm field"]
    assert "byte 6: always 0 7:0" in desc(pages, "amm5/AMM5A21-1JP1-complete_reply")
    page = pages["docs/amm5/AMM5A21-1JP1.md"]
    frame = page.partition('id="layout-complete_reply"')[2]
    assert "| bytes 6 to 8 | Multiturn padding <small>`multiturn_padding`</small><br>Always zero." in frame


def rows_of(pages: Files, name: str) -> dict[str, list[str]]:
    """Return the texts in the boxes of each row, by the label of the row."""
    root = ElementTree.fromstring(pages[f"docs/{name}.svg"])
    labels = {}
    for element in root.iter(f"{SVG}text"):
        if element.attrib["text-anchor"] == "start" and float(element.attrib["x"]) < 15:
            labels[float(element.attrib["y"])] = element.text or ""
    rows: dict[str, list[str]] = {label: [] for label in labels.values()}
    for element in root.iter(f"{SVG}text"):
        if element.attrib["text-anchor"] == "middle":
            nearest = min(labels, key=lambda y: abs(y - float(element.attrib["y"])))
            rows[labels[nearest]].append(element.text or "")
    return rows


@pytest.mark.parametrize(
    ("picture", "expected"),
    [
        # AMM5 4.1.1 p.20, pins 4 and 13; SMA21 4.1 p.15, the cable T12.
        ("amm5/connector-ssi_biss_connector", ["4", "Clock IN - / MA -", "13", "+5Vdc ±5%"]),
        ("sma21/connector-ssi_biss_cable", ["Pink", "Data OUT - / SLO -", "White_Green", "0Vdc"]),
    ],
)
def test_a_connector_has_its_pins_and_wires(pages: Files, picture: str, expected: list[str]) -> None:
    words = texts(pages, picture)
    assert [word for word in expected if word not in words] == []
    assert [words[words.index(name) + 1] for name in expected[::2]] == expected[1::2]


def test_a_wire_of_two_colours_has_both(pages: Files) -> None:
    root = ElementTree.fromstring(pages["docs/sma21/connector-ssi_biss_cable.svg"])
    first = [element.attrib["fill"] for element in root.iter(f"{SVG}rect") if "fill" in element.attrib][:2]
    assert first == ["#ffffff", "#15803d"], "White_Green stands first in 4.1 p.15"


def test_nobody_takes_the_order_of_pins_for_a_face(pages: Files) -> None:
    assert "Their arrangement on the connector face is not known." in " ".join(
        texts(pages, "am36/connector-m12_connector")
    )
    assert "face" not in " ".join(texts(pages, "am36/connector-m8_type_cable"))


def test_a_frame_as_one_line_has_its_ruler(pages: Files) -> None:
    """AMM5 6.2 p.32, 21 and 16 bits: the numbers of the first and the last bit of each field, from left to right."""
    name = "docs/amm5/AMM5A21-65KSC1-single_cycle_data-wide.svg"
    root = ElementTree.fromstring(pages[name])
    bit_numbers = [element for element in root.iter(f"{SVG}text") if (element.text or "").isdigit()]
    assert [int(element.text or "") for element in bit_numbers] == [44, 29, 28, 8, 7, 6, 5, 0]
    x_positions = [float(element.attrib["x"]) for element in bit_numbers]
    assert x_positions == sorted(x_positions)
    # The first rectangle is the card around all fields.
    _card, *field_boxes = root.iter(f"{SVG}rect")
    box_widths = [float(box.attrib["width"]) for box in field_boxes]
    width_of_one_bit = box_widths[2]
    assert [round(box_width / width_of_one_bit) for box_width in box_widths[:5]] == [16, 21, 1, 1, 6]
    page = pages["docs/amm5/AMM5A21-65KSC1.md"]
    assert '<source media="(max-width: 699px)" srcset="AMM5A21-65KSC1-single_cycle_data.svg">' in page
    assert '<img src="AMM5A21-65KSC1-single_cycle_data-wide.svg" alt="45 bits: multiturn 44:29,' in page
