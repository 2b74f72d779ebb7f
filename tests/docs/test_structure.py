"""Structure of the pages: place of a page, warnings next to the affected facts, and tasks done by hand."""

from __future__ import annotations

import re
from collections.abc import Mapping

import pytest
from codewheel.model.registers import steps_of
from codewheel.say.text import escape, escape_html
from codewheel.targets import Library
from codewheel.targets.docs.cross_family_pages import all_errata_values

Files = Mapping[str, str]


def unlinked(page: str) -> str:
    """Return a page in one line, with the errata in its sentences as the spec names them."""
    return re.sub(r"(errat(?:um|a) )\[[^\]]+\]\([^)]*#erratum-(\w+)\)", r"\1\2", " ".join(page.split()))


def test_every_page_says_where_one_is_and_leads_back(pages: Files) -> None:
    for name, page in pages.items():
        if name.endswith(".md") and name != "docs/README.md":
            up = "../" * (name.count("/") - 1)
            (breadcrumb,) = [line for line in page.splitlines() if line.startswith("[Encoders](") and " › " in line]
            assert breadcrumb.startswith(f"[Encoders]({up}README.md) › "), name
            assert page.index(breadcrumb) < page.index("\n# "), name


def test_a_page_of_a_family_leads_to_all_of_it(library: Library, pages: Files) -> None:
    for device in library.devices:
        index = pages[f"docs/{device.name}.md"]
        links = set(re.findall(r"\]\(([^)#]+)", index))
        family_pages = {name.removeprefix("docs/") for name in pages if name.startswith(f"docs/{device.name}/")}
        empty = set() if device.characteristics else {f"{device.name}/hardware.md"}
        assert {name for name in family_pages if name.endswith(".md")} - empty <= links
        assert all(f"#procedure-{procedure.name})" in index for procedure in device.procedures)
        assert len(index) < 12_000, "an index is no page to read"


def test_what_belongs_to_an_interface_is_on_its_pages(library: Library, pages: Files) -> None:
    for device in library.devices:
        for interface in device.interfaces:
            start = f"docs/{device.name}/{interface.name}"
            page = "".join(page for name, page in pages.items() if name.startswith((f"{start}.md", f"{start}-")))
            names = [f"layout-{layout.name}" for layout in interface.layouts]
            registers = [register for register in device.registers if register.interface == interface.name]
            names += [f"register-{register.name}" for register in registers]
            procedures = [procedure for procedure in device.procedures if procedure.interface == interface.name]
            names += [f"procedure-{procedure.name}" for procedure in procedures]
            connectors = [connector for connector in device.connectors if interface.name in connector.interfaces]
            names += [f"connector-{connector.name}" for connector in connectors]
            assert [name for name in names if f'<a id="{name}"></a>' not in page] == []


def test_the_title_of_a_page_names_only_what_it_has(pages: Files) -> None:
    """AM36, section 4: no LEDs, and two inputs over SSI. AMM5, sections 6.2 and 9: LEDs."""
    assert "# AM36: BiSS C-mode, wiring\n" in pages["docs/am36/biss-wiring.md"]
    assert "# AMM5: BiSS C-mode, wiring and LEDs\n" in pages["docs/amm5/biss-wiring.md"]
    assert "# AM36: SSI, inputs\n" in pages["docs/am36/ssi-procedures.md"]


def test_an_erratum_is_told_where_it_first_bites_and_named_where_it_does_again(pages: Files) -> None:
    """AMM5 7.5 p.46: it is open which bit is MEM BUSY. This affects four frames."""
    page = pages["docs/amm5/rs485.md"]
    title = "[The printed position of MEM BUSY in the address byte is doubtful]"
    lines = [line for line in page.splitlines() if title in line]
    assert lines[0].startswith(
        f'- <a id="erratum-mem_busy_position"></a>⚠ **open** {title}(errata.md#erratum-mem_busy_position). Used: '
        "Either position is possible. The user must choose, and there is no default."
    )
    assert set(lines[1:]) == {f"- ⚠ **open** {title}(#erratum-mem_busy_position) (see above)"}
    frame = page.partition('<a id="layout-eeprom_write_request"></a>')[2].partition('<a id="layout-')[0]
    assert lines[0] in frame


