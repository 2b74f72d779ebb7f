"""docs/example/decode_from_xml.py decodes frames with sixty lines, an XML parser and the description of a device."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from random import Random
from runpy import run_path

import pytest
from codewheel.model import Choice, Device, Flag, Number, PlacedField, PlacedLayout, number_to_bytes
from codewheel.reference import codec
from codewheel.reference.findings import findings

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "docs" / "example" / "decode_from_xml.py"


def output(device: str, code: str, layout: str, frame: str, *answers: str) -> list[str]:
    (xml,) = (ROOT / "generated" / "biss").glob(f"*-{device}.xml")
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(StringIO()) as out:
        patch.setattr(sys, "argv", [str(SCRIPT), str(xml), code, layout, frame, *answers])
        run_path(str(SCRIPT))
    return out.getvalue().splitlines()


def run(device: str, code: str, layout: str, frame: str, *answers: str) -> dict[str, int]:
    lines = output(device, code, layout, frame, *answers)
    rows = [line.split() for line in lines if not line.startswith(("note:", "verdict:"))]
    return {row[0]: int(row[1]) for row in rows}


def test_it_is_short_and_needs_nothing_but_lxml() -> None:
    text = SCRIPT.read_text(encoding="utf-8")
    assert len([line for line in text.splitlines() if line.strip()]) <= 60
    names = [name.name for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import) for name in node.names]
    modules = [node.module for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]
    assert (names, modules) == (["re", "sys"], ["lxml"])


@pytest.mark.parametrize(
    ("device", "code", "layout", "frame", "expected"),
    [
        # TexasInstruments/motor-control-sdk, Tamagawa_UART_output.PNG.
        (
            "amm5",
            "AMM5A23/65KJP1",
            "singleturn_reply",
            "02 20 C7 D1 6A 5E",
            {"data_id": 0, "singleturn": 7_000_519, "status_other_error": 1, "crc": 0x5E},
        ),
        # 16 bits of multiturn, 21 of singleturn, two status bits, CRC: 3, 1,000,003, none active.
        (
            "amm5",
            "AMM5A21/65KSC1",
            "single_cycle_data",
            f"0b{3:016b}{1_000_003:021b}11{0:06b}",
            {"multiturn": 3, "singleturn": 1_000_003, "error": 1, "warning": 1, "crc": 0},
        ),
        (
            "amm5",
            "AMM5A17/1SC1",
            "single_cycle_data",
            f"0b{70_000:017b}10{5:06b}",
            {"singleturn": 70_000, "error": 1, "warning": 0, "crc": 5},
        ),
        # 6.2: four zeros above 20 bits at 50 um.
        (
            "sma21",
            "SMA21-SC4-0050",
            "single_cycle_data",
            f"0b0000{524_289:020b}01{63:06b}",
            {"padding": 0, "position": 524_289, "error": 0, "warning": 1, "crc": 63},
        ),
        # 20 and 16 bits by default, both status bits always 1.
        (
            "am36",
            "AM3616/4096-I7",
            "single_cycle_data",
            f"0b{9:016b}{1_048_575:020b}11{1:06b}",
            {"multiturn": 9, "singleturn": 1_048_575, "error": 1, "warning": 1, "crc": 1},
        ),
    ],
)
def test_frames_of_every_family(device: str, code: str, layout: str, frame: str, expected: dict[str, int]) -> None:
    values = run(device, code, layout, frame)
    assert {name: values.get(name, 0) for name in expected} == expected


@pytest.mark.parametrize(
    ("device", "code", "layout", "frame", "lines"),
    [
        # nE and nW are 0 when active (6.2). A 1 means no error.
        (
            "amm5",
            "AMM5A21/65KSC1",
            "single_cycle_data",
            f"0b{0:037b}10{0:06b}",
            ["error 1 not active", "warning 0 active"],
        ),
        # A flag that is 1 when active, and two bits without meaning.
        (
            "amm5",
            "AMM5A23/65KJP1",
            "singleturn_reply",
            "02 20 C7 D1 6A 5E",
            ["status_st_error 0 not active", "status_other_error 1 active"],
        ),
        ("am36", "AM3616/4096-I7", "single_cycle_data", f"0b{0:036b}11{0:06b}", ["error 1", "warning 1"]),
        (
            "am36",
            "AM3616/4096-I7",
            "single_cycle_data",
            f"0b{0:036b}01{0:06b}",
            ["error 0 not as in the manual", "warning 1"],
        ),
    ],
)
def test_flags_say_whether_they_are_active(device: str, code: str, layout: str, frame: str, lines: list[str]) -> None:
    assert set(lines) <= set(output(device, code, layout, frame))


@pytest.mark.slow
def test_it_looks_at_what_the_position_is_worth(devices: Mapping[str, Device]) -> None:
    """The verdict equals the reference codec's for any combination of active flags and unused bits."""
    source = Random(11)
    verdict_counts = Counter[str]()
    for device in devices.values():
        for kind, layout in device.layouts():
            if layout.sender != "encoder" or device.alternatives_of(layout):
                continue
            if device.measurement_of(kind.name) is None:
                continue  # The script looks for the field that is measured.
            variant = next(variant for variant in device.variants if variant.interface == kind.name)
            placed = layout.place(variant.parameters)
            for likely in (0, 0, 0.2, 0.2, 0.5):
                values = drawn_values(placed, source, likely)
                number = codec.encode(device, placed, values)
                frame_text = number_to_bytes(layout, number, placed.bits).hex() if layout.in_bytes else f"{number:#x}"
                expected = findings(device, variant, codec.decode(device, placed, number)).verdict
                lines = output(device.name, variant.code, layout.name, frame_text)
                words = [line for line in lines if "verdict" in line]
                assert words == ([f"verdict: {expected.value}"] if expected is not None else [])
                verdict_counts[words[0] if words else ""] += 1
    assert len(verdict_counts) == 5


