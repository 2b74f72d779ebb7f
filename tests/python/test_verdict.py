"""Verdicts on positions, reports of the encoder, and unused bits in the generated package."""

from __future__ import annotations

import copy
import itertools
import os
import pickle
import random
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel.model import Device, Flag, Layout, PlacedLayout, Variant, number_to_bytes
from codewheel.reference import codec
from codewheel.reference.findings import findings
from codewheel.say.commands_and_alarms import alarm_of, meaning, remedy
from codewheel.targets.python.names import DeviceNames
from exhaustive import mostly_exhaustive
from python_path import python_path

#: The manual's only reply to data ID 5, with a bit set in SF that is 0 in the manual (7.3.4).
DATA_ID_5 = bytes.fromhex("2A 02 DA 04 00 43 25 00 90")
WORDS = ["not_usable", "unknown", "usable_with_warning", "usable"]


@pytest.fixture(scope="session")
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


def names(frame: Any) -> list[str]:
    return [report.name for report in frame.reports]


def encoder_frames(devices: Mapping[str, Device]) -> Iterator[tuple[Device, Layout, Variant, PlacedLayout]]:
    """Return every frame of the encoders, each for one order code that has it."""
    for device in devices.values():
        for interface, layout in device.layouts():
            variant = next(candidate for candidate in device.variants if candidate.interface == interface.name)
            if layout.sender == "encoder":
                yield device, layout, variant, layout.place(variant.parameters)


def values_without_reports(placed: PlacedLayout) -> dict[str, int | str | bool]:
    """Return values of a frame that reports nothing."""
    layout = placed.layout
    data_fields = [placed_field for placed_field in placed.fields if placed_field.field.carries_data]
    values: dict[str, int | str | bool] = {placed_field.name: 0 for placed_field in data_fields}
    values |= {field.name: False for field in layout.fields if isinstance(field.kind, Flag)}
    return values | ({layout.selector: layout.selects[0]} if layout.selector else {})


def answers(view: Any, device: Device, layout: Layout) -> dict[str, Any]:
    """Return the first answers to the open questions about a frame, which the model uses."""
    kinds = {alternative.name: alternative.enum_name for alternative in DeviceNames(device).questions_of(layout)}
    return {name: next(iter(getattr(view, kind))) for name, kind in kinds.items()}


def carried(placed: PlacedLayout, number: int) -> Any:
    return number_to_bytes(placed.layout, number, placed.bits) if placed.layout.in_bytes else number


# ------------------------------------------------------------ from the manuals


