"""The script of the page against manuals, public vectors and the reference codec: in Node, and once in a browser."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import pytest
from browser_harness import Asker, Case, cases, frames_with_checksums, judged_by_command, library_of
from codewheel.commands.cli import main
from codewheel.commands.decode.frames import (
    FrameTextError,
    decode_text,
    frame_bytes,
    frame_number,
    typed_bits,
    undecorated,
)
from codewheel.model import Choice, Decimal, Device, Flag, FrameExample, RegisterExample, Text, number_to_bytes
from codewheel.model.registers import name_with_limits, value_bounds
from codewheel.reference import codec
from codewheel.targets import Library
from codewheel.targets.browser.files import generate
from codewheel.why.diagnosis import Diagnosis, Explanation
from codewheel.why.doubts import other_positions
from codewheel.why.exchanges import own_request
from codewheel.why.explain import explain_bits, explain_bytes, explain_constant
from exhaustive import mostly_exhaustive
from rust_frames import numbers

pytestmark = pytest.mark.slow

#: Specs with features that no device has.
MADE_UP = ("specs/words", "specs/bits22", "c/specs/shapes", "c/specs/words", "c/specs/reserved", "c/specs/crcs")
MADE_UP += (
    "specs/gray",
    "specs/byte_orders",
    "specs/lowfirst",
    "specs/modbus",
    "specs/ring",
    "specs/ring_split",
    "specs/ring_turns",
    "specs/scale",
    "specs/signs",
    "specs/switched",
    "specs/wide",
    "specs/long",
    "specs/long_crc",
)
MADE_UP += ("python/specs/odd_shapes", "browser/specs/names")
MADE_UP += ("../specs/ams/as5047p", "../specs/cui/amt21", "../specs/sick/skm36")
MADE_UP += (
    "../specs/infineon/tle5012b",
    "../specs/rls/orbis_serial",
    "../specs/cui/amt22",
)
MADE_UP += ("../specs/tamagawa/ts5700",)
MADE_UP += ("../specs/magntek/mt6835", "../specs/mps/ma732", "../specs/cui/amt22")
#: Words without a CRC, whose parity bit covers a toggle bit that only some order codes have.
WITH_PARITY = "../specs/trelectronic/c58"
MADE_UP += (WITH_PARITY,)
#: The order code of the made-up encoder of 22 bits.
BITS_22 = "T22SC"
#: Frames of each layout. tests/verify/test_browser.py reads a hundred thousand.
FRAMES, MADE_UP_FRAMES = 100, 500
Ask = Callable[[Library, str], Asker]


def frames(library: Library, count: int) -> list[dict[str, Any]]:
    """Return this many frames of each layout and register, over the order codes that differ."""
    random_ = random.Random("page")
    layouts = [layout_cases for device in library.devices for layout_cases in cases(device)]
    counted = [(case, count // len(layout_cases)) for layout_cases in layouts for case in layout_cases]
    return [frames_with_checksums(case, case_count, random_) for case, case_count in counted]


def test_frames_and_registers_in_node(node: Asker, library: Library) -> None:
    """Fields, CRC, checks, verdict and reports, all of frames.js, are those of the reference."""
    items = frames(library, FRAMES)
    assert sum(len(argument["frames"]) for argument in items) > 40 * FRAMES
    assert [difference for differing in node("compared", items) for difference in differing] == []


@pytest.mark.parametrize("name", mostly_exhaustive(MADE_UP, "c/specs/shapes", "../specs/mps/ma732", WITH_PARITY))
def test_what_no_device_has(name: str, ask: Ask) -> None:
    library = library_of(name)
    answers = ask(library, "node")("compared", frames(library, MADE_UP_FRAMES))
    assert [difference for answer in answers for difference in answer] == []


def test_a_parity_error_names_only_the_bits_of_the_order_code(ask: Ask) -> None:
    node = ask(library_of(WITH_PARITY), "node")
    words = {"C58-25B-E": f"0b{2:026b}", "C58-25B-TE": f"0b{4:027b}"}
    answers = node("lines", [{"code": code, "text": text} for code, text in words.items()])
    problems = [line.split("\t")[-1] for ((_, _, text),) in answers for line in text.splitlines() if "problem" in line]
    assert [problem.partition("parity of ")[2] for problem in problems] == [
        "multiturn, singleturn",
        "multiturn, singleturn, toggle",
    ]


@pytest.mark.parametrize("name", ["", "amm5", "amt21", "icmr", "orbis", "ts5700"])
def test_the_link_of_the_readme_has_a_valid_frame(name: str, library: Library, every_encoder: Library) -> None:
    """The frames are bits with a CRC, a channel of several, and bytes."""
    families = [device for device in every_encoder.devices if device.name == name] or library.devices
    readme = generate(Library(tuple(families)))["browser/README.md"]
    ((order_code, frame),) = re.findall(r"^decode.html#code=(.+)&frame=(.+)$", readme, re.MULTILINE)
    assert main(["decode", order_code, frame]) == 0


def test_bytes_of_a_word_of_another_length_are_refused(ask: Ask) -> None:
    """The AMT22 has words of 16 and 32 bits. 61ABh is in its data sheet."""
    node = ask(library_of("../specs/cui/amt22"), "node")
    texts = {
        "encoder:position": ["61 AB", "61 AB C0 00", "61 AB C0"],
        "encoder:position_and_turns": ["61 AB C0 00", "61 AB"],
    }
    rows = [(sender, text) for sender, layout_texts in texts.items() for text in layout_texts]
    items = [{"code": "AMT22-14", "sender": sender, "text": text, "answers": {}} for sender, text in rows]
    faults = [answer["faults"] for answer in node("values", items)]
    assert faults == [[], ["length"], ["length"], [], ["length"]]


@pytest.mark.parametrize(("path", "code"), [("cui/amt22", "AMT22-14"), ("mps/ma600", "MA600")])
def test_a_word_has_the_layout_of_its_length(path: str, code: str, ask: Ask) -> None:
    """It has the layout that the command gives it: the words have 16 and 32 bits, those of the MA600 also 17."""
    library = library_of(f"../specs/{path}")
    (device,) = library.devices
    variant = next(variant for variant in device.variants if variant.code == code)
    texts = [*(f"0b{1:0{bits}b}" for bits in (15, 16, 17, 32)), "61 AB", "61 AB C0", "61 AB C0 00", "0x61AB", "0x161AB"]
    items = [{"code": code, "sender": "encoder", "text": text, "answers": {}} for text in texts]
    layouts = [answer["layout"] for answer in ask(library, "node")("values", items)]
    decoded_frames = [decode_text(device, variant, "encoder", text) for text in texts]
    assert layouts == [decoded.layout.name for decoded in decoded_frames if decoded.layout is not None]
    assert len(set(layouts)) > 1


def test_the_bits_of_a_long_frame(ask: Ask) -> None:
    """It has 70 bits, and two zeros that are not sent fill its first byte."""
    node = ask(library_of("specs/long"), "node")
    argument = {"code": "LS", "sender": "encoder", "text": f"0b{5:032b}_{1000:032b}_{3:06b}", "answers": {}}
    (answer,) = node("values", [argument])
    assert answer["faults"] == []
    assert [answer["fields"][name] for name in ("multiturn", "singleturn", "status")] == ["5", "1000", "3"]


@pytest.mark.parametrize(
    ("path", "code", "sender", "text", "alternatives"),
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
def test_other_frames_that_it_can_be(
    path: str, code: str, sender: str, text: str, alternatives: list[str], ask: Ask
) -> None:
    """They are the frames that the command names."""
    node = ask(library_of(f"../specs/{path}"), "node")
    (answer,) = node("values", [{"code": code, "sender": sender, "text": text, "answers": {}}])
    assert answer["others"] == alternatives


def test_a_dead_line_over_spi(ask: Ask) -> None:
    """As the command says it: a CRC-8 that starts at 0 is correct if all bits are 0."""
    node = ask(library_of("../specs/magntek/mt6835"), "node")
    texts = ("0x0", "0b" + "1" * 48, "0x1")
    items = [{"code": "MT6835", "sender": "encoder:angle", "text": text, "answers": {}} for text in texts]
    assert [answer["dead"] for answer in node("values", items)] == [
        "every bit is 0. A dead line looks the same, and the CRC is correct too",
        "every bit is 1: the line never changes. Check for a broken wire, the supply and the clock",
        "",
    ]


def test_a_dead_line_over_rs_485(ask: Ask) -> None:
    """There is no clock."""
    node = ask(library_of("../specs/sick/skm36"), "node")
    items = [{"code": "SKM36", "sender": "encoder:position_reply", "text": "FF " * 7, "answers": {}}]
    assert [answer["dead"] for answer in node("values", items)] == [
        "every bit is 1: the line never changes. Check for a broken wire, the supply and wires A and B"
    ]


def test_in_a_browser(ask: Ask, library: Library, vectors: list[dict[str, Any]]) -> None:
    """Return frames, the examples of the manuals and public vectors for one start of the script."""
    devices = (*library.devices, *library_of("specs/bits22").devices)
    runner = ask(Library(devices), "chromium")
    questions = [*examples(devices), *published(vectors)]
    items = [*frames(library, FRAMES), *(question for question, _ in questions)]
    answers = runner("answered", items)
    split = len(items) - len(questions)
    assert [difference for answer in answers[:split] for difference in answer] == []
    for (question, expected), answer in zip(questions, answers[split:], strict=True):
        check_answer(question, expected, answer)


# ------------------------------------------------------------ manuals and public vectors


def examples(devices: tuple[Device, ...]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Return the frames and registers of the worked examples."""
    for device in devices:
        for example in device.examples:
            if isinstance(example, FrameExample):
                text = f"0b{example.bits}" if example.bits else example.bytes.hex(" ")
                selection = {"sender": example.sender, "answers": dict(example.alternatives)}
                expected = {"faults": [example.refused] if example.refused else [], "values": example.values}
                yield {"code": example.order_code, "text": text, **selection}, expected
            if isinstance(example, RegisterExample):
                selection = {"code": example.order_code, "register": example.register, "text": example.bytes.hex(" ")}
                yield selection, {"faults": [], "values": example.values}


