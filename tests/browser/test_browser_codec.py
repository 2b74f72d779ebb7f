"""The script of the page against manuals, public vectors and the reference codec: in Node, and once in a browser."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browser_harness import Asker, Case, cases, compared
from codewheel.commands.decode.frames import FrameTextError, frame_bytes, frame_number, undecorated
from codewheel.loading.library import load_library
from codewheel.model import Choice, Decimal, Device, Flag, FrameExample, RegisterExample, Text, number_to_bytes
from codewheel.model.limits import bounded, bounds
from codewheel.reference import codec
from codewheel.targets import Library
from codewheel.why.mistakes import explain_bits, explain_bytes
from rust_frames import numbers

pytestmark = pytest.mark.slow

TESTS = Path(__file__).resolve().parents[1]
#: Specs with features that no device has.
MADE_UP = ("specs/words", "specs/bits22", "c/specs/shapes", "c/specs/words", "c/specs/reserved", "c/specs/crcs")
MADE_UP += (
    "specs/gray",
    "specs/lowfirst",
    "specs/ring",
    "specs/ring_turns",
    "specs/scale",
    "specs/signs",
    "specs/wide",
    "specs/long",
    "specs/long_crc",
)
MADE_UP += ("python/specs/odd_shapes", "browser/specs/names")
MADE_UP += ("../examples/encoders/ams/as5047p", "../examples/encoders/cui/amt21", "../examples/encoders/sick/skm36")
MADE_UP += (
    "../examples/encoders/infineon/tle5012b",
    "../examples/encoders/rls/orbis_serial",
    "../examples/encoders/cui/amt22",
)
MADE_UP += ("../examples/encoders/magntek/mt6835", "../examples/encoders/mps/ma732", "../examples/encoders/cui/amt22")
#: The order code of the made-up encoder of 22 bits.
BITS_22 = "T22SC"
FRAMES = 1_000
Ask = Callable[[Library, str], Asker]


def made_up(name: str) -> Library:
    path = TESTS / f"{name}.yaml"
    return Library(load_library([path, path.parent / "manufacturer.yaml"])[0])


def frames(library: Library, count: int) -> list[dict[str, Any]]:
    """Return this many frames of each layout and register, over the order codes that differ."""
    random_ = random.Random("page")
    layouts = [found for device in library.devices for found in cases(device)]
    return [compared(case, count // len(found), random_) for found in layouts for case in found]


def test_frames_and_registers_in_node(node: Asker, library: Library) -> None:
    items = frames(library, FRAMES)
    assert sum(len(item["frames"]) for item in items) > 40 * FRAMES
    assert [wrong for found in node("compared", items) for wrong in found] == []


@pytest.mark.parametrize("name", MADE_UP)
def test_what_no_device_has(name: str, ask: Ask) -> None:
    found = made_up(name)
    assert [wrong for one in ask(found, "node")("compared", frames(found, FRAMES // 2)) for wrong in one] == []


def test_bytes_of_a_word_of_another_length_are_refused(ask: Ask) -> None:
    """The AMT22 has words of 16 and 32 bits. 61ABh is in its data sheet."""
    node = ask(made_up("../examples/encoders/cui/amt22"), "node")
    texts = {
        "encoder:position": ["61 AB", "61 AB C0 00", "61 AB C0"],
        "encoder:position_and_turns": ["61 AB C0 00", "61 AB"],
    }
    items = [
        {"code": "AMT22-14", "sender": sender, "text": text, "answers": {}}
        for sender, given in texts.items()
        for text in given
    ]
    faults = [found["faults"] for found in node("values", items)]
    assert faults == [[], ["length"], ["length"], [], ["length"]]


def test_the_bits_of_a_long_frame(ask: Ask) -> None:
    """It has 70 bits, and two zeros that are not sent fill its first byte."""
    node = ask(made_up("specs/long"), "node")
    item = {"code": "LS", "sender": "encoder", "text": f"0b{5:032b}_{1000:032b}_{3:06b}", "answers": {}}
    (found,) = node("values", [item])
    assert found["faults"] == []
    assert [found["fields"][name] for name in ("multiturn", "singleturn", "status")] == ["5", "1000", "3"]


@pytest.mark.parametrize(
    ("path", "code", "sender", "text", "others"),
    [
        ("cui/amt21", "AMT212B", "encoder", "AB61", ["turns_reply"]),
        ("cui/amt21", "AMT212B", "encoder:turns_reply", "AB61", ["position_reply"]),
        ("cui/amt21", "AMT212B", "encoder", "AB62", []),
        ("sick/skm36", "SKM36", "encoder", "40520000000012", ["type_label_reply"]),
        ("sick/skm36", "SKM36", "encoder:type_label_reply", "40520000000012", []),
        ("ams/as5047p", "AS5047P", "encoder:position", "0x0123", ["register_reply"]),
        ("ams/as5047p", "AS5047P", "master:position_request", "0x1001", ["write_request", "write_data"]),
        ("rls/orbis_serial", "OrbisSerial-14", "encoder", "74 00 00 01 0D", ["temperature_reply"]),
        ("rls/orbis_serial", "OrbisSerial-14", "encoder", "74 00 00 01", []),
        ("tamagawa/ts5700", "TS5700N8401", "encoder", "02 00 12 34 00 24", []),
    ],
)
def test_other_frames_that_it_can_be(path: str, code: str, sender: str, text: str, others: list[str], ask: Ask) -> None:
    """They are those that the command names."""
    node = ask(made_up(f"../examples/encoders/{path}"), "node")
    (found,) = node("values", [{"code": code, "sender": sender, "text": text, "answers": {}}])
    assert found["others"] == others


def test_a_dead_line_over_spi(ask: Ask) -> None:
    """As the command says it: a CRC-8 that starts at 0 is correct if all bits are 0."""
    node = ask(made_up("../examples/encoders/magntek/mt6835"), "node")
    texts = ("0x0", "0b" + "1" * 48, "0x1")
    items = [{"code": "MT6835", "sender": "encoder:angle", "text": text, "answers": {}} for text in texts]
    assert [found["dead"] for found in node("values", items)] == [
        "Every bit is 0. A dead line looks the same, and the CRC is correct too.",
        "Every bit is 1: the line never changes. Check for a broken wire, the supply and the clock.",
        "",
    ]


def test_a_dead_line_over_rs_485(ask: Ask) -> None:
    """There is no clock."""
    node = ask(made_up("../examples/encoders/sick/skm36"), "node")
    items = [{"code": "SKM36", "sender": "encoder:position_reply", "text": "FF " * 7, "answers": {}}]
    assert [found["dead"] for found in node("values", items)] == [
        "Every bit is 1: the line never changes. Check for a broken wire, the supply and wires A and B."
    ]


def test_in_a_browser(ask: Ask, library: Library, vectors: list[dict[str, Any]]) -> None:
    """Return frames, the examples of the manuals and public vectors for one start of the script."""
    devices = (*library.devices, *made_up("specs/bits22").devices)
    asked = ask(Library(devices), "chromium")
    wanted = [*examples(devices), *published(vectors)]
    items = [*frames(library, FRAMES), *(item for item, _ in wanted)]
    answers = asked("answered", items)
    split = len(items) - len(wanted)
    assert [wrong for found in answers[:split] for wrong in found] == []
    for (item, expected), found in zip(wanted, answers[split:], strict=True):
        holds(item, expected, found)


# ------------------------------------------------------------ manuals and public vectors


def examples(devices: tuple[Device, ...]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Return the frames and registers of the worked examples."""
    for device in devices:
        for item in device.examples:
            if isinstance(item, FrameExample):
                text = f"0b{item.bits}" if item.bits else item.bytes.hex(" ")
                asked = {"sender": item.sender, "answers": dict(item.alternatives)}
                expected = {"faults": [item.refused] if item.refused else [], "values": item.values}
                yield {"code": item.order_code, "text": text, **asked}, expected
            if isinstance(item, RegisterExample):
                asked = {"code": item.order_code, "register": item.register, "text": item.bytes.hex(" ")}
                yield asked, {"faults": [], "values": item.values}


