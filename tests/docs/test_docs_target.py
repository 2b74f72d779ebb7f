"""The pages: every part of the model is named with its source, links are valid, and text from specs stays text."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import Any
from xml.etree import ElementTree

import pytest
from codewheel.dump.plain import device_dump
from codewheel.loading.library import load_library
from codewheel.model import Biss, Device, Rs485
from codewheel.say.names_and_evidence import heading
from codewheel.say.text import citation, code_span, escape
from codewheel.targets import Library
from codewheel.targets.docs.files import generate
from xml_reader import read_xml

LINK = re.compile(r"(?<!\\)\]\(([^)\s]+)\)")
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+)\)|(?:src|srcset)=\"([^\"]+)\"")
CODE = re.compile(r"(?<!`)(`+)(?!`)(.*?)(?<!`)\1(?!`)")


Files = Mapping[str, str]


@pytest.fixture
def files(pages: Files) -> Files:
    return pages


@pytest.fixture(scope="module")
def hostile_files(hostile: Library) -> Files:
    return generate(hostile)


def family_pages_text(files: Files, name: str) -> str:
    """Return the pages of a family, except those of order codes, as one text."""
    family_pages = [page for path, page in files.items() if re.fullmatch(rf"docs/{name}(/[a-z0-9-]+)?\.md", path)]
    return "\n".join(family_pages)


def broken_links(files: Files) -> list[str]:
    """Return broken links and pictures as ``page: link``."""
    anchors = {name: set(re.findall(r'<a id="([^"]+)"></a>', page)) for name, page in files.items()}
    broken = []
    for name, page in files.items():
        for target in LINK.findall(CODE.sub("", page)) if name.endswith(".md") else ():
            path, _, fragment = target.partition("#")
            full = posixpath.normpath(PurePosixPath(name).parent / path) if path else name
            if full not in files or (fragment and fragment not in anchors[full]):
                broken.append(f"{name}: {target}")
    return broken


@pytest.mark.slow
def test_the_files(files: Files) -> None:
    assert {
        "docs/README.md",
        "docs/amm5.md",
        "docs/amm5/ssi_word.svg",
        "docs/amm5/single_cycle_data.svg",
        "docs/amm5/register-preset.svg",
    } <= set(files)
    assert broken_links(files) == []
    pictures = {name for name in files if name.endswith(".svg")}
    shown_pictures = set()
    for name, page in files.items():
        if name.endswith(".md"):
            targets = [match[1] or match[2] for match in PICTURE.finditer(page)]
            shown_pictures |= {posixpath.normpath(PurePosixPath(name).parent / target) for target in targets}
    assert pictures == shown_pictures


def test_anchors_are_unique(files: Files) -> None:
    for name, page in files.items():
        anchors = re.findall(r'<a id="([^"]+)"></a>', page)
        assert len(anchors) == len(set(anchors)), name


def unlinked(page: str) -> str:
    """Return a page in one line, with the errata in its sentences as the spec names them."""
    return re.sub(r"(errat(?:um|a) )\[[^\]]+\]\([^)]+#erratum-(\w+)\)", r"\1\2", " ".join(page.split()))


def test_everything_is_named(library: Library, files: Files) -> None:
    for device in library.devices:
        page = family_pages_text(files, device.name)
        errata_names = {erratum.name for erratum in device.errata}
        named = [name for name in names(device) if name not in errata_names]
        missing = [name for name in named if f"`{name}`" not in page and f"### {heading(name)}\n" not in page]
        assert missing == []
        missing_sources = [source for source in sources(device) if source not in page]
        assert missing_sources == []
        whole = unlinked(page)
        missing_texts = [value for value in texts(device) if " ".join(escape(value).split()) not in whole]
        assert missing_texts == []


#: Members of the plain data that are our own words, such as kinds, keys and paths, which the page replaces by other
#: words or code.
WORDS = {
    "family",
    "kind",
    "interface",
    "interfaces",
    "access",
    "byte_order",
    "carried_as",
    "other_bits",
    "rule",
    "topology",
    "parity",
    "flow_control",
    "alignment",
    "output_code",
    "active",
    "do",
    "request",
    "bytes",
    "default_bytes",
    "bits",
    "status",
    "severity",
    "refused",
    "above_max",
    "reserved",
    "movement",
    "language",
    "document",
    "section",
    "python_package",
    "version",
    "polynomial",
    "from",
    "purpose",
    "url",
    "equals_text",
    "low",
    "high",
    "width",
    "address",
    "parts",
    "equals",
    "min",
    "max",
    "counts_per_turn",
    "turns",
    "step_um",
    "steps",
    "clear_values",
    "sets",
    "data",
    "values",
    "biss_id",
    "order_code",
    "code",
    "affects",
    "makes_position",
}


def leaves(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from leaves(inner, key if key == "names" else name)
    elif isinstance(value, list):
        for inner in value:
            yield from leaves(inner, key)
    elif isinstance(value, str) and value:
        yield key, value


def test_what_a_flag_makes_of_the_position(files: Files) -> None:
    page = files["docs/sma21/rs485-fields.md"]
    (alarm,) = [line for line in page.splitlines() if line.startswith("| `status_alarm`")]
    assert (
        "<br>This flag combines `temperature_alarm` and `signal_strength_alarm`.<br>While it is active, the position "
        "is usable with a warning. |"
    ) in alarm
    (speed,) = [line for line in page.splitlines() if line.startswith("| `overspeed`")]
    assert "<br>While it is active, the position is not usable. |" in speed
    (missing,) = [line for line in page.splitlines() if line.startswith("| `temperature_alarm`<br>")]
    assert "While it is active" not in missing


@pytest.mark.slow
def test_every_text_of_the_plain_data_is_on_the_page(library: Library, files: Files) -> None:
    """Names in every language, meanings, notes, signals, table cells: everything that show --json prints is there."""
    for device in library.devices:
        page = unlinked(family_pages_text(files, device.name))
        expected = [(key, value) for key, value in leaves(device_dump(device)) if key not in WORDS]
        missing = {(key, value) for key, value in expected if not is_on_page(value, page)}
        of_editions = [erratum for erratum in device.errata if erratum.edition]
        missing -= {("printed", erratum.printed) for erratum in of_editions}
        missing -= {("used", erratum.used) for erratum in of_editions}
        missing.discard(("name", device.manufacturer.name))  # The page has its title.
        # The text of a characteristic gives its quantities in its own words.
        quantities = [value for characteristic in device.characteristics for value in characteristic.values]
        missing -= {(key, getattr(value, key)) for value in quantities for key in ("quantity", "where", "unit")}
        padding = [field for _, layout in device.layouts() for field in layout.fields if field.padding_of]
        missing -= {("name", field.name) for field in padding}
        missing -= {("meaning", field.meaning) for field in padding}
        assert missing == set()


def is_on_page(value: str, page: str) -> bool:
    written = (" ".join(escape(value).split()), code_span(value), f"{value}", value.replace("_", " "))
    return any(form in page for form in written)


def test_every_erratum_is_named_where_it_matters(library: Library, files: Files) -> None:
    for device in library.devices:
        other_files = {name: page for name, page in files.items() if name != f"docs/{device.name}/errata.md"}
        family_text = family_pages_text(other_files, device.name)
        affecting = [erratum.name for erratum in device.errata if erratum.affects]
        assert [name for name in affecting if f"errata.md#erratum-{name})" not in family_text] == []


def names(device: Device) -> list[str]:
    frames = [layout for _, layout in device.layouts()]
    layouts = [*frames, *(register.layout for register in device.registers)]
    fields = [field for layout in layouts for field in layout.fields if not field.padding_of]
    register_names = {register.name for register in device.registers}
    all_names = [field.name for field in fields if not field.name or field.name not in register_names]
    all_names += [layout.name for layout in frames]
    for field in fields:
        all_names += [value.name for value in field.values]
        all_names += [run.name for run in field.runs]
    for layout in layouts:
        all_names += [join.name for join in layout.joins]
    groups: tuple[tuple[Any, ...], ...] = (
        device.registers,
        device.crcs,
        device.procedures,
        device.examples,
        device.errata,
        device.characteristics,
        device.timings,
        device.parameters,
        device.field_groups,
    )
    for group in groups:
        all_names += [member.name for member in group]
    for interface in device.interfaces:
        all_names += [timing.name for timing in interface.timings]
        if isinstance(interface, Rs485):
            all_names += [data_id.name for data_id in interface.data_ids]
        if isinstance(interface, Biss):
            all_names += [control_field.name for control_field in interface.control_data]
    all_names += [variant.code for variant in device.variants]
    return all_names + [document.key for document in device.documents]


def sources(device: Device) -> list[str]:
    groups: tuple[tuple[Any, ...], ...] = (
        device.registers,
        device.crcs,
        device.procedures,
        device.examples,
        device.errata,
        device.characteristics,
        device.alarms,
        device.connectors,
        device.leds,
        device.lost_figures,
    )
    return [citation(member.source) for group in groups for member in group]


def texts(device: Device) -> list[str]:
    all_texts = [erratum.why for erratum in device.errata]
    for erratum in device.errata:
        # Changes of another edition are described in words, which have tests of their own.
        if not erratum.edition:
            all_texts += [erratum.printed, erratum.used]
    all_texts += [figure.content for figure in device.lost_figures]
    all_texts += [characteristic.value for characteristic in device.characteristics]
    groups: tuple[tuple[Any, ...], ...] = (
        device.registers,
        device.crcs,
        device.procedures,
        device.examples,
        device.interfaces,
    )
    for group in groups:
        all_texts += [member.note for member in group]
    for connector in device.connectors:
        all_texts += [contact.signal for contact in connector.contacts]
    for led in device.leds:
        all_texts += [state.meaning for state in led.states]
    return all_texts + [release.changes for release in device.manual.history]


@pytest.mark.slow
def test_tables_are_whole(files: Files, hostile_files: Files) -> None:
    """Every row of a table has as many cells as its head."""
    for page in [*files.values(), *hostile_files.values()]:
        head = 0
        for line in page.splitlines():
            cells = len(re.findall(r"(?<!\\)\|", line)) if line.startswith("| ") else 0
            assert head in (0, cells) or cells == 0, line
            head = cells


SVG_TAGS = {"svg", "title", "desc", "style", "rect", "text", "path"}
PAGE_TAGS = {
    *("a", "/a", "b", "/b", "br", "code", "/code", "h3", "/h3", "img", "picture", "/picture", "small", "/small"),
    *("source", "span", "/span", "sub", "/sub", "details", "/details", "summary", "/summary", "!--"),
}


@pytest.mark.slow
def test_hostile_text_stays_text(hostile_files: Files) -> None:
    assert broken_links(hostile_files) == []
    for name, page in hostile_files.items():
        if not name.endswith(".svg"):
            outside_code = CODE.sub("", page)
            assert "<script" not in outside_code
            tags = set(re.findall(r"<(/?[a-zA-Z!][^\s>]*)", outside_code))
            assert {tag for tag in tags if not tag.startswith("http")} <= PAGE_TAGS


@pytest.mark.slow
def test_hostile_text_stays_text_in_pictures(hostile_files: Files) -> None:
    styles = set[str | None]()
    for name, picture in hostile_files.items():
        if name.endswith(".svg"):
            root = read_xml(picture.encode())
            assert {str(element.tag).rpartition("}")[2] for element in root.iter()} <= SVG_TAGS
            styles.update(element.text for element in root.iter("{http://www.w3.org/2000/svg}style"))
    assert len(styles) == 1, "a style is ours, whatever a spec says"


def test_pictures_are_well_formed_and_nothing_leaves_the_card(files: Files) -> None:
    for name, page in files.items():
        if not name.endswith(".svg"):
            continue
        root = ElementTree.fromstring(page)
        width, height = float(root.attrib["width"]), float(root.attrib["height"])
        for box in root.iter("{http://www.w3.org/2000/svg}rect"):
            x, top, across, down = (float(box.attrib[key]) for key in ("x", "y", "width", "height"))
            assert x >= 0, name
            assert x + across <= width, name
            assert top >= 0, name
            assert top + down <= height, name
        for words in root.iter("{http://www.w3.org/2000/svg}text"):
            assert 0 < float(words.attrib["x"]) < width, name
            assert 0 < float(words.attrib["y"]) < height, name


def test_places_as_worked_out_by_hand(files: Files) -> None:
    page = family_pages_text(files, "amm5")
    assert "| `AMM5A21/65KSC1`, `AMM5B21/65KSC1` | 45 | 44:29 | 28:8 |" in page
    assert "| `AMM5A17/1SC1`, `AMM5B17/1SC1` | – | 48:33 | 32:16 | 15:0 |" in page
    assert f"| with its top bit | {code_span('0x43')} = 67 = {code_span('1000011b')} |" in page
    assert "| without its trailing 1 (Koopman notation) | `0x21` |" in page
    # If the manual leaves it open, each place has its answer.
    assert "| bits 7:1 (`as_printed`)<br>bits 6:0 (`as_t_format`) |" in page
    assert "| bit 0 (`as_printed`)<br>bit 7 (`as_t_format`) |" in page


def test_a_printed_time_out_stands_there_once(files: Files) -> None:
    """ASC85 6.5 p.32: 0.35 µs at 10 MHz, without a rule. AMM5 6.5 p.40: 1.5 clock periods, computed for three."""
    assert "| Timeout | varies with the clock, 350 ns at 10 MHz |" in files["docs/asc85/biss.md"]
    assert "1.5 clock periods (30 µs at 50 kHz, 7.5 µs at 200 kHz, 150 ns at 10 MHz)" in files["docs/amm5/biss.md"]


def test_labels_of_another_edition_are_on_the_page(files: Files) -> None:
    page = files["docs/am36.md"]
    assert "These other spellings on labels are also accepted" in page
    assert "`{model}{singleturn}/{turns}{output}`" in page
    assert "`SC` is `I7`; `[0-9]?` may follow" in page.replace("<br>", "; ")
    assert "These other spellings on labels are also accepted" not in files["docs/amm5.md"]


def test_files_end_with_a_line_and_have_no_gaps(files: Files) -> None:
    assert all(page.endswith("\n") and "\n\n\n" not in page for page in files.values())


def page_of(tmp_path: Path, *changes: tuple[str, str]) -> str:
    """Return the page of the smallest valid spec with these changes."""
    spec = (Path(__file__).parents[1] / "check" / "ok" / "minimal.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in spec
        spec = spec.replace(old, new)
    (tmp_path / "minimal.yaml").write_text(spec, encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text(
        'codewheel: 1\nmanufacturer: acme\ntitle: Acme\nsource: "1"\n', encoding="utf-8"
    )
    devices, report = load_library([tmp_path])
    assert not report.problems, report.problems[0].format()
    return family_pages_text(generate(Library(devices)), "minimal")


def test_no_table_is_empty(files: Files, tmp_path: Path) -> None:
    """Order codes without parameters, whose width is in a register, have no table of derived values."""
    register_page = page_of(
        tmp_path,
        ("{meaning: Bits of the position}", "{meaning: Bits of the position, read_from: width.bits, min: 1, max: 20}"),
        ("12: {sets: {position_bits: 12}}", "12: {}"),
        ('"16": {sets: {position_bits: 16}}', '"16": {}'),
        (
            "registers:\n",
            (
                "registers:\n"
                "  - {name: width, address: 0x41, length: 1, access: read_write, default: 16, source: "
                '"6.3", other_bits: zero, fields: [{name: bits, at: 4:0}]}\n'
            ),
        ),
    )
    assert "Quantities held in registers at run time" in register_page
    assert "Quantities set by the order code" not in register_page
    for page in (register_page, *(page for name, page in files.items() if name.endswith(".md"))):
        assert not re.search(r"(?m)^\|(  \|)*\n\|( --- \|)*\n(?!\|)", page)


def test_a_quantity_without_a_unit_is_a_number(tmp_path: Path) -> None:
    """16 bits are 16, not 10h. An ID is written in hexadecimal."""
    assert "`position_bits` = 16" in page_of(tmp_path)
    assert "`position_bits` = 10h" in page_of(
        tmp_path, ("{meaning: Bits of the position}", "{meaning: Bits of the position, hexadecimal: true}")
    )


def test_profile_ids_stay_hexadecimal(files: Files) -> None:
    assert "| 2814h |" in files["docs/sma21/biss.md"]


@pytest.mark.slow
def test_the_bank_stands_in_the_table_of_registers(files: Files) -> None:
    """TV62, 4.2 and 4.3: 00h to 03h is the preset in bank 1, and 00h and 01h the upper limit in bank 2."""
    banked, _ = load_library([Path(__file__).parents[2] / "docs" / "example"])
    page = generate(Library(banked))["docs/tv62/biss-registers.md"]
    assert "| Bank | Address | Register |" in page
    assert "| 1 | 00h to 03h | [`preset`]" in page
    assert "| 2 | 00h to 01h | [`upper_limit`]" in page
    assert "|  | 40h | [`bank`]" in page
    assert "| Bank |" not in files["docs/amm5/biss-registers.md"]


def test_one_of_a_thing_is_no_plural(files: Files) -> None:
    """ASC85 has no turns, and prints one timeout."""
    page = family_pages_text(files, "asc85")
    assert ", 1 revolution |" in page
    assert not re.search(r"\b1 revolutions\b", page)
    assert "| Timeout | varies with the clock, 350 ns at 10 MHz |" in page


def test_a_picture_says_which_level_is_active(files: Files) -> None:
    """Error and warning of BiSS are 0 when active, and the bits of the RS-485 reply are 1."""
    assert "error (bit 7, 0 = active)" in files["docs/amm5/single_cycle_data.svg"]
    replies = [name for name in files if name.startswith("docs/amm5/") and "reply" in name]
    for name in replies:
        assert "0 = active" not in files[name]


def test_a_page_lacks_a_parameter_that_an_answer_sets() -> None:
    """The page of one interface has the question, but not the parameter ``beyond``, which only the other one uses."""
    specs = Path(__file__).parents[1] / "python" / "specs"
    devices, _ = load_library([specs / "odd_shapes.yaml", specs / "manufacturer.yaml"])
    pages = [text for text in generate(Library(devices)).values() if "`value` = 2 (A width" in text]
    assert any("`beyond` = 3" in page for page in pages)
    assert any("`beyond` = 3" not in page for page in pages)