@pytest.mark.parametrize(
    ("code", "members", "verdict", "reports"),
    [
        # nE and nW of BiSS: 6.2.1 p.32-33.
        ("AMM5A21/65KSC1", {}, "usable", []),
        # The warning bit also reports an error in the magnetic multiturn system, which singleturn models lack.
        ("AMM5A21/65KSC1", {"warning": True}, "not_usable", ["warning"]),
        ("AMM5A21/1SC1", {"warning": True}, "usable_with_warning", ["warning_unexplained"]),
        ("AMM5A21/1SC1", {"error": True}, "not_usable", ["error"]),
        ("AMM5A21/65KSC1", {"warning": True, "error": True}, "not_usable", ["error", "warning"]),
        # With a low battery, the position is usable, and EE_1 sums it up: 4.3.1 p.23, 7.3.2 p.42.
        (
            "AMM5A21/65KJP1",
            {"battery_alarm": True, "status_other_error": True},
            "usable_with_warning",
            ["status_other_error", "battery_alarm"],
        ),
        ("AMM5A21/65KJP1", {"status_other_error": True}, "not_usable", ["status_other_error"]),
        ("AMM5A21/65KJP1", {"battery_alarm": True, "busy": True}, "not_usable", ["busy", "battery_alarm"]),
        # A singleturn model has no battery: 4.3 p.23.
        (
            "AMM5A21/1JP1",
            {"battery_alarm": True, "status_other_error": True},
            "usable_with_warning",
            ["status_other_error", "battery_alarm_unexplained"],
        ),
        ("AMM5A21/1JP1", {"mt_error": True}, "usable_with_warning", ["mt_error_unexplained"]),
        ("AMM5A21/1JP1", {"mt_error": True, "ps_error": True}, "not_usable", ["ps_error", "mt_error_unexplained"]),
        (
            "AMM5A21/65KJP1",
            {"mt_error": True, "status_other_error": True},
            "not_usable",
            ["status_other_error", "mt_error"],
        ),
        ("AMM5A21/65KJP1", {"unused": 0x800}, "usable_with_warning", ["alarm_zero_3_4"]),
        ("AMM5A21/65KJP1", {"unused": 0x1C1}, "usable_with_warning", ["status_info", "status_zero", "alarm_zero_0"]),
        # Bits that report error and warning in the BiSS protocol, and that this encoder does not use: 6.3.1 p.21.
        ("AM3616/4096-I7", {}, "unknown", []),
        ("AM3616/4096-I7", {"unused": 1}, "unknown", ["warning"]),
        ("AM3616/4096-I7", {"unused": 2}, "not_usable", ["error"]),
        # SSI words with only the position, and with an error bit: 5.4 p.22.
        ("AMM5A21/65KBG1", {}, "unknown", []),
        ("SMA21-BG1-0050", {}, "usable", []),
        ("SMA21-BG1-0050", {"error": True}, "not_usable", ["error"]),
    ],
)
def test_what_the_manuals_say(lika: Any, code: str, members: dict[str, Any], verdict: str, reports: list[str]) -> None:
    encoder = lika.lookup(code)
    module = getattr(lika, encoder.family.name)
    kinds = {"JP1": "CompleteReply", "BG1": "SsiWord", "BG": "SsiWord"}
    kind = getattr(module, next((kind for mark, kind in kinds.items() if mark in code), "SingleCycleData"))
    first = {name: 5 for name in kind._fields if name in ("multiturn", "singleturn", "position")}
    first |= {"multiturn": 0} if "/1" in code else {}
    flags = {name: False for name in kind._fields if name.startswith("status_")}
    identity = {"encoder_id": 0x23} if "encoder_id" in kind._fields else {}
    frame = encoder.decode(kind(encoder, **first | flags | identity | members).encode())
    assert (frame.verdict, names(frame)) == (lika.Verdict(verdict), reports)


def test_the_published_frames(lika: Any, vectors: list[dict[str, Any]]) -> None:
    rows = [row for row in vectors if row["protocol"] == "BiSS-C SCD"]
    assert {(row["fields"]["nE"], row["fields"]["nW"]) for row in rows} == {(1, 1), (0, 1), (1, 0)}
    encoder = lika.lookup("SMA21-SC1-0010")
    for row in rows:
        frame = encoder.decode("00" + row["frame_hex_or_bits"])
        error, warning = not row["fields"]["nE"], not row["fields"]["nW"]
        expected = "usable_with_warning" if warning else "usable"
        assert frame.verdict is lika.Verdict("not_usable" if error else expected)
        assert names(frame) == ["error"] * error + ["warning"] * warning
    # EE_1 is set in the reply of the T-format, and data ID 0 does not show which of four errors it is.
    reply = next(row for row in vectors if row["protocol"].startswith("Tamagawa T-format response"))
    frame = lika.lookup("AMM5A23/65KJP1").decode(bytes.fromhex(reply["frame_hex_or_bits"]))
    assert (frame.singleturn, frame.verdict) == (reply["fields"]["ABS"], lika.Verdict.NOT_USABLE)
    assert names(frame) == ["status_other_error"]