def published(vectors: list[dict[str, Any]]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Return the public frames that belong to an encoder here, or to one of 22 bits."""
    as_t_format = {"eeprom_address": "as_t_format"}
    for row in vectors:
        given, text = row["fields"], row["frame_hex_or_bits"]
        if given.get("position_bits") == 22:
            values = {"position": given["position"], "error": given["nE"] == 0, "warning": given["nW"] == 0}
            yield {"code": BITS_22, "sender": "encoder", "text": f"0b{text}"}, {"faults": [], "values": values}
            other = f"0b{int(text, 2) ^ 1 << 6:030b}"
            yield {"code": BITS_22, "sender": "encoder", "text": other}, {"faults": ["crc"], "values": {}}
        elif row["protocol"] == "Tamagawa T-format response, Data ID 0":
            expected = {"faults": [], "values": {"singleturn": given["ABS"]}, "verdict": "not_usable"}
            yield {"code": "AMM5A23/65KJP1", "sender": "encoder", "text": text}, expected
        elif row["protocol"] == "Tamagawa T-format request":
            values = {"address": given["ADF"], **({"data": given["EDF"]} if "EDF" in given else {})}
            asked = {"code": "AMM5A23/65KJP1", "sender": "master", "text": text, "answers": as_t_format}
            yield asked, {"faults": [], "values": values}
        elif row["protocol"] == "Tamagawa control field" and given["data_id"] not in (6, 13):
            yield {"code": "AMM5A23/65KJP1", "sender": "master", "text": text}, {"faults": [], "values": {}}


def holds(item: dict[str, Any], expected: dict[str, Any], found: dict[str, Any]) -> None:
    assert found["faults"][: len(expected["faults"]) or None] == expected["faults"], item
    shown = {
        name: str(value).lower() if isinstance(value, bool) else str(value)
        for name, value in expected["values"].items()
    }
    assert {name: found["fields"][name] for name in shown} == shown, item
    assert found["verdict"] == expected.get("verdict", found["verdict"]), item


def test_examples_and_vectors_are_many(library: Library, vectors: list[dict[str, Any]]) -> None:
    assert len([*examples(library.devices)]) > 30
    assert len([*published(vectors)]) == 2 * 9 + 1 + 3 + 7


def test_examples_and_vectors_in_node(ask: Ask, library: Library, vectors: list[dict[str, Any]]) -> None:
    devices = (*library.devices, *made_up("specs/bits22").devices)
    wanted = [*examples(devices), *published(vectors)]
    answers = ask(Library(devices), "node")("values", [item for item, _ in wanted])
    for (item, expected), found in zip(wanted, answers, strict=True):
        holds(item, expected, found)


# ------------------------------------------------------------ typed text


TEXTS = (
    *("02 00 C7 D1 6A 7E", "0200c7d16a7e", "0x02 0x00", "0x2 0x0", "02,00,C7", "0x0200C7", "2 00", "020", "0x020"),
    *("0xF4243D3", "0b0101", "0B1 0 1", "0b", "0b12", "F4243D3", "0F 42 43 D3", "01 10", "0x01 0x10", "0x01 10"),
    *("0F_42", "", "  ", ",", "xyz", "02 0g", "0x", "-1", "1" * 5000, "0b" + "1" * 4094, "0b" + "1" * 4095),
    *("0x" + "F" * 40, "\t02\n00", "02\u00a000", "\uff10\uff12", "<b>", "${1}", "0xF 0xF", "0X1F", "00"),
)


def test_texts_are_read_as_the_command_reads_them(node: Asker, library: Library) -> None:
    """Return whether a text is valid, and its content. The wording of a refusal differs."""
    device = next(item for item in library.devices if item.name == "am36")
    placed = device.layout("single_cycle_data").place(device.variants[-1].parameters)

    def number(text: str) -> dict[str, Any]:
        read = frame_number(placed, text)
        return {"number": str(read.number), "bits": read.bits, "exact": read.exact}

    for text, answers in zip(TEXTS, node("readings", [{"text": text} for text in TEXTS]), strict=True):
        for read, answer in zip((lambda one: [*frame_bytes(one)], number), answers, strict=True):
            try:
                expected = json.dumps(read(undecorated(text)), separators=(",", ":"))
            except FrameTextError:
                expected = "refused"
            assert answer == expected, text


def test_an_order_code_is_inferred(node: Asker) -> None:
    """The public reply of an AMM5, and the same one with another CRC."""
    texts = ["02 20 C7 D1 6A 5E", "02 20 C7 D1 6A 5F", "hello"]
    reply, wrong, nothing = node("inferred", [{"text": text} for text in texts])
    assert [name for name, _ in reply] == ["singleturn_reply"]
    assert reply[0][1] == [f"AMM5{mount}23/{turns}JP1" for mount in "AB" for turns in ("1", "65K")]
    assert wrong == nothing == []


# ------------------------------------------------------------ registers from values


def rows(case: Case, random_: random.Random) -> Iterator[dict[str, Any]]:
    """Return values of a register: valid ones, or with one of them at or beyond the end of its range."""
    data = [item for item in case.placed.fields if item.field.carries_data]
    for number in numbers(case, 12, random_):
        found = codec.decode(case.device, case.placed, number)
        if found.problems or "\ufffd" in "".join(map(str, found.values.values())):
            continue
        values = {item.name: found.values[item.name] for item in data}
        values |= {
            item.name: entry.raw
            for item in data
            for entry in found.fields
            if entry.name == item.name and isinstance(item.field.kind, Choice)
        }
        yield values
        for item in data:
            if not isinstance(item.field.kind, (Flag, Text)):
                edges = [-1, 0, 1, item.mask, item.mask + 1, item.mask >> 1, -(item.mask >> 1) - 1, item.mask // 3]
                edges += [item.field.kind.limit] if isinstance(item.field.kind, Decimal) else []
                yield {**values, item.name: random_.choice(edges)}


def answer(case: Case, values: dict[str, Any]) -> str:
    """Return the result of the reference for the values of a register: its bytes, or "refused"."""
    register = case.register
    assert register is not None
    try:
        number = codec.encode(case.device, case.placed, values)
    except codec.EncodeError:
        return "refused"
    found = codec.decode(case.device, case.placed, number)
    if found.problems:
        return "refused"
    limits = (register.min, register.max)
    if not register.meanings and limits != (None, None):
        low, high = bounds(register, case.placed, limits, case.variant.parameters)
        if not low <= int(found.values.get(bounded(register), number)) <= high:
            return "refused"
    return number_to_bytes(case.layout, number, case.placed.bits).hex(" ").upper()


def in_json(value: object) -> object:
    """Return a number as text, because JavaScript would round it."""
    return f"{value}n" if isinstance(value, int) and not isinstance(value, bool) else value


@pytest.mark.parametrize("name", ["", "c/specs/shapes", "python/specs/odd_shapes"])
def test_registers_are_made_of_values(name: str, ask: Ask, node: Asker, library: Library) -> None:
    given = made_up(name) if name else library
    random_ = random.Random("registers")
    found = [case for device in given.devices for one in cases(device) for case in one if case.register is not None]
    wanted = [(case, [*rows(case, random_)]) for case in found if not case.register.meanings]
    items = [
        {**case.data, "rows": [{key: in_json(one) for key, one in row.items()} for row in given_rows]}
        for case, given_rows in wanted
    ]
    answers = (ask(given, "node") if name else node)("encoded", items)
    kinds = set()
    for (case, given_rows), one in zip(wanted, answers, strict=True):
        expected = [answer(case, row) for row in given_rows]
        assert one == expected, [(case.placed.name, *pair) for pair in zip(given_rows, one, expected, strict=True)]
        kinds |= {text == "refused" for text in expected}
    assert kinds == {True, False}


# ------------------------------------------------------------ why a CRC is wrong

#: Mistakes that the page explains. Only the command explains the others.
TOLD = {"crc_not_inverted", "start_value", "polynomial_reversed", "bits_in_front", "bits_behind", "first_bit_missing"}
TOLD |= {"last_bits_missing"}


def test_reasons_are_those_of_the_command(node: Asker, library: Library) -> None:
    random_ = random.Random("reasons")
    items, expected = [], []
    for device in library.devices:
        for case in (case for found in cases(device) for case in found[:4] if case.register is None):
            if device.crc_of(case.layout) is None:
                continue
            texts = [*disturbed(case, random_)]
            items.append({**case.data, "frames": texts})
            expected.append([wanted(case, text) for text in texts])
    answers = node("reasons", items)
    for item, one, right in zip(items, answers, expected, strict=True):
        for text, told, known in zip(item["frames"], one, right, strict=True):
            assert sorted(told) == sorted(known), (item["name"], text)
    assert sum(bool(told) for one in answers for told in one) > 100


def disturbed(case: Case, random_: random.Random) -> Iterator[str]:
    """Return frames with the mistakes that the page knows, and with others."""
    for number in numbers(case, 12, random_):
        bits = case.placed.bits
        if case.layout.in_bytes:
            yield case.text(number ^ 0xFF)
            yield case.text(number ^ 0xFF << bits - 8)
            continue
        crc = case.device.crc_of(case.layout)
        assert crc is not None
        yield f"0b{number ^ crc.mask:0{bits}b}"
        yield f"0b1{random_.getrandbits(1)}{number:0{bits}b}"
        yield f"0b{number >> 1:0{bits - 1}b}"
        yield f"0b{number & (1 << bits - 1) - 1:0{bits - 1}b}0"
        yield f"0b{number:0{bits}b}{random_.getrandbits(1)}"
        yield f"0x{number ^ random_.getrandbits(bits):X}"


def wanted(case: Case, text: str) -> list[str]:
    """Return the explanations of the command for these mistakes, each with its chance."""
    if case.layout.in_bytes:
        data = frame_bytes(text)
        found = codec.decode_bytes(case.device, case.variant, case.layout.sender, data)
        if found.layout is None or not {item.fault.value for item in found.problems} & {"crc", "length"}:
            return []
        why = explain_bytes(case.device, case.variant, case.layout.sender, found.layout, data)
    else:
        given = frame_number(case.placed, text)
        found = (
            codec.decode_bits(case.device, case.placed, given.number, given.bits)
            if given.exact
            else codec.decode(case.device, case.placed, given.number)
        )
        if not {item.fault.value for item in found.problems} & {"crc", "length"}:
            return []
        why = explain_bits(case.device, case.variant, case.placed, given)
    assert why is not None
    of_bytes = {"other_polynomial"} if case.layout.in_bytes else set()
    told = [item for item in why.explanations if item.kind in TOLD | of_bytes and not item.twice]
    return [f"{item.text}, 1 of {item.one_in}" for item in told]