def test_an_erratum_is_a_badge_with_one_line_on_the_page_of_an_order_code(pages: Files) -> None:
    """AMM5 4.1.3 p.21: A and B without + or -."""
    page = pages["docs/amm5/AMM5A23-65KJP1.md"]
    wiring = page.partition("## Wiring")[2].partition("\n## ")[0]
    ground = '<a href="#erratum-ground_wire">The manual lists no cable wire for the ground pin that must be used</a>'
    polarity = "The manual does not give the polarity of RS-485 lines A and B"
    links = f'{ground} · <a href="#erratum-rs485_polarity">{polarity}</a>'
    assert f"<details><summary>Errata: ⚠ 2 open</summary>⚠ open: {links}</details>\n" in wiring
    line = (
        f'- <a id="erratum-rs485_polarity"></a>⚠ **open** [{polarity}](errata.md#erratum-rs485_polarity). Used: '
        "The names are listed as printed. No polarity is assumed.\n"
    )
    assert line in page.partition("<summary><b>Errata</b>")[2]


@pytest.mark.slow
def test_the_reason_of_an_erratum_is_on_one_page(library: Library, pages: Files) -> None:
    for device in library.devices:
        for erratum in device.errata:
            if erratum.why and not erratum.overlay:
                why = " ".join(escape(erratum.why).split())
                family_pages = {name: page for name, page in pages.items() if name.startswith(f"docs/{device.name}")}
                pages_with_reason = [name for name, page in family_pages.items() if why in unlinked(page)]
                assert pages_with_reason == [f"docs/{device.name}/errata.md"], erratum.name


@pytest.mark.slow
def test_each_erratum_stands_in_full_on_one_page(library: Library, pages: Files) -> None:
    for device in library.devices:
        for erratum in device.errata:
            head = f'<summary><b>{escape_html(erratum.title)}</b></summary>\n\n<a id="erratum-{erratum.name}"></a>\n'
            heads = [name for name, page in pages.items() if head in page and device.name in name]
            assert heads == [f"docs/{device.name}/errata.md"]


def test_other_editions_are_apart_from_the_errata_of_the_manual(library: Library, pages: Files) -> None:
    """AMM5, document release: edition 1.7 updated registers 44h to 47h."""
    manual, other_editions = pages["docs/amm5/errata.md"].split("\n## Other editions\n")
    (amm5,) = [device for device in library.devices if device.name == "amm5"]
    for erratum in amm5.errata:
        assert (f'<a id="erratum-{erratum.name}"></a>' in other_editions) == bool(erratum.edition)
        assert (f'<a id="erratum-{erratum.name}"></a>' in manual) != bool(erratum.edition)


def test_no_heading_without_errata() -> None:
    assert all_errata_values([]) == {"standings": []}


def test_open_errata_of_all_families_come_first(library: Library, pages: Files) -> None:
    opened, settled = pages["docs/all-errata.md"].split('<a id="settled"></a>')
    for device in library.devices:
        for erratum in device.errata:
            if not erratum.edition:
                link = f"]({device.name}/errata.md#erratum-{erratum.name})"
                assert (link in opened, link in settled) == (erratum.status == "open", erratum.status == "settled")


def test_a_battery_is_changed_step_by_step(pages: Files) -> None:
    """AMM5 4.3.1 p.23 has 8 steps, 4.3.2 p.24 has 21."""
    page = pages["docs/amm5/hardware.md"]
    for name, count in (("without", 8), ("with", 21)):
        interface = page.partition(f'<a id="by-hand-battery_replacement_{name}_error"></a>')[2].partition("<a id=")[0]
        numbers = [int(number) for number in re.findall(r"(?m)^(\d+)\. ", interface)]
        assert numbers == list(range(1, count + 1))
    assert "14. Short-circuit the battery terminals (white and blue wires)" in page
    assert "(amm5/hardware.md#by-hand-battery_replacement_with_error)" in pages["docs/amm5.md"]


@pytest.mark.parametrize(
    ("value", "steps"),
    [
        ("First. 1. Stop. 2. Go on. 3. Start at 3.5 V.", ("First.", "Stop.", "Go on.", "Start at 3.5 V.")),
        ("1. Stop. 2. Go on.", ("", "Stop.", "Go on.")),
        ("As in Figure 1. Fixed with SSI.", ("As in Figure", "Fixed with SSI.")),
        ("1. See Figure 4. 2. Go on.", ("1. See Figure 4. 2. Go on.",)),
        ("Ø 24 mm; M3 × 3", ("Ø 24 mm; M3 × 3",)),
    ],
)
def test_steps_are_counted_from_one(value: str, steps: tuple[str, ...]) -> None:
    assert steps_of(value) == steps