def published(vectors: list[dict[str, Any]]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Return the public frames that belong to an encoder here, or to one of 22 bits."""
    as_t_format = {"adf_layout": "as_t_format"}
    for row in vectors:
        fields, text = row["fields"], row["frame_hex_or_bits"]
        if fields.get("position_bits") == 22:
            values = {"position": fields["position"], "error": fields["nE"] == 0, "warning": fields["nW"] == 0}
            yield {"code": BITS_22, "sender": "encoder", "text": f"0b{text}"}, {"faults": [], "values": values}
            with_bit_flipped = f"0b{int(text, 2) ^ 1 << 6:030b}"
            yield {"code": BITS_22, "sender": "encoder", "text": with_bit_flipped}, {"faults": ["crc"], "values": {}}
        elif row["protocol"] == "Tamagawa T-format response, Data ID 0":
            expected = {"faults": [], "values": {"singleturn": fields["ABS"]}, "verdict": "not_usable"}
            yield {"code": "AMM5A23/65KJP1", "sender": "encoder", "text": text}, expected
        elif row["protocol"] == "Tamagawa T-format request":
            values = {"address": fields["ADF"], **({"data": fields["EDF"]} if "EDF" in fields else {})}
            question = {"code": "AMM5A23/65KJP1", "sender": "master", "text": text, "answers": as_t_format}
            yield question, {"faults": [], "values": values}
        elif row["protocol"] == "Tamagawa control field" and fields["data_id"] not in (6, 13):
            yield {"code": "AMM5A23/65KJP1", "sender": "master", "text": text}, {"faults": [], "values": {}}


def check_answer(question: dict[str, Any], expected: dict[str, Any], answer: dict[str, Any]) -> None:
    assert answer["faults"][: len(expected["faults"]) or None] == expected["faults"], question
    expected_values = expected["values"]
    expected_texts = {name: str(value) for name, value in expected_values.items()}
    for name, value in expected_values.items():
        if isinstance(value, bool):
            expected_texts[name] = str(value).lower()
    assert {name: answer["fields"][name] for name in expected_texts} == expected_texts, question
    assert answer["verdict"] == expected.get("verdict", answer["verdict"]), question


def test_examples_and_vectors_are_many(library: Library, vectors: list[dict[str, Any]]) -> None:
    assert len([*examples(library.devices)]) > 30
    assert len([*published(vectors)]) == 2 * 9 + 1 + 3 + 7


def test_examples_and_vectors_in_node(ask: Ask, library: Library, vectors: list[dict[str, Any]]) -> None:
    devices = (*library.devices, *library_of("specs/bits22").devices)
    questions = [*examples(devices), *published(vectors)]
    answers = ask(Library(devices), "node")("values", [question for question, _ in questions])
    for (question, expected), answer in zip(questions, answers, strict=True):
        check_answer(question, expected, answer)


# ------------------------------------------------------------ typed text


TEXTS = (
    *("02 00 C7 D1 6A 7E", "0200c7d16a7e", "0x02 0x00", "0x2 0x0", "02,00,C7", "0x0200C7", "2 00", "020", "0x020"),
    *("0xF4243D3", "0b0101", "0B1 0 1", "0b", "0b12", "F4243D3", "0F 42 43 D3", "01 10", "0x01 0x10", "0x01 10"),
    *("0F_42", "", "  ", ",", "xyz", "02 0g", "0x", "-1", "1" * 5000, "0b" + "1" * 4094, "0b" + "1" * 4095),
    *("0x" + "F" * 40, "\t02\n00", "02\u00a000", "\uff10\uff12", "<b>", "${1}", "0xF 0xF", "0X1F", "00"),
)


def test_texts_are_read_as_the_command_reads_them(node: Asker, library: Library) -> None:
    """Return whether a text is valid, and its content. The wording of a refusal differs."""
    device = next(device for device in library.devices if device.name == "am36")
    placed = device.layout("single_cycle_data").place(device.variants[-1].parameters)

    def number(text: str) -> dict[str, Any]:
        read = frame_number(placed, text)
        bits = {"bits": read.bits, "exact": read.is_length_known, "written": read.digit_bits, "isBytes": read.is_bytes}
        return {"number": str(read.number), **bits}

    for text, answers in zip(TEXTS, node("readings", [{"text": text} for text in TEXTS]), strict=True):
        for read, answer in zip((lambda text: [*frame_bytes(text)], number), answers, strict=True):
            try:
                expected = json.dumps(read(undecorated(text)), separators=(",", ":"))
            except FrameTextError:
                expected = "refused"
            assert answer == expected, text


def test_an_order_code_is_inferred(node: Asker) -> None:
    """The public reply of an AMM5, and the same reply with another CRC."""
    texts = ["02 20 C7 D1 6A 5E", "02 20 C7 D1 6A 5F", "hello"]
    reply, other_crc, nothing = node("inferred", [{"text": text} for text in texts])
    assert [name for name, _ in reply] == ["singleturn_reply"]
    assert reply[0][1] == [f"AMM5{mount}23/{turns}JP1" for mount in "AB" for turns in ("1", "65K")]
    assert other_crc == nothing == []


# ------------------------------------------------------------ registers from values


def rows(case: Case, random_: random.Random) -> Iterator[dict[str, Any]]:
    """Return values of a register: all valid, or one of them at or beyond the end of its range."""
    data = [field for field in case.placed.fields if field.field.carries_data]
    for number in numbers(case, 12, random_):
        decoded = codec.decode(case.device, case.placed, number)
        if decoded.problems or "\ufffd" in "".join(map(str, decoded.values.values())):
            continue
        values = {field.name: decoded.values[field.name] for field in data}
        choices = [field.name for field in data if isinstance(field.field.kind, Choice)]
        values |= {field.name: field.raw for field in decoded.fields if field.name in choices}
        yield values
        for field in data:
            if not isinstance(field.field.kind, (Flag, Text)):
                edges = [-1, 0, 1, field.mask, field.mask + 1, field.mask >> 1, -(field.mask >> 1) - 1, field.mask // 3]
                edges += [field.field.kind.limit] if isinstance(field.field.kind, Decimal) else []
                yield {**values, field.name: random_.choice(edges)}


def answer(case: Case, values: dict[str, Any]) -> str:
    """Return the result of the reference for the values of a register: its bytes, or "refused"."""
    register = case.register
    assert register is not None
    try:
        number = codec.encode(case.device, case.placed, values)
    except codec.EncodeError:
        return "refused"
    decoded = codec.decode(case.device, case.placed, number)
    if decoded.problems:
        return "refused"
    limits = (register.min, register.max)
    if not register.meanings and limits != (None, None):
        low, high = value_bounds(register, case.placed, limits, case.variant.parameters)
        if not low <= int(decoded.values.get(name_with_limits(register), number)) <= high:
            return "refused"
    return number_to_bytes(case.layout, number, case.placed.bits).hex(" ").upper()


def _row_in_json(row: dict[str, Any]) -> dict[str, object]:
    """Return a row with numbers as texts, because JavaScript would round them."""
    numbers_ = {name: f"{value}n" for name, value in row.items() if isinstance(value, int)}
    booleans = {name: value for name, value in row.items() if isinstance(value, bool)}
    return {**row, **numbers_, **booleans}


@pytest.mark.parametrize("name", mostly_exhaustive(["", "c/specs/shapes", "python/specs/odd_shapes"], ""))
def test_registers_are_made_of_values(name: str, ask: Ask, node: Asker, library: Library) -> None:
    tested_library = library_of(name) if name else library
    random_ = random.Random("registers")
    every_case = [case for device in tested_library.devices for cases_ in cases(device) for case in cases_]
    writable = [case for case in every_case if case.register is not None and not case.register.meanings]
    rows_by_case = [(case, [*rows(case, random_)]) for case in writable]
    items = [{**case.data, "rows": [*map(_row_in_json, register_rows)]} for case, register_rows in rows_by_case]
    answers = (ask(tested_library, "node") if name else node)("encoded", items)
    kinds = set()
    for (case, register_rows), answer_texts in zip(rows_by_case, answers, strict=True):
        expected = [answer(case, row) for row in register_rows]
        rows_with_texts = zip(register_rows, answer_texts, expected, strict=False)
        assert answer_texts == expected, (case.placed.name, *rows_with_texts)
        kinds |= {text == "refused" for text in expected}
    assert kinds == {True, False}


# ------------------------------------------------------------ why a CRC is wrong

#: Mistakes that only the command knows, since they name its options.
COMMAND_KINDS = {"other_answer"}
#: A mistake: its text, the number of random frames among which one matches, and what the frame then reads.
Reason = list[Any]
#: Families whose replies over SPI have a CRC, a parity, or bits that are sent during the command.
SPI_REPLIES = ("infineon/tle5012b", "ams/as5048a", "magntek/mt6835")
#: Number of parts in which the cases of all devices are compared. ``make test`` runs one of them.
PARTS = 4


@pytest.mark.parametrize("part", mostly_exhaustive(range(PARTS), 0))
def test_reasons_are_those_of_the_command(part: int, node: Asker, library: Library) -> None:
    compare_reasons(node, [*compared_cases(library, 4)][part::PARTS], 20)


@pytest.mark.parametrize(
    "name", mostly_exhaustive(("infineon/tle5012b", "ams/as5048a", "magntek/mt6835"), "infineon/tle5012b")
)
def test_reasons_over_spi(name: str, ask: Ask) -> None:
    """Requests in the place of a reply, and words without the bits during the command, are among the mistakes."""
    library = library_of(f"../specs/{name}")
    compare_reasons(ask(library, "node"), [*compared_cases(library, 4)], 20)


@pytest.mark.parametrize("name", mostly_exhaustive(MADE_UP, MADE_UP[0], WITH_PARITY))
def test_reasons_for_what_no_device_has(name: str, ask: Ask) -> None:
    library = library_of(name)
    compare_reasons(ask(library, "node"), [*compared_cases(library, 4)], 0)


@pytest.mark.slow
def test_zeros_after_a_command_over_spi(ask: Ask) -> None:
    library = library_of("../specs/infineon/tle5012b")
    case = next(
        case for layout_cases in cases(library.devices[0]) for case in layout_cases if case.layout.name == "angle"
    )
    texts = ["80 21 00 00 00 00", "0x802100000000", "0xCDACFEF6"]
    expected = [expected_explanations(case, text) for text in texts]
    assert [bool(reasons and reasons[0]) for reasons in expected] == [False, False, True]
    assert ask(library, "node")("reasons", [{**case.data, "frames": texts}]) == [expected]


@pytest.mark.slow
def test_a_frame_of_no_bits_is_not_looked_for(ask: Ask) -> None:
    """The data channel TMP of an iC-MR is off for this order code. The page and the command do not explain its bits."""
    library = library_of("../specs/ichaus/icmr")
    (device,) = library.devices
    variant = next(variant for variant in device.variants if variant.code == "iC-MR-0-N6S")
    layout = next(layout for layout in device.interface("biss").layouts if layout.name == "tmp")
    case = Case(device, variant, layout.place(variant.parameters))
    texts = ["0b0", "0b101", "0x1"]
    expected = [expected_explanations(case, text) for text in texts]
    assert expected == [[[], "", False, False, []]] * len(texts)
    assert ask(library, "node")("reasons", [{**case.data, "frames": texts}]) == [expected]


def compared_cases(library: Library, most: int) -> Iterator[Case]:
    """Yield the first cases of each layout, at most this many."""
    for device in library.devices:
        for layout_cases in cases(device):
            yield from filter(is_compared, layout_cases[:most])


def compare_reasons(node: Asker, compared: Sequence[Case], least: int) -> None:
    """Compare page and command on frames with mistakes: the same explanations in the same order."""
    random_ = random.Random("reasons")
    items, expected = [], []
    for case in compared:
        texts = [*disturbed_texts(case, random_)]
        items.append({**case.data, "frames": texts})
        expected.append([expected_explanations(case, text) for text in texts])
    answers = node("reasons", items) if items else []
    for question, answer_lists, expected_lists in zip(items, answers, expected, strict=True):
        for text, reasons, expected_reasons in zip(question["frames"], answer_lists, expected_lists, strict=True):
            if expected_reasons is not None:
                assert reasons == expected_reasons, (question["name"], text)
    assert sum(bool(reasons[0]) for answer in answers for reasons in answer) >= least


@pytest.mark.parametrize("part", mostly_exhaustive(range(PARTS), 0))
def test_several_frames_are_judged_like_the_command_does(part: int, node: Asker, library: Library) -> None:
    """Each group of frames has one of the mistakes that the page knows, twice each."""
    random_ = random.Random("together")
    items, expected = [], []
    for case in [*compared_cases(library, 1)][part::PARTS]:
        frames = [[*disturbed_texts(case, random_)] for _ in range(3)]
        for texts in zip(*frames, strict=False):
            judgement = judged_by_command(case, texts)
            if judgement is not None:
                items.append({**case.data, "frames": list(texts)})
                expected.append(judgement)
    answers = node("together", items)
    for item, answer, judgement in zip(items, answers, expected, strict=True):
        assert answer == judgement, (item["frames"], item["name"])
    assert sum(bool(mistakes) and mistakes[0][1] == 3 for mistakes, *_ in answers) > 20


@pytest.mark.parametrize(
    "name",
    ["", "specs/gray", "../specs/ams/as5047p", "../specs/ams/as5048a", "../specs/mps/ma732", "../specs/magntek/mt6701"],
)
def test_other_positions_are_those_of_the_command(name: str, ask: Ask, library: Library) -> None:
    """Words are written as bits, or as hex bytes with zeros in front. The positions of the master are requests."""
    library = library_of(name) if name else library
    random_ = random.Random("doubts")
    items, expected = [], []
    for device in library.devices:
        for case in (layout_cases[0] for layout_cases in cases(device) if not layout_cases[0].layout.in_bytes):
            texts = [*word_texts(device, case, random_)]
            items.append({**case.data, "frames": texts})
            expected.append([doubts_of(device, case, text) for text in texts])
    answers = ask(library, "node")("doubts", items)
    for item, answer_rows, expected_rows in zip(items, answers, expected, strict=True):
        for text, answer, expected_answer in zip(item["frames"], answer_rows, expected_rows, strict=True):
            assert answer == expected_answer, (item["name"], text)
    assert any(readings for rows in expected for readings, _ in rows)
    has_requests = name.startswith(("../specs/ams", "../specs/mps"))
    assert any(request for rows in expected for _, request in rows) == has_requests


def word_texts(device: Device, case: Case, random_: random.Random) -> Iterator[str]:
    """Return valid words, every second one as hex bytes, and the requests of the same length."""
    bits = case.placed.bits
    for number in numbers(case, 20, random_):
        yield f"0x{number:0{(bits + 15) // 8 * 2}X}" if number % 2 else f"0b{number:0{bits}b}"
    for layout in device.interface(case.variant.interface).layouts:
        request = layout.place(case.variant.parameters)
        if layout.sender == "master" and not layout.in_bytes and request.bits == bits:
            for number in numbers(replace(case, placed=request), 20, random_):
                yield f"0b{number:0{bits}b}"


def doubts_of(device: Device, case: Case, text: str) -> list[Any]:
    """Return other readings of the position, and the request that the word also is."""
    typed_frame = frame_number(case.placed, text)
    decoded = codec.decode(device, case.placed, typed_frame.number)
    readings = other_positions(device, case.variant, decoded, typed_frame)
    request = "" if decoded.problems else own_request(device, case.variant, case.placed, typed_frame.number)
    return [[[text, str(value)] for text, value in readings], request]


def is_compared(case: Case) -> bool:
    """Return False for registers, and for a few bits, where mistakes that only the command knows give the same frame.

    The command explains a CRC over bytes only if it is one byte.
    """
    if case.register is not None or case.placed.bits < 12:
        return False
    crc = case.device.crc_of(case.placed)
    return not case.layout.in_bytes or crc is None or crc.width == 8


def disturbed_texts(case: Case, random_: random.Random) -> Iterator[str]:
    """Return frames with the mistakes that the page knows, and with others."""
    for number in numbers(case, 12, random_):
        bits = case.placed.bits
        if case.layout.in_bytes:
            yield case.text(number ^ 0xFF)
            yield case.text(number ^ 0xFF << bits - 8)
            frame = number_to_bytes(case.layout, number, bits)
            data = frame.hex()
            yield bytes(int(f"{byte:08b}"[::-1], 2) for byte in frame).hex()
            yield data * 2
            yield f"1A{data}"
            yield "1A"
            continue
        crc = case.device.crc_of(case.placed)
        yield f"0b{number ^ (crc.mask if crc is not None else 1):0{bits}b}"
        yield f"0b1{random_.getrandbits(1)}{number:0{bits}b}"
        yield f"0b{number >> 1:0{bits - 1}b}"
        yield f"0b{number & (1 << bits - 1) - 1:0{bits - 1}b}0"
        yield f"0b{number:0{bits}b}{random_.getrandbits(1)}"
        yield f"0x{number ^ random_.getrandbits(bits):X}"
        if bits % 8 == 0 and bits > 16:
            after_command = number & (1 << bits - 16) - 1
            yield f"0x{after_command:0{(bits - 16) // 4}X}"
        if bits > 24:
            first_bytes = number >> bits - 16
            yield f"0x{first_bytes:04X}"
            yield f"0x{first_bytes >> 8:02X} 0x{first_bytes & 0xFF:02X}"
        yield from recorded_texts(f"{number:0{bits}b}", random_)


def recorded_texts(frame: str, random_: random.Random) -> Iterator[str]:
    """Return recordings with a frame: raw buffers of BiSS, complete or not, and words of SSI with extra clocks."""
    yield f"0b010{frame}"
    yield f"0b{frame}{frame}" if random_.getrandbits(1) else f"0b{frame}0{frame[:9]}"
    yield f"0b{frame}{'0' * random_.randrange(1, 9)}"
    yield f"0b{random_.getrandbits(1)}{frame}"
    yield f"0b{'0' * random_.randrange(1, 9)}{frame}"
    yield f"0b1101{random_.getrandbits(1)}{frame[:-1]}"
    yield f"0b{random_.getrandbits(7):07b}{frame}{random_.getrandbits(9):09b}"
    ends = f"{'1' * random_.randrange(5)}{'0' * random_.randrange(1, 9)}1{random_.getrandbits(1)}{frame}0"
    whole = f"{ends}{'0' * (-len(ends) % 8)}"
    yield f"0x{int(whole, 2):0{len(whole) // 4}X}"


def expected_explanations(case: Case, text: str) -> list[Any] | None:
    """Return the explanations of the command, or None if only the command explains the frame.

    They come with the missing part, with whether a CRC can contradict the frame and whether another frame helps, and
    with the bits that may be disturbed.
    """
    why = why_of(case, text)
    if why is None:
        return [[], "", False, False, []]
    single_kinds = {mistake.kind for mistake in why.explanations if not mistake.needs_two_mistakes}
    if single_kinds & COMMAND_KINDS and single_kinds <= COMMAND_KINDS | {"frame_inside"}:
        return None
    page_why = of_page(why)
    reasons = [reason(mistake) for mistake in page_why.explanations]
    return [
        reasons,
        why.missing_part,
        bool(reasons) and why.has_crc,
        page_why.needs_another_frame,
        [*why.bits_to_invert],
    ]


def why_of(case: Case, text: str, *, with_pairs: bool = False) -> Diagnosis | None:
    """Return the explanations of the command."""
    if case.layout.in_bytes:
        data = frame_bytes(text)
        decoded = codec.decode_bytes(case.device, case.variant, case.layout.sender, data)
        faults = {problem.fault.value for problem in decoded.problems}
        if decoded.layout is not None and not faults & {"crc", "length", "constant"}:
            return None
        sender = case.layout.sender
        return explain_bytes(case.device, case.variant, sender, decoded.layout, data, with_pairs=with_pairs)
    frame = typed_bits(case.device, case.placed, text)
    decoded = (
        codec.decode_bits(case.device, case.placed, frame.number, frame.bits)
        if frame.is_length_known
        else codec.decode(case.device, case.placed, frame.number)
    )
    faults = {problem.fault.value for problem in decoded.problems}
    is_dead = frame.number in (0, (1 << case.placed.bits) - 1)
    if faults & {"crc", "length"} or is_dead:
        is_valid = not faults
        return explain_bits(case.device, case.variant, case.placed, frame, is_valid=is_valid, with_pairs=with_pairs)
    if "constant" in faults:
        return explain_constant(case.device, case.variant, case.placed, frame)
    return None


def of_page(why: Diagnosis) -> Diagnosis:
    """Return the explanations with the mistakes that the page knows. It shows a dead line separately."""

    def known(mistakes: tuple[Explanation, ...]) -> tuple[Explanation, ...]:
        return tuple(mistake for mistake in mistakes if mistake.kind not in COMMAND_KINDS | {"line_stuck"})

    return replace(why, explanations=known(why.explanations), all_explanations=known(why.all_explanations))


def reason(mistake: Explanation) -> Reason:
    readings = (mistake.numbers_read, *mistake.other_numbers_read)
    reads = [f"{name} {value}" for numbers in readings for name, value in numbers.items()]
    return [mistake.text, str(mistake.one_in), reads, [" ".join(part) for part in mistake.recording_parts]]
