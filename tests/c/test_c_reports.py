"""Reports of frames in C, compared with the reference: verdict, reports and their texts, unused bits."""

from __future__ import annotations

import random
import shlex
from collections.abc import Iterable, Iterator, Mapping
from functools import reduce
from operator import xor
from pathlib import Path

import pytest
from c_harness import GCC, Run, compile_c, write
from codewheel.model import Device, Flag, PlacedLayout, Variant, Verdict
from codewheel.plan.verdicts import ReportCause, reportings, reports_of
from codewheel.reference.bits_and_values import unused_bits
from codewheel.reference.codec import decode, encode
from codewheel.reference.findings import FrameReport, findings
from codewheel.say.commands_and_alarms import alarm_of, meaning
from codewheel.targets.c.device import views_of
from test_c_codec import Table, check, encoded_sample, on_the_wire, samples

pytestmark = pytest.mark.slow

#: Number of frames of each layout and order code. ``make verify-crosscheck`` uses a million.
FRAMES = 300
VERDICTS = list(Verdict)
NOT_USABLE, UNKNOWN, WARNING, USABLE = range(4)


def frames(device: Device) -> Iterator[tuple[str, Variant, PlacedLayout, int]]:
    """Yield valid frames of the encoder with random flags and unused bits, or with only one active."""
    random_ = random.Random("reports")
    table = Table(device)
    for name, variant, placed in table.cases():
        if placed.layout.sender != "encoder":
            continue
        data = [field for field in placed.fields if field.field.carries_data]
        choices = {field.name: samples(field.field, field.width, placed.layout, random_) for field in data}
        flags = [field for field in data if isinstance(field.field.kind, Flag)]
        quiet = {flag.name: int(flag.field.kind.active_low) for flag in flags if isinstance(flag.field.kind, Flag)}
        sets = [quiet, *({**quiet, flag.name: 1 - quiet[flag.name]} for flag in flags)]
        for fixed in (*sets, *({} for _ in range(FRAMES))):
            yield name, variant, placed, encoded_sample(device, placed, choices, fixed, random_)


def by_interface(device: Device) -> list[Device]:
    """Return the device with each of its interfaces alone, because C has separate headers for each."""
    return [view.device for view in views_of(device)]


def report_key(device: Device, cause: ReportCause) -> tuple[str, str]:
    """Return the field and the text of a report. A flag can have another meaning for other order codes."""
    return cause.cause.field.name, meaning(cause.described_field, alarm_of(device, cause.described_field))