def test_the_only_printed_reply_to_data_id_5_decodes(lika: Any) -> None:
    encoder = lika.lookup("SMA21-JP1-0001")
    frame = encoder.decode(DATA_ID_5)
    assert (type(frame).__name__, frame.position, frame.unused) == ("WidePositionReply", 160_037_864_666, 2)
    assert frame.verdict is lika.Verdict.USABLE_WITH_WARNING
    (report,) = frame.reports
    assert (report.name, report.printed_name) == ("status_info", "dd0 ... dd3")
    assert report.makes_position is lika.Verdict.USABLE_WITH_WARNING
    assert report.source.startswith("7.3.2 p.38")
    assert not frame.is_as_documented
    assert frame._replace(unused=0).is_as_documented
    assert frame.encode() == DATA_ID_5
    # Checks of the frame still cause an error: its sync code, and the parity of its data ID.
    for bit in (0, 7):
        changed = bytes((DATA_ID_5[0] ^ 1 << bit, *DATA_ID_5[1:-1], DATA_ID_5[-1] ^ 1 << bit))
        with pytest.raises(lika.ConstantError):
            encoder.decode(changed)


# ------------------------------------------------------------ from the model


@pytest.mark.slow
@pytest.mark.parametrize("first_frame", mostly_exhaustive(range(4), 0))
def test_every_state_of_the_flags(lika: Any, devices: Mapping[str, Device], first_frame: int) -> None:
    """All of them together with no unused bit, with one, and with several."""
    source = random.Random("flags")
    for device, layout, variant, placed in list(encoder_frames(devices))[first_frame::4]:
        family_module = getattr(lika, device.name)
        encoder, class_name_by_frame = family_module.VARIANTS[variant.code], DeviceNames(device).class_name_by_frame
        flags = [field.name for field in layout.fields if isinstance(field.kind, Flag)]
        unused_mask = sum(((1 << field.widest) - 1) << lowest_bit for field, lowest_bit in layout.unused)
        single_unused_bits = [1 << bit for bit in range(64) if unused_mask >> bit & 1]
        random_values = [source.getrandbits(64) & unused_mask for _ in range(2)]
        unused_values = {0, *single_unused_bits, *random_values}
        values, given_answers = values_without_reports(placed), answers(family_module, device, layout)
        for states, unused in itertools.product(itertools.product((False, True), repeat=len(flags)), unused_values):
            values_of_state = values | dict(zip(flags, states, strict=True))
            if unused_mask:
                values_of_state["unused"] = unused
            number = codec.encode(device, placed, values_of_state)
            frame = encoder.decode(carried(placed, number), **given_answers)
            expected_findings = findings(device, variant, codec.decode(device, placed, number))
            assert type(frame).__name__ == class_name_by_frame[layout.name]
            verdict = frame.verdict.value if hasattr(frame, "verdict") else None
            expected = expected_findings.verdict.value if expected_findings.verdict is not None else None
            assert verdict == expected, (frame, expected_findings)
            meanings = [report.meaning for report in frame.reports]
            assert sorted(meanings) == sorted(report.meaning for report in expected_findings.reports)
            assert getattr(frame, "unused", 0) == unused


def test_a_frame_with_a_position_has_a_verdict(lika: Any, devices: Mapping[str, Device]) -> None:
    for device, layout, variant, _ in encoder_frames(devices):
        view = getattr(getattr(lika, device.name), DeviceNames(device).class_name_by_frame[layout.name])
        assert hasattr(view, "verdict") == device.sends_position(variant.interface, layout)


