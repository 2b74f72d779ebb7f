"""Many frames at once lead to the same results as one by one: every layout, valid and disturbed frames."""

from __future__ import annotations

import random
from collections import defaultdict
from importlib import import_module
from typing import Any

import numpy
import pytest
from codewheel.model import Verdict
from codewheel.reference import codec
from codewheel.reference.findings import findings
from codewheel.targets.python.names import CLASS_NAMES, python_name
from test_agreement import CASES_OF_FAMILIES, KINDS, Case, Family, arguments_of, cases, families, family, values_of

__all__ = ["families", "family"]
pytestmark = pytest.mark.slow

#: Number of frames of each layout, over all order codes, and of those compared with the model, which is slow.
FRAMES, FRAMES_OF_THE_MODEL = 10_000, 1_000
FAULTS = {"length": 1, "crc": 2, "constant": 3, "range": 4}


def numbers(case: Case, count: int, source: random.Random) -> list[int]:
    """Return frames as numbers: valid frames, frames with flipped bits, random frames with a correct CRC, and noise."""
    bits = case.placed.bits
    kinds = ("zero", "ones", *["random"] * min(count // 8, 30))
    frame_numbers = [codec.encode(case.family.device, case.placed, values_of(case, kind, source)) for kind in kinds]
    for _ in range(count - len(frame_numbers)):
        number = source.choice(frame_numbers[:32])
        for _ in range(source.choice((0, 1, 1, 2, 8))):
            number ^= 1 << source.randrange(bits)
        frame_numbers.append(source.getrandbits(bits) if source.random() < 0.1 else number)
    return frame_numbers


def decoded_one_by_one(case: Case, wire: list[Any]) -> tuple[list[Any], list[int]]:
    """Return the frames, with None for errors, and the errors."""
    frames, faults = [], []
    for data in wire:
        try:
            frames.append(case.view.decode(data, *arguments_of(case)))
            faults.append(0)
        except ValueError as error:
            frames.append(None)
            faults.append(FAULTS[KINDS[type(error).__name__]])
    return frames, faults


def check_columns(case: Case, table: Any, frames: list[Any], faults: list[int]) -> None:
    """Compare the columns with the frames one by one."""
    assert table.fault.tolist() == faults, case.layout.name
    valid_rows = [row for row, frame in enumerate(frames) if frame is not None]
    for name in table.names:
        column = table[name]
        if name in ("fault", "verdict"):
            continue
        if column.dtype.kind == "S":
            texts = [text.decode("latin-1") for text in column[valid_rows].tolist()]
            assert texts == [getattr(frames[row], name).rstrip("\0") for row in valid_rows], name
            continue
        attribute_name, scale = name.partition(" (")[0], table.scale(name)
        expected_values = [getattr(frames[row], attribute_name) for row in valid_rows]
        if scale is not None:
            expected_values = [scale.decimal(value) for value in expected_values]
        assert column[valid_rows].tolist() == expected_values, (case.layout.name, name)
    if hasattr(case.view, "verdict"):
        verdict_names = [verdict.name for verdict in type(frames[valid_rows[0]].verdict)] if valid_rows else []
        verdict_indexes = [verdict_names.index(frame.verdict.name) if frame is not None else 0 for frame in frames]
        assert table.verdict.tolist() == verdict_indexes, case.layout.name
    if hasattr(case.view, "reports"):
        check_report_columns(case, table, frames)


def names_of_reports(frame: Any) -> set[str]:
    """Return the names of the reports of a frame, or of no frame."""
    return set() if frame is None else {report.name for report in frame.reports}


def check_report_columns(case: Case, table: Any, frames: list[Any]) -> None:
    """Compare the columns of the reports with the reports of the frames."""
    named = {name: report.name for name, report in getattr(case.family.module, "REPORTS", {}).items()}
    report_names = list(map(names_of_reports, frames))
    for name, column in table.reports.items():
        places = [place for place, names in enumerate(report_names) if named[name] in names]
        assert numpy.flatnonzero(column).tolist() == places, (case.layout.name, name)
    assert set().union(*report_names) <= {named[name] for name in table.reports}


def by_layout(family: Family) -> dict[str, list[Case]]:
    """Return the cases of each frame of a family, without registers."""
    cases_by_layout: dict[str, list[Case]] = defaultdict(list)
    for case in cases(family):
        if case.register is None:
            cases_by_layout[case.layout.name].append(case)
    assert cases_by_layout
    return cases_by_layout


@pytest.mark.one_in(6, "exhaustive")
@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_columns_are_what_each_frame_is(family: Family) -> None:
    source = random.Random(family.device.name)
    for name, layout_cases in by_layout(family).items():
        seen_faults: set[int] = set()
        for case in layout_cases:
            frame_numbers = numbers(case, max(40, FRAMES // len(layout_cases)), source)
            wire = [case.carried(number) for number in frame_numbers]
            frames, faults = decoded_one_by_one(case, wire)
            seen_faults |= set(faults)
            check_columns(case, case.view.decode_many(wire, *arguments_of(case)), frames, faults)
            packed = b"".join(wire) if case.layout.in_bytes else numpy.array(frame_numbers, numpy.uint64)
            check_columns(case, case.view.decode_many(packed, *arguments_of(case)), frames, faults)
        assert 0 in seen_faults, name
        assert not layout_cases[0].layout.crc_fields or FAULTS["crc"] in seen_faults, name


@pytest.mark.one_in(2, "exhaustive")
@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_columns_are_what_the_model_says(family: Family) -> None:
    """Compared directly with the model, without the decoder of one frame."""
    source = random.Random(f"model {family.device.name}")
    for layout_cases in by_layout(family).values():
        for case in layout_cases:
            frame_numbers = numbers(case, max(20, FRAMES_OF_THE_MODEL // len(layout_cases)), source)
            wire = b"".join(map(case.carried, frame_numbers)) if case.layout.in_bytes else frame_numbers
            check_columns_with_the_model(case, case.view.decode_many(wire, *arguments_of(case)), frame_numbers)


def check_columns_with_the_model(case: Case, table: Any, frame_numbers: list[int]) -> None:
    device, column_names = case.family.device, {name: python_name(name, CLASS_NAMES) for name in model_names(case)}
    cells_by_field = {name: table[column].tolist() for name, column in column_names.items() if column in table}
    fault_numbers = table.fault.tolist()
    report_cells = {name: column.tolist() for name, column in table.reports.items()}
    verdict_indexes = table.verdict.tolist() if "verdict" in table else None
    for row, number in enumerate(frame_numbers):
        decoded = codec.decode(device, case.placed, number)
        assert fault_numbers[row] == (FAULTS[decoded.problems[0].fault.value] if decoded.problems else 0), hex(number)
        if decoded.problems:
            continue
        decoded_fields = {field.name: field for field in decoded.fields}
        for name, column in cells_by_field.items():
            # A field that an order code lacks is 0 in a column, and missing in the model.
            expected = plain(decoded_fields[name], column[row], numbers_of(case, name)) if name in decoded_fields else 0
            assert column[row] == expected, (case.layout.name, name, hex(number))
        expected_findings = findings(device, case.variant, decoded)
        # Reports with the same words differ only in their names, which the model takes from the field.
        assert sum(column[row] for column in report_cells.values()) == len(expected_findings.reports), hex(number)
        if verdict_indexes is not None:
            assert expected_findings.verdict is [*Verdict][verdict_indexes[row]], hex(number)


def model_names(case: Case) -> list[str]:
    """Return the names of the columns in the model."""
    layout = case.layout
    return [*(field.name for field in layout.fields), *(join.name for join in layout.joins), codec.UNUSED]


def numbers_of(case: Case, name: str) -> dict[str, int]:
    """Return the numbers of the named values of a field. In Gray code, the bits sent are other numbers."""
    fields = (field for field in case.placed.layout.fields if field.name == name)
    return {value.name: value.value for field in fields for value in field.values}


def plain(field: codec.DecodedField, column: object, numbers: dict[str, int]) -> object:
    """Return the value of a field in a column: a choice by its number, text as bytes without trailing zeros."""
    if isinstance(column, bytes) and isinstance(field.value, str):
        return field.value.encode("ascii", "replace").rstrip(b"\0") if field.value.isascii() else column
    return numbers.get(field.value, field.raw) if isinstance(field.value, str) else field.value


def test_lengths_are_a_column_too(families: dict[str, Family]) -> None:
    amm5 = families["amm5"].module
    encoder = amm5.lookup("AMM5A21/65KSC1")
    sound_word = 0x55BCD15E2
    table = encoder.decode_many([sound_word, sound_word | 1 << 45, sound_word << 70, -1, sound_word])
    assert table.fault.tolist() == [0, 1, 1, 1, 0]
    assert table.usable.tolist() == [True, False, False, False, True]
    reply = bytes.fromhex("02 00 15 CD 5B 81")
    serial = amm5.lookup("AMM5A23/65KJP1")
    table = serial.decode_many([reply, reply[:-1], reply + b"x"], amm5.SingleturnReply)
    assert table.fault.tolist() == [0, 1, 1]
    assert table["singleturn"][0] == 6016277


@pytest.mark.parametrize("count", [0, 1, 16_383, 16_384, 16_385, 40_000])
def test_nothing_happens_between_chunks(families: dict[str, Family], count: int) -> None:
    encoder = families["amm5"].module.lookup("AMM5A21/65KSC1")
    words = numpy.full(count, 0x55BCD15E2, numpy.uint64)
    words[::7] ^= numpy.uint64(1)
    table = encoder.decode_many(words)
    assert (table.fault == numpy.where(numpy.arange(count) % 7 == 0, 2, 0)).all()
    assert (table.position == 89902357).all()
    assert table["multiturn"].tolist() == [42] * count


@pytest.mark.parametrize("count", [0, 1, 7, 8, 9, 2_047, 2_048, 2_049, 10_000])
def test_rows_of_every_count(families: dict[str, Family], count: int) -> None:
    """Rows are read eight bytes at a time, so the last ones are read differently."""
    amm5 = families["amm5"].module
    serial = amm5.lookup("AMM5A23/65KJP1")
    for kind in (amm5.DataRequest, amm5.SingleturnReply, amm5.CompleteReply):
        table = kind.decode_many([], *([serial] if "variant" in kind._fields else []))
        assert table.fault.size == 0
    rows = numpy.frombuffer(bytes.fromhex("02 00 C7 D1 6A 7E") * count, numpy.uint8).reshape(-1, 6)
    table = serial.decode_many(rows, amm5.SingleturnReply)
    assert not table.fault.any()
    assert (table["singleturn"] == 7000519).all()
    every_other = numpy.repeat(rows, 2, 0)[::2]
    assert (serial.decode_many(every_other, amm5.SingleturnReply)["singleturn"] == 7000519).all()


def test_numbers_of_any_kind(families: dict[str, Family]) -> None:
    """Values that would overflow or mean something else are refused. Other forms of the same number are accepted."""
    encoder = families["amm5"].module.lookup("AMM5A17/1BG1")
    for kind in (numpy.uint32, numpy.int64, numpy.uint64, ">u4", "<i8"):
        assert encoder.decode_many(numpy.array([5, 70_000], kind)).position.tolist() == [5, 70_000]
    assert encoder.decode_many(numpy.array([5, 7, -1], numpy.int8)).fault.tolist() == [0, 0, 1]
    assert encoder.decode_many(numpy.array([5, 7], "<u8").tobytes()).position.tolist() == [5, 7]
    for not_words in (numpy.array([1.5]), "0101", 5, numpy.zeros((2, 2), int)):
        with pytest.raises(TypeError):
            encoder.decode_many(not_words)
    serial = families["amm5"].module.lookup("AMM5A23/65KJP1")
    with pytest.raises(ValueError, match="expected complete frames of 6 bytes"):
        serial.decode_many(b"1234567", families["amm5"].module.SingleturnReply)
    with pytest.raises(TypeError):
        serial.decode_many(numpy.zeros((2, 6), numpy.int64), families["amm5"].module.SingleturnReply)


def test_counts_go_on_where_the_position_starts_again(families: dict[str, Family]) -> None:
    amm5 = families["amm5"].module
    encoder = amm5.lookup("AMM5A17/1SC1")
    source = random.Random(3)
    at, counts, words = 0, [], []
    for _ in range(20_000):
        at += source.randint(-30_000, 30_000)
        counts.append(at)
        words.append(amm5.SingleCycleData.from_position(encoder, at % encoder.modulus).encode())
    words[500] ^= 4
    counts[500] = counts[499]
    offset = counts[0] - counts[0] % encoder.modulus
    expected, previous = [], None
    unwrapped = encoder.decode_many(words).unwrapped()
    for count in counts:
        position = count % encoder.modulus
        previous = position if previous is None else encoder.unwrap(previous, position)
        expected.append(previous)
        assert previous == count - offset
    assert unwrapped.tolist() == expected


#: Open questions about the frames of an order code.
ANSWERS = {"ASC8525/SC1": {"zero_bit": "LEFT_OUT"}}
UNITS = {
    "AMM5A21/65KSC1": ("turns", "degrees", "radians"),
    "ASC8525/SC1": ("turns", "degrees", "radians"),
    "SMA21-SC1-0050": ("micrometres", "millimetres", "metres"),
}


def answers_of(encoder: Any) -> dict[str, Any]:
    """Return the user's answers to the manual's open questions as arguments."""
    module = import_module(type(encoder).__module__)
    return {name: module.ZeroBit[value] for name, value in ANSWERS.get(encoder.code, {}).items()}


def in_unit(encoder: Any, unit: str, count: int) -> float:
    """Return an unwrapped count in a unit, by the methods of the encoder for positions that it sends."""
    if unit == "turns":
        return count / encoder.counts_per_turn
    is_angle = unit in ("degrees", "radians")
    return getattr(encoder, unit)(count % encoder.counts_per_turn if is_angle else count)


@pytest.mark.parametrize("label", UNITS)
def test_units_are_those_of_one_position(families: dict[str, Family], label: str) -> None:
    """Every number equals the result of the encoder's own method for a position, and an unwrapped count continues."""
    encoder, source = lookup_of(families, label), random.Random(5)
    positions = [source.randrange(encoder.modulus) for _ in range(2_000)]
    answers = answers_of(encoder)
    table = encoder.decode_many(encoder.encode_many({"position": positions}, **answers), **answers)
    counts = table.unwrapped()
    for unit in UNITS[label]:
        method = getattr(encoder, unit)
        assert table.in_units(unit).tolist() == [method(position) for position in positions]
        assert table.in_units(unit, counts).tolist() == [in_unit(encoder, unit, count) for count in counts.tolist()]
    assert table.in_units("counts").tolist() == positions
    other_unit = "metres" if "turns" in UNITS[label] else "turns"
    with pytest.raises((AttributeError, ValueError)):
        table.in_units(other_unit)


@pytest.mark.parametrize("label", UNITS)
def test_velocity_is_the_way_by_the_time(families: dict[str, Family], label: str) -> None:
    """Unwrapped from one usable frame to the next, across the wrap."""
    encoder, source = lookup_of(families, label), random.Random(6)
    unit, per_count = UNITS[label][0], getattr(encoder, UNITS[label][0])(1)
    at, time, counts, times = encoder.modulus - 50, 0.0, [], []
    for _ in range(500):
        at, time = at + source.randint(-90, 100), time + source.choice((0.001, 0.002))
        counts.append(at)
        times.append(time)
    columns = {"position": numpy.array(counts) % encoder.modulus, "error": numpy.arange(500) == 7}
    words = encoder.encode_many(columns, **answers_of(encoder))
    words[[0, 100, 101]] ^= numpy.uint64(1)
    table, last = encoder.decode_many(words, **answers_of(encoder)), None
    velocities, raw = table.velocity(numpy.array(times), unit), table.velocity(numpy.array(times))
    for place, (count, time) in enumerate(zip(counts, times, strict=True)):
        if place in (0, 7, 100, 101):
            assert numpy.isnan(velocities[place])
            continue
        if last is None:
            assert numpy.isnan(velocities[place])
        else:
            assert raw[place] == pytest.approx((count - last[0]) / (time - last[1]), rel=1e-9)
            assert velocities[place] == pytest.approx((count - last[0]) * per_count / (time - last[1]), rel=1e-9)
        last = count, time
    assert numpy.nanmax(numpy.abs(table.velocity(0.001) - numpy.gradient(table.unwrapped()) * 1000)) < 2 * 190_000
    with pytest.raises(ValueError, match="expected 500 times, one per frame, got 3"):
        table.velocity([0, 1, 2])


def test_counts_go_on_from_table_to_table(families: dict[str, Family]) -> None:
    """In pieces, the results are the same as in one table, even if a piece begins with errors or has only errors."""
    encoder, source = lookup_of(families, "AMM5A17/1SC1"), random.Random(7)
    counts = numpy.cumsum([source.randint(-30_000, 60_000) for _ in range(300)])
    words = encoder.encode_many({"position": counts % encoder.modulus})
    words[100:130] ^= numpy.uint64(1)
    expected, previous, pieces = encoder.decode_many(words).unwrapped().tolist(), None, []
    for start in range(0, 300, 20):
        piece = encoder.decode_many(words[start : start + 20]).unwrapped(previous).tolist()
        pieces += piece
        previous = piece[-1]
    assert pieces == expected


def test_a_negative_position_of_a_signed_field(families: dict[str, Family]) -> None:
    """The wide reply has 48 bits in two's complement."""
    sma21 = families["sma21"].module
    encoder = sma21.lookup("SMA21-JP1-0005")
    frames = sma21.WidePositionReply.encode_many({"position": [3, -1]})
    assert encoder.decode_many(frames, sma21.WidePositionReply).unwrapped().tolist() == [3, -1]
    with pytest.raises(ValueError, match="position must be -140737488355328 to 140737488355327, got 140737488355328"):
        encoder.range_of(sma21.WidePositionReply).unwrap(0, 1 << 47)


def lookup_of(families: dict[str, Family], label: str) -> Any:
    return next(family.module.lookup(label) for family in families.values() if label in family.module.VARIANTS)


def test_other_libraries_take_the_columns(families: dict[str, Family]) -> None:
    table = families["amm5"].module.lookup("AMM5A21/65KSC1").decode_many([0x55BCD15E2, 0x55BCD15E3])
    assert [*table.names] == ["singleturn", "multiturn", "error", "warning", "position", "verdict", "fault"]
    assert "1 with an error" in repr(table)
    pandas = pytest.importorskip("pandas", reason="pandas is not installed: to_pandas is not tried")
    column = table.to_pandas()["position"]
    assert column[0] == 89902357
    assert column[1] is pandas.NA, "the second frame has a CRC error"


def test_arrow_takes_the_columns(families: dict[str, Family]) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow is not installed: to_arrow is not tried")
    table = families["amm5"].module.lookup("AMM5A21/65KSC1").decode_many([0x55BCD15E2, 0x55BCD15E3])
    assert table.to_arrow().column("fault").to_pylist() == ["none", "crc"]
    assert table.to_arrow().column("verdict").to_pylist() == ["usable", "not_usable"]


@pytest.mark.parametrize("family", ["amm5"], indirect=True)
def test_what_is_no_frame_and_no_kind_is_refused(family: Family) -> None:
    """A list that contains something other than frames is a mistake in a program, not a frame with an error."""
    amm5 = family.module
    bits, serial = amm5.lookup("AMM5A21/65KSC1"), amm5.lookup("AMM5A23/65KJP1")
    for not_words in (["1"], [5.9], [True]):
        with pytest.raises(TypeError, match="the frame at index 0 must be an integer, got "):
            bits.decode_many(not_words)
    for not_words in ([2, 0, 199], ["02 00 C7 D1 6A 7E"]):
        with pytest.raises(TypeError, match="expected bytes, got "):
            serial.decode_many(not_words, amm5.SingleturnReply)
    kinds = "SingleturnReply, MultiturnReply, EncoderIdReply, CompleteReply, EepromWriteReply, EepromReadReply"
    for kind in ("singleturn_reply", amm5.SsiWord, serial):
        with pytest.raises(TypeError, match=f"is not a kind of frame that this encoder sends; it sends {kinds}$"):
            serial.decode_many(b"", kind)
        with pytest.raises(TypeError, match=kinds):
            serial.encode_many({}, kind)


@pytest.mark.parametrize("family", ["amm5"], indirect=True)
def test_nothing_explains_a_frame_that_cannot_be_told_from_another(family: Family) -> None:
    """Every word of 39 bits is valid here, so valid words of 39 bits do not explain a word of 40."""
    fault = family.module.lookup("AMM5A23/65KBG1").try_decode(1 << 39)
    assert (type(fault).__name__, fault.hint) == ("LengthError", "")
