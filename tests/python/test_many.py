"""Many frames at once are what each of them is by itself: every layout, frames sound and disturbed."""

from __future__ import annotations

import random
from collections import defaultdict
from typing import Any

import numpy
import pytest
from codewheel.reference import codec
from test_agreement import ALL, KINDS, Case, Family, cases, families, family, given, values_of

__all__ = ["families", "family"]
pytestmark = pytest.mark.slow

#: So many frames of each layout, of all order codes together.
FRAMES = 10_000
FAULTS = {"length": 1, "crc": 2, "constant": 3, "range": 4}


def numbers(case: Case, count: int, source: random.Random) -> list[int]:
    """Frames as numbers: sound ones, ones with a bit or more turned, ones with a right CRC over anything, and noise."""
    bits = case.placed.bits
    kinds = ("zero", "ones", *["random"] * min(count // 8, 30))
    made = [codec.encode(case.family.device, case.placed, values_of(case, kind, source)) for kind in kinds]
    for _ in range(count - len(made)):
        number = source.choice(made[:32])
        for _ in range(source.choice((0, 1, 1, 2, 8))):
            number ^= 1 << source.randrange(bits)
        made.append(source.getrandbits(bits) if source.random() < 0.1 else number)
    return made


def one_by_one(case: Case, wire: list[Any]) -> tuple[list[Any], list[int]]:
    """The frames, None where there is a fault, and the faults."""
    found, faults = [], []
    for item in wire:
        try:
            found.append(case.view.decode(item, *given(case)))
            faults.append(0)
        except ValueError as error:
            found.append(None)
            faults.append(FAULTS[KINDS[type(error).__name__]])
    return found, faults


def agree(case: Case, table: Any, frames: list[Any], faults: list[int]) -> None:
    """Whether the columns are what the frames are one by one."""
    assert table.fault.tolist() == faults, case.layout.name
    sound = [place for place, frame in enumerate(frames) if frame is not None]
    for name in table:
        column = table[name]
        if name in ("fault", "verdict"):
            continue
        if column.dtype.kind == "S":
            texts = [text.decode("ascii", "replace") for text in column[sound].tolist()]
            assert texts == [getattr(frames[place], name).rstrip("\0") for place in sound], name
            continue
        assert column[sound].tolist() == [getattr(frames[place], name) for place in sound], (case.layout.name, name)
    if hasattr(case.view, "verdict"):
        order = [item.name for item in type(frames[sound[0]].verdict)] if sound else []
        expected = [order.index(frame.verdict.name) if frame is not None else 0 for frame in frames]
        assert table.verdict.tolist() == expected, case.layout.name


@pytest.mark.parametrize("family", ALL, indirect=True)
def test_columns_are_what_each_frame_is(family: Family) -> None:
    source = random.Random(family.device.name)
    by_layout: dict[str, list[Case]] = defaultdict(list)
    for case in cases(family):
        if case.register is None:
            by_layout[case.layout.name].append(case)
    assert by_layout
    for name, found in by_layout.items():
        seen: set[int] = set()
        for case in found:
            made = numbers(case, max(40, FRAMES // len(found)), source)
            wire = [case.carried(number) for number in made]
            frames, faults = one_by_one(case, wire)
            seen |= set(faults)
            agree(case, case.view.decode_many(wire, *given(case)), frames, faults)
            packed = b"".join(wire) if case.layout.in_bytes else numpy.array(made, numpy.uint64)
            agree(case, case.view.decode_many(packed, *given(case)), frames, faults)
        assert 0 in seen, name
        assert not found[0].layout.crc_field or FAULTS["crc"] in seen, name


def test_the_reference_agrees(families: dict[str, Family]) -> None:
    """Straight against the model, without the decoder of one frame between."""
    source = random.Random(1)
    case = next(item for item in cases(families["amm5"]) if item.layout.name == "complete_reply")
    sent = [values_of(case, "random", source) for _ in range(500)]
    made = [codec.encode(case.family.device, case.placed, values) for values in sent]
    table = case.view.decode_many([case.carried(number) for number in made], *given(case))
    assert not table.fault.any()
    for name in ("singleturn", "encoder_id", "battery_alarm", "unused"):
        assert table[name].tolist() == [values[name] for values in sent]


def test_lengths_are_a_column_too(families: dict[str, Family]) -> None:
    amm5 = families["amm5"].module
    encoder = amm5.lookup("AMM5A21/65KSC1")
    good = 0x55BCD15E2
    table = encoder.decode_many([good, good | 1 << 45, good << 70, -1, good])
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


def test_numbers_of_any_kind(families: dict[str, Family]) -> None:
    """What would overflow, or stand for something else, is refused; what is the same number is taken."""
    encoder = families["amm5"].module.lookup("AMM5A17/1BG1")
    for kind in (numpy.uint32, numpy.int64, numpy.uint64, ">u4", "<i8"):
        assert encoder.decode_many(numpy.array([5, 70_000], kind)).position.tolist() == [5, 70_000]
    assert encoder.decode_many(numpy.array([5, 7, -1], numpy.int8)).fault.tolist() == [0, 0, 1]
    assert encoder.decode_many(numpy.array([5, 7], "<u8").tobytes()).position.tolist() == [5, 7]
    for wrong in (numpy.array([1.5]), "0101", 5, numpy.zeros((2, 2), int)):
        with pytest.raises(TypeError):
            encoder.decode_many(wrong)
    serial = families["amm5"].module.lookup("AMM5A23/65KJP1")
    with pytest.raises(ValueError, match="no whole frames of 6 bytes"):
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
    found = encoder.decode_many(words).unwrapped()
    for count in counts:
        position = count % encoder.modulus
        previous = position if previous is None else encoder.unwrap(previous, position)
        expected.append(previous)
        assert previous == count - offset
    assert found.tolist() == expected


def test_other_libraries_take_the_columns(families: dict[str, Family]) -> None:
    table = families["amm5"].module.lookup("AMM5A21/65KSC1").decode_many([0x55BCD15E2, 0x55BCD15E3])
    assert [*table] == ["singleturn", "multiturn", "error", "warning", "position", "verdict", "fault"]
    assert "1 with a fault" in repr(table)
    pandas = pytest.importorskip("pandas", reason="pandas is not installed: to_pandas is not tried")
    assert table.to_pandas()["position"].tolist() == [89902357, 89902357]
    assert pandas is not None


def test_arrow_takes_the_columns(families: dict[str, Family]) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow is not installed: to_arrow is not tried")
    table = families["amm5"].module.lookup("AMM5A21/65KSC1").decode_many([0x55BCD15E2, 0x55BCD15E3])
    assert table.to_arrow().column("fault").to_pylist() == [0, 2]