def test_a_blinking_error_led_is_explained_both_ways(pages: Files) -> None:
    """AMM5, section 9: it blinks if the installation succeeded. 4.3.2, steps 5 and 17: it blinks with an error."""
    steps = "hardware.md#by-hand-battery_replacement_with_error)"
    for name, folder in (("docs/alarms-and-leds.md", "amm5/"), ("docs/amm5/AMM5A21-65KSC1.md", "")):
        blinking = [line for line in pages[name].splitlines() if line.startswith("|") and "blink" in line]
        assert any("The installation succeeded" in line for line in blinking)
        (error,) = [line for line in blinking if "An error is active" in line]
        assert f"({folder}{steps}" in error


@pytest.mark.parametrize(
    ("start", "steps"),
    [
        ("| [Battery alarm](", "without_error"),
        ("| [MT error](", "with_error"),
        ("| LED 1 (ERROR) | red with a depleted battery |", "with_error"),
        ("| LED 2 (WARNING) | red with a low battery |", "without_error"),
    ],
)
def test_what_a_battery_reports_leads_to_the_steps(pages: Files, start: str, steps: str) -> None:
    """AMM5, section 9: 4.3.2 for LED 1 and MT error, 4.3.1 for LED 2 and Battery alarm."""
    (row,) = [line for line in pages["docs/alarms-and-leds.md"].splitlines() if line.startswith(start)]
    assert f"(amm5/hardware.md#by-hand-battery_replacement_{steps})" in row


def test_a_singleturn_page_tells_nobody_to_replace_a_battery(pages: Files) -> None:
    """AMM5, 4.3: only .../65K... have batteries. An erratum describes the open question."""
    for interface in ("BG1", "JP1", "SC1"):
        page = pages[f"docs/amm5/AMM5A17-1{interface}.md"]
        assert "singleturn_without_battery" in page
        assert not re.search(r"by-hand-battery|battery_replacement|0Vb|Replace the battery", page)
        assert "by-hand-battery" in pages[f"docs/amm5/AMM5A17-65K{interface}.md"]


def test_a_battery_step_cannot_be_misread(pages: Files) -> None:
    """4.3.2, step 11: the disk is rotated. The supply is not switched on."""
    (step,) = [line for line in pages["docs/amm5/hardware.md"].splitlines() if line.startswith("11. ")]
    assert step.count("keep turning the disk") == 3


def test_a_sentence_links_to_the_errata_that_it_names(pages: Files) -> None:
    link = "[The manual only partly says which errors affect the position]({}errata.md#erratum-position_under_error)"
    assert f"(erratum {link.format('')})" in pages["docs/amm5/biss.md"]
    assert f"(erratum {link.format('')})" in pages["docs/amm5/AMM5A21-65KSC1.md"]
    titles = {
        "ssi_cable_400_m": "The clock limit for cables under 400 m is below the clock range",
        "ssi_cable_50_m": "The cable length table allows no cable from 400 kHz to 4 MHz",
    }
    cable = ", ".join(f"[{title}](amm5/errata.md#erratum-{name})" for name, title in titles.items())
    assert f"errata {cable}" in pages["docs/amm5-ssi-masters.md"]


def test_one_sentence_is_not_a_list(pages: Files) -> None:
    for name in ("docs/amm5.md", "docs/amm5/ssi.md"):
        assert "\n\nDifferences from other editions of the manual are noted inline." in pages[name]


def test_a_printed_name_in_a_sentence_has_quotes(pages: Files) -> None:
    """AMM5 6.4: a register. ASC85 6.4: a bit of the status register."""
    registers_page = " ".join(pages["docs/amm5/biss-registers.md"].split())
    assert 'disable writing again with "Preset setting enable"' in registers_page
    assert 'The status "Error message" is forced to 1.' in pages["docs/asc85/biss-procedures.md"]


def test_a_link_to_an_erratum_shows_its_title(library: Library, pages: Files) -> None:
    """Readers see titles. A name is only in an anchor."""
    names = {erratum.name for device in library.devices for erratum in device.errata}
    for page_name, page in pages.items():
        labels = re.findall(r"\[([^\]]+)\]\([^)]*#erratum-\w+\)", page)
        assert [label for label in labels if label.strip("`") in names] == [], page_name
        heads = re.findall(r'<a id="erratum-\w+"></a>\n\n## (.*)', page)
        assert [head for head in heads if head.strip("`") in names] == [], page_name