def drawn_values(placed: PlacedLayout, source: Random, likely: float) -> dict[str, int | str | bool]:
    """Return values of a frame in which flags are active, and unused bits differ, with the probability ``likely``."""
    values: dict[str, int | str | bool] = {}
    for field in placed.fields:
        match field.field.kind:
            case Flag():
                values[field.name] = source.random() < likely
            case Number():
                values[field.name] = field.field.number.zero_means
            case Choice(values=choices):
                selects = placed.layout.selects
                is_selector = field.name == placed.layout.selector
                selectable = [choice for choice in choices if not is_selector or choice.value in selects]
                values[field.name] = selectable[0].name
    if placed.layout.unused:
        turned_bits = [field.mask << place for field, place in placed_unused(placed) if source.random() < likely]
        values["unused"] = sum(turned_bits)
    return values


def placed_unused(placed: PlacedLayout) -> Iterator[tuple[PlacedField, int]]:
    for field, place in placed.layout.unused:
        placed_field = placed.find_field(field.name)
        if placed_field is not None:
            yield placed_field, place


@pytest.mark.parametrize("answer", ["", "adf_layout=bit_0", "zero_bit=as_printed"])
def test_it_does_not_decide_for_its_user(answer: str) -> None:
    options = "adf_layout=as_printed or adf_layout=as_t_format"
    with pytest.raises(SystemExit, match=f"choose: {options}"):
        output("amm5", "AMM5A23/65KJP1", "eeprom_read_reply", "EA0A5ABA", *filter(None, [answer]))


@pytest.mark.parametrize(("answer", "zero"), [("as_printed", "0"), ("left_out", "")])
def test_it_takes_a_decision(answer: str, zero: str) -> None:
    """25 bits, with the 0 bit of the manual or without it."""
    frame = f"0b{33_554_429:025b}{zero}11{2:06b}"
    values = run("asc85", "ASC8525/SC2", "single_cycle_data", frame, f"zero_bit={answer}")
    assert (values["position"], values["error"], values["warning"], values["crc"]) == (33_554_429, 1, 1, 2)


@pytest.mark.parametrize(("code", "is_gray"), [("AM3619/4096-GG", True), ("AM3619/4096-BG", False)])
def test_gray_code_is_said(code: str, is_gray: bool) -> None:
    """Return the result of the reference for the values of a register: its bytes, or "refused"."""
    notes = [line for line in output("am36", code, "ssi_word", "0x7FFFFFFF") if line.startswith("note:")]
    assert notes == (["note: position is in Gray code. Its bits are shown as they are sent"] if is_gray else [])


def test_the_page_shows_what_it_prints() -> None:
    page = (ROOT / "docs/master/biss-xml.md").read_text(encoding="utf-8")
    example = re.search(
        r"\$ python docs/example/decode_from_xml\.py \S*lika-(\S+)\.xml (\S+) (\S+) (\S+)\n(.*?)```", page, re.DOTALL
    )
    assert example is not None
    assert output(*example.groups()[:4]) == example[5].splitlines()


@pytest.mark.slow
def test_the_line_in_its_docstring_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    command_line = re.search(
        r"decode_from_xml\.py (.*)", ast.get_docstring(ast.parse(SCRIPT.read_text(encoding="utf-8"))) or ""
    )
    assert command_line is not None
    completed = subprocess.run(
        [sys.executable, str(SCRIPT), *command_line[1].split()], capture_output=True, text=True, check=True
    )
    assert "singleturn 1000003" in completed.stdout
