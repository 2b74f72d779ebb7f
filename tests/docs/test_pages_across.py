"""The pages across families are complete, and their comparisons agree with the manuals."""

from __future__ import annotations

import re
from collections.abc import Mapping

import pytest
from codewheel.model import Device
from codewheel.targets import Library

Files = Mapping[str, str]


def rows(page: str, start: str) -> list[str]:
    return [line for line in page.splitlines() if line.startswith(f"| {start}")]


def test_every_register_is_listed_by_its_address(library: Library, pages: Files) -> None:
    page = pages["docs/registers-by-address.md"]
    for device in library.devices:
        for register in device.registers:
            register_rows = rows(page, f"{register.address:02X}h")
            link = f"({device.name}/{register.interface}-registers.md#register-{register.name})"
            assert any(link in row for row in register_rows), register.name
    places = [line[2:4] for line in page.splitlines() if line[4:5] == "h" and line.startswith("| ")]
    assert places == sorted(places)


def test_every_alarm_and_led_is_listed(library: Library, pages: Files) -> None:
    page = pages["docs/alarms-and-leds.md"]
    for device in library.devices:
        assert [alarm.name for alarm in device.alarms if f".md#alarm-{alarm.name})" not in page] == []
        assert [led.title for led in device.leds if not rows(page, led.title)] == []


@pytest.mark.parametrize(
    "row",
    [
        # AM36 6.5 p.31 and 6.6 p.32; AMM5 p.7, 5.2 p.28, 6.2.1 p.32, 6.4 p.35 and p.39; SMA21 7.1 p.37.
        "| [AM36](am36.md) | [55h](am36/biss-registers.md#register-device_type) | Device type | `02h` |",
        "| BiSS C-mode | [AM36](am36.md) | Clock | 200 kHz to 10 MHz |",
        "| BiSS C-mode | [AMM5](amm5.md) | [`single_cycle_data`](amm5/biss.md#layout-single_cycle_data) | 25 to 47 |",
        "| [AMM5](amm5.md) | [78h to 7Dh](amm5/biss-registers.md#register-device_id) | Device ID, name | `AMM5` |",
        "| RS-485 | [AMM5](amm5.md) | [`complete_reply`](amm5/rs485.md#layout-complete_reply) | 88 | low byte first |",
        "| [AMM5](amm5.md) | Singleturn resolution | 17, 21, 23 | bits |",
        "| [AMM5](amm5.md) | low byte first | [11h to 17h Preset](amm5/biss-registers.md#register-preset) |",
        pytest.param(
            "| [AMM5](amm5.md) | AMM5A and AMM5B absolute kit encoders "
            "| `AMM5xy/zu` with x = A or B, y = 17, 21 or 23, z = 1 or 65K, u = BG1, SC1 or JP1 |",
            id="label",
        ),
        "| SSI | [AMM5](amm5.md) | Code | binary |",
        "| RS-485 | [SMA21](sma21.md) | Baud rate | 2,500,000 Bd, 8 data bits, no parity, 1 stop bit, no flow control",
    ],
)
def test_what_tells_the_families_apart(pages: Files, row: str) -> None:
    assert rows(pages["docs/which-encoder.md"] + pages["docs/compare-encoders.md"], row.removeprefix("| "))


#: A link to a register or a frame, after its numbers: `[42h to 43h](am36/biss-registers.md#register-profile_id)`.
LINK = re.compile(r"\[([^]]*)\]\((\w+)/[\w-]+\.md#(?:register|layout)-(\w+)\)")


def cells(page: str, part: str) -> list[list[str]]:
    """Return the rows of the table that follows these words."""
    table = page.partition(part)[2].partition("| ---")[2].partition("\n\n")[0]
    return [line.strip("| ").split(" | ") for line in table.splitlines()[1:]]


def numbers(text: str, base: int) -> list[int]:
    pattern = r"\b[0-9A-F]+(?=h\b)" if base == 16 else r"\d+"
    return [int(number, base) for number in re.findall(pattern, text)]


def shows_value(cell: str, value: object) -> bool:
    """Return True if a cell shows this content: a number, a text, or an expression by its parameter."""
    inner = cell.split("`")[1]
    if cell.endswith("by order code"):
        return f"'{inner}'" in repr(value)
    return numbers(inner, 16) == [value] if isinstance(value, int) else inner == value


def test_addresses_and_contents_by_which_an_encoder_is_recognised(devices: Mapping[str, Device], pages: Files) -> None:
    page = pages["docs/which-encoder.md"]
    identity_rows = cells(page, "Without a label, identify the encoder by the values in its registers:")
    assert len(identity_rows) == sum(len(list(device.identity)) for device in devices.values()) > 10
    for _, where, name, content, _ in identity_rows:
        ((addresses, device, register_name),) = LINK.findall(where)
        (register,) = (register for register in devices[device].registers if register.name == register_name)
        assert numbers(addresses, 16) == sorted({register.address, register.address + register.length - 1}), where
        assert any(shows_value(content, field.equals) for field in register.layout.fields), (name, content)
    for _, _, links in cells(pages["docs/compare-encoders.md"], "## Byte order of registers"):
        for addresses, device, register_name in LINK.findall(links):
            (register,) = (register for register in devices[device].registers if register.name == register_name)
            last = register.address + register.length - 1
            assert addresses.startswith(f"{register.address:02X}h to {last:02X}h "), addresses


def test_frames_and_resolutions_side_by_side(devices: Mapping[str, Device], pages: Files) -> None:
    page = pages["docs/compare-encoders.md"]
    for _, _, frame, printed_lengths, order, _ in cells(page, "## Frames with a position"):
        ((_, name, layout_name),) = LINK.findall(frame)
        ((interface, layout),) = (pair for pair in devices[name].layouts() if pair[1].name == layout_name)
        variants = [variant for variant in devices[name].variants if variant.interface == interface.name]
        frame_lengths = {layout.place(variant.parameters).bits for variant in variants}
        assert numbers(printed_lengths, 10) == sorted({min(frame_lengths), max(frame_lengths)}), frame
        assert order.split()[0] == (layout.byte_order.split("_")[0] if layout.in_bytes else "most")
    for family, quantity, printed_values, _, _ in cells(page, "## Resolution"):
        device = devices[family.split("(")[1].removesuffix(".md)")]
        (name,) = [parameter.name for parameter in device.set_parameters if parameter.meaning == quantity]
        settings = {variant.parameters[name] for variant in device.variants if name in variant.parameters}
        assert sorted(settings) == numbers(printed_values, 10), quantity


def test_interfaces_stand_together(pages: Files) -> None:
    page = pages["docs/compare-encoders.md"].partition('<a id="interfaces"></a>')[2]
    titles = [line.split(" | ")[0] for line in page.splitlines() if line.startswith(("| SSI", "| BiSS", "| RS"))]
    assert titles == sorted(titles, key=["| SSI", "| BiSS C-mode", "| RS-485"].index)


def test_the_index_leads_to_them(pages: Files) -> None:
    for name in (
        "which-encoder.md",
        "compare-encoders.md",
        "registers-by-address.md",
        "alarms-and-leds.md",
        "all-errata.md",
        "glossary-of-terms.md",
    ):
        assert f"({name})" in pages["docs/README.md"]
        assert "(README.md)" in pages[f"docs/{name}"]