class ExpectedReports:
    """Expected reports of the frames of a device, from the reference. C numbers the reports of each interface."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self._bits = {}
        for name, reporting in reportings(device).items():
            bits = {report_key(device, cause): 1 << cause.report.number for cause in reporting.causes}
            self._bits[name] = bits

    def says_anything(self, layout: str) -> bool:
        return layout in self._bits

    def has_reports(self, layout: str) -> bool:
        return bool(self._bits[layout])

    def mask(self, reports: Iterable[FrameReport], layout: str) -> int:
        return sum(self._bits[layout][report.field, report.meaning] for report in reports)

    def verdict_and_mask(self, variant: Variant, placed: PlacedLayout, number: int) -> tuple[int | None, int]:
        """Return the verdict, if there is one, and the mask of the reports."""
        reference = findings(self.device, variant, decode(self.device, placed, number))
        verdict = VERDICTS.index(reference.verdict) if reference.verdict is not None else None
        return verdict, self.mask(reference.reports, placed.name)

    def row(self, variant: Variant, placed: PlacedLayout, number: int) -> str:
        """Return the expected answer of the harness."""
        verdict, reports = self.verdict_and_mask(variant, placed, number)
        mask = f"{reports:X}" if self.has_reports(placed.name) else "-"
        return f"0 {'-' if verdict is None else verdict} {mask}"


@pytest.mark.one_in(2, "exhaustive")
def test_verdict_and_reports_are_those_of_the_reference(machine: tuple[Device, Run]) -> None:
    device, run = machine
    pairs = []
    for expected_reports in map(ExpectedReports, by_interface(device)):
        for name, variant, placed, number in frames(expected_reports.device):
            if expected_reports.says_anything(name):
                line = f"{variant.code} tells {name} {on_the_wire(placed, number)}"
                pairs.append((line, expected_reports.row(variant, placed, number)))
    check(run, pairs)
    verdicts = {answer.split()[1] for _, answer in pairs}
    expected = {
        "am36": "0 1",
        "amm5": "0 1 2 3 -",
        "asc85": "0 1 2 3",
        "reserved": "0 1 2 3 -",
        "sma21": "0 2 3",
        "words": "0 3 -",
    }
    assert verdicts >= set(expected.get(device.name, "").split()), verdicts


@pytest.mark.one_in(4, "exhaustive")
def test_every_report_is_made_and_has_its_text(machine: tuple[Device, Run]) -> None:
    """One report at a time. For several reports, the text is that of the lowest bit."""
    whole, run = machine
    for device in by_interface(whole):
        if reports_of(device):
            every_report_is_made(device, run)


def every_report_is_made(device: Device, run: Run) -> None:
    everything = reports_of(device)
    texts: dict[int, list[str]] = {}
    expected_reports = ExpectedReports(device)
    for name, variant, placed, number in frames(device):
        reference = findings(device, variant, decode(device, placed, number))
        for report in reference.reports:
            bit = expected_reports.mask([report], name)
            row = [everything[bit.bit_length() - 1].name, report.printed_name, report.meaning, report.remedy]
            texts.setdefault(bit, [*row, report.source])
    assert sorted(texts) == [1 << report.number for report in everything]
    code = device.variants[0].code
    answers = run([f"{code} text of {-bit & 0xFFFF_FFFF:X}" for bit in texts])
    assert {bit: shlex.split(answer) for bit, answer in zip(texts, answers, strict=True)} == texts
    assert run([f"{code} text of 0"]) == ['"" "" "" "" ""']


@pytest.mark.one_in(2, "exhaustive")
def test_the_strict_form_wants_unused_bits_as_the_manual_has_them(machine: tuple[Device, Run]) -> None:
    device, run = machine
    pairs = []
    for name, variant, placed, number in frames(device):
        reference = findings(device, variant, decode(device, placed, number))
        documented = any(field.equals is not None for field in placed.layout.fields)
        if documented or placed.layout.unused:
            strict = not reference.differences and not unused_bits(placed, number)
            pairs.append((f"{variant.code} expected {name} {on_the_wire(placed, number)}", f"0 {int(strict)}"))
    check(run, pairs)
    if device.name in ("am36", "amm5", "reserved", "sma21"):
        assert {answer for _, answer in pairs} == {"0 0", "0 1"}


def with_xor(text: str) -> str:
    """Return a frame with its CRC."""
    data = bytes.fromhex(text)
    return (data + bytes((reduce(xor, data),))).hex().upper()


def test_verdicts_by_hand(run: Run) -> None:
    """AMM5 over RS-485: the manual's frames (7.2.1, 7.4), and the same ones with another status bit."""
    complete = {
        "1A 00 A5A500 23 888800 00": f"{USABLE} 0",
        # BUSY, and EE_1, which sums it up. All position data are 0.
        "1A 20 000000 23 000000 02": f"{NOT_USABLE} 24",
        # EE_1 also sums up the battery alarm, with which the position is usable.
        "1A 20 A5A500 23 888800 80": f"{WARNING} 404",
        "1A 20 A5A500 23 888800 00": f"{NOT_USABLE} 4",
        # Bits that are 0 in the manual: of the status, and of the alarms.
        "1A 01 A5A500 23 888800 10": f"{WARNING} 81",
    }
    code = "AMM5A23/65KJP1"
    pairs = [(f"{code} tells complete_reply {with_xor(frame)}", f"0 {answer}") for frame, answer in complete.items()]
    # A reply from a public log: EE_1 is active, and the reply does not show the cause.
    pairs.append((f"{code} tells singleturn_reply 0220C7D16A5E", f"0 {NOT_USABLE} 4"))
    # Singleturn models have no battery (4.3). The manual does not say what BATT and MTERR mean for them.
    singleturn = {
        "1A 20 A5A500 23 000000 80": f"{WARNING} 4004",
        "1A 20 A5A500 23 000000 40": f"{WARNING} 2004",
        "1A 20 A5A500 23 000000 42": f"{NOT_USABLE} 2024",
    }
    code = "AMM5A23/1JP1"
    pairs += [(f"{code} tells complete_reply {with_xor(frame)}", f"0 {answer}") for frame, answer in singleturn.items()]
    check(run, pairs)