def test_a_report_says_what_the_manual_says_of_its_field(lika: Any, devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        reports = getattr(lika, device.name).REPORTS
        reported_names = set()
        for _, layout in device.layouts():
            flags = [field for field in layout.fields if isinstance(field.kind, Flag) and field.kind.only]
            unexplained = [replace(field.unexplained, name=f"{field.name}_unexplained") for field in flags]
            for field in (*layout.fields, *unexplained):
                alarm = alarm_of(device, field)
                report_texts = (field.printed_name, meaning(field, alarm), remedy(field, alarm))
                of_field = {key: report for key, report in reports.items() if key.endswith(field.name)}
                reported_names |= {key for key, report in of_field.items() if report[1:4] == report_texts}
        assert reported_names == set(reports)
        assert all(key == report.name for key, report in reports.items())


# ------------------------------------------------------------ unused bits


def test_other_bits_than_the_unused_ones_are_refused(lika: Any, devices: Mapping[str, Device]) -> None:
    """The package and the model agree."""
    with_unused = 0
    for device, layout, variant, placed in encoder_frames(devices):
        ones = sum(((1 << field.widest) - 1) << place for field, place in layout.unused)
        view = getattr(lika, device.name)
        encoder, number = view.VARIANTS[variant.code], codec.encode(device, placed, values_without_reports(placed))
        frame = encoder.decode(carried(placed, number), **answers(view, device, layout))
        assert hasattr(frame, "unused") == bool(ones)
        with_unused += bool(ones)
        for bit in range(layout.unused_width + 2) if ones else ():
            values = values_without_reports(placed) | {"unused": 1 << bit}
            if ones >> bit & 1:
                assert frame._replace(unused=1 << bit).encode() == carried(placed, codec.encode(device, placed, values))
                continue
            with pytest.raises(lika.RangeError, match=f"unused must be within the mask {ones:#x}, got {1 << bit}"):
                frame._replace(unused=1 << bit).encode()
            with pytest.raises(codec.EncodeError):
                codec.encode(device, placed, values)
    assert with_unused > 6


@pytest.mark.parametrize(("not_a_number", "error"), [(-1, "RangeError"), (True, "TypeError"), (1.0, "TypeError")])
def test_what_is_no_number_of_unused_bits(lika: Any, not_a_number: Any, error: str) -> None:
    frame = lika.lookup("SMA21-JP1-0001").decode(DATA_ID_5)
    with pytest.raises((ValueError, TypeError)) as caught:
        frame._replace(unused=not_a_number).encode()
    assert type(caught.value).__name__ == error


def test_unused_is_the_last_and_can_be_left_out(lika: Any) -> None:
    encoder, kind = lika.lookup("AMM5A23/65KJP1"), lika.amm5.CompleteReply
    assert kind._fields[-1] == "unused"
    frame = kind.from_position(encoder, 5, False, False, encoder_id=0x23)
    assert frame.unused == 0
    assert frame.is_as_documented
    with_unused = kind.from_position(encoder, 5, False, False, encoder_id=0x23, unused=0x100)
    assert (with_unused != frame, hash(with_unused) != hash(frame), with_unused.is_as_documented) == (True, True, False)
    assert repr(with_unused) == repr(frame).replace("unused=0", "unused=256")
    for kept_frame in (frame, with_unused):
        assert (
            encoder.decode(kept_frame.encode())
            == kept_frame
            == pickle.loads(pickle.dumps(kept_frame))
            == copy.deepcopy(kept_frame)
        )


# ------------------------------------------------------------ objects


def test_reports_are_made_once(lika: Any) -> None:
    encoder, amm5 = lika.lookup("AMM5A21/65KSC1"), lika.amm5
    error_frame = amm5.SingleCycleData(encoder, 0, 5, error=True).encode()
    first, second = (encoder.decode(error_frame).reports for _ in "12")
    assert first[0] is second[0] is amm5.REPORTS["error"]
    assert len(amm5.REPORTS) == len(set(amm5.REPORTS)) > 10
    assert pickle.loads(pickle.dumps(first)) == first == copy.deepcopy(first)
    assert repr(amm5.REPORTS).startswith("{'error': Report(name='error', printed_name='Error, nE', ")


@pytest.mark.slow
def test_nothing_is_made_before_it_is_asked_for(generated_python: tuple[Path, ModuleType]) -> None:
    script = """
from lika_encoders import amm5
encoder = amm5.lookup("AMM5A21/65KSC1")
sound, wrong = (encoder.decode(amm5.SingleCycleData(encoder, 0, 5, error=error).encode()) for error in (False, True))
print(sound.reports, wrong.verdict.name, "_items" in vars(amm5.REPORTS))
print(len(wrong.reports), "_items" in vars(amm5.REPORTS))
"""
    environment = {**os.environ, "PYTHONPATH": python_path(generated_python[0])}
    completed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=environment)
    assert (completed.stdout, completed.stderr) == ("() NOT_USABLE False\n1 True\n", "")


def test_the_words_are_those_of_the_command_line(lika: Any) -> None:
    assert [verdict.value for verdict in lika.Verdict] == WORDS
    assert [verdict.name.lower() for verdict in lika.Verdict] == WORDS