def test_the_only_printed_reply_to_data_id_5_has_its_position(programs: Mapping[str, Run]) -> None:
    """SMA21 7.3.4: SF = 02h sets dd1, which is 0 in 7.3.2."""
    code, frame = "SMA21-JP1-0001", "2A02DA040043250090"
    lines = {
        f"decode wide_position_reply {frame}": "0 0 0 160037864666 2",
        f"tells wide_position_reply {frame}": f"0 {WARNING} 1",
        f"expected wide_position_reply {frame}": "0 0",
        "encode wide_position_reply 0 0 160037864666 2": f"0 {frame}",
        # A bit of a flag is not an unused bit.
        "encode wide_position_reply 0 0 160037864666 16": f"4 {'00' * 9}",
    }
    check(programs["sma21"], [(f"{code} {line}", answer) for line, answer in lines.items()])


def test_an_error_of_an_encoder_that_has_none(programs: Mapping[str, Run], every_device: Mapping[str, Device]) -> None:
    """AM36 always sends nE and nW as 1 (6.3.1). A word with such a bit at 0 still has its position."""
    device = every_device["am36"]
    variant = next(variant for variant in device.variants if variant.interface == "biss")
    placed = device.interface("biss").layouts[0].place(variant.parameters)
    answers = {0: f"{UNKNOWN} 0", 1: f"{UNKNOWN} 2", 2: f"{NOT_USABLE} 1", 3: f"{NOT_USABLE} 3"}
    for unused, answer in answers.items():
        word = encode(device, placed, {"multiturn": 1, "singleturn": 2, "unused": unused})
        assert word >> 6 & 3 == 3 - unused
        assert programs["am36"]([f"{variant.code} tells {placed.name} {word:X}"]) == [f"0 {answer}"]


def test_a_position_of_unknown_worth_ranks_below_a_usable_one(
    programs: Mapping[str, Run], every_device: Mapping[str, Device]
) -> None:
    """``verdict >= CW_USABLE`` is false for an SSI word, which has no status bits."""
    numbers = []
    for code, layout in (("AMM5A17/1BG1", "ssi_word"), ("AMM5A17/1SC1", "single_cycle_data")):
        device = every_device["amm5"]
        variant = next(variant for variant in device.variants if variant.code == code)
        placed = device.layout(layout).place(variant.parameters)
        values = {field.name: 0 for field in placed.fields if isinstance(field.field.kind, Flag)}
        word = encode(device, placed, {"singleturn": 5, **values})
        (answer,) = programs["amm5"]([f"{code} tells {layout} {word:X}"])
        numbers.append(int(answer.split()[1]))
    assert numbers[0] < numbers[1]


@pytest.mark.slow
def test_texts_take_nothing_where_they_are_not_used(c_devices: tuple[Device, ...], tmp_path: Path) -> None:
    """Even without optimisation, a program that uses no text of a report contains none."""
    include = write(tmp_path, c_devices)
    remedy = b"Turn on the main power twice"
    call = "lika_amm5_rs485_report_text(2U)->remedy"
    sizes = {}
    for name, used in (("without", '""'), ("with", call)):
        code = '#include "lika/amm5_rs485_reports.h"\n'
        code += f"int main(void) {{ const char *const text = {used}; return (int)text[0]; }}\n"
        program = compile_c([*GCC, "-O0"], code, tmp_path, include, name)
        sizes[name] = remedy in program.read_bytes()
    assert sizes == {"without": False, "with": True}


def test_unused_bits_are_selected_by_name(include: Path) -> None:
    """A bare number in the condition of a verdict or report would not tell which field it is."""
    texts = [path.read_text(encoding="ascii") for path in sorted(include.rglob("*.h"))]
    assert any("(frame->unused & LIKA_AM36_BISS_UNUSED_ERROR) != 0U" in text for text in texts)
    assert not [text for text in texts if "frame->unused & 0x" in text]
