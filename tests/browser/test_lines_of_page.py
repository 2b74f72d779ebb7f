"""The page builds the same record from a line as codewheel does, and finds the same problems in a wrong line."""

from __future__ import annotations

import json
import random
import re
import string
from typing import Any

import pytest
from browser_harness import Asker
from codewheel.one_line.line import LineError
from codewheel.one_line.spec import device_of_line
from codewheel.targets.browser.files import family_data

pytestmark = pytest.mark.slow

FIELDS = [
    *(
        "position=12",
        "position=16",
        "position=24:signed",
        "position=52",
        "singleturn=13",
        "singleturn=16",
        "multiturn=12",
    ),
    *(
        "error",
        "warning",
        "error=low",
        "warning=high",
        "ocf=low",
        "lin=high:warning",
        "mag=high:error",
        "x=high:status",
    ),
    *("zero=3", "unused=2", "zero=1", "unused=5", "parity=even", "parity=odd", "temp=8:signed", "head=4:0xa", "life=6"),
    *("crc=6:0x43", "crc=8:0x7:0xff:inverted", "crc=16:0x190d9:plain", "crc=8:0x101", "crc=32:0x80000001", "crc=5:5:7"),
    *("crc=16:0x8005:0xffff:reflected:low_byte_first", "crc=32:0x4c11db7:high_byte_first:reflected:inverted"),
    *("id=8", "Pos_X=5", "head_2=53:0x10000000000001", "n__m=3", "status=8"),
]
OPTIONS = [
    *("gray", "binary", "left", "right", "low_byte_first", "high_byte_first", "clock=1MHz", "clock=2.5kHz", "mode=3"),
    *("baud=9600", "request=1A", "request=1A02", "counts=1000", "counts=4096", "turns=4", "turns=65536"),
]


def random_line(random_numbers: random.Random) -> str:
    interface = random_numbers.choice(["biss", "ssi", "spi", "rs485"])
    options = random_numbers.sample(OPTIONS, random_numbers.choice([0, 0, 1, 2]))
    fields = random_numbers.sample(FIELDS, random_numbers.choice([1, 2, 3, 4, 5]))
    # Lines are seldom valid unless the CRC comes last.
    fields.sort(key=lambda field: field.startswith("crc"))
    return f"{','.join([interface, *options])}:{','.join(fields)}"


def mutated(line: str, random_numbers: random.Random) -> str:
    place = random_numbers.randrange(len(line))
    return line[:place] + random_numbers.choice(string.printable) + line[place + random_numbers.randrange(2) :]


def expected(line: str) -> Any:
    """Return the record of a line, or its problems, as JSON."""
    try:
        device, _ = device_of_line(line)
    except LineError as error:
        return {"problems": [tuple(problem) for problem in error.problems]}
    data = json.loads(json.dumps(family_data(device)))
    del data["labels"]
    return data


def without_hint(message: str) -> str:
    """Return a message about an unknown word without the nearest words, which the page does not look for."""
    message = re.sub(r" is not an option.*", " is not an option", message)
    message = re.sub(r" is not an interface.*", " is not an interface", message)
    return re.sub(r"(has no width; write NAME=BITS for a number, NAME=low or NAME=high for a flag);.*", r"\1", message)


def problem_set(problems: list[tuple[int, str]]) -> set[tuple[int, str]]:
    return {(column, without_hint(message)) for column, message in problems}


def compare(node: Asker, lines: list[str]) -> int:
    """Compare the page with codewheel, and return the number of valid lines."""
    (answers,) = node("records", [{"texts": lines}])
    valid = 0
    for line, answer in zip(lines, answers, strict=True):
        wanted = expected(line)
        if "problems" in answer:
            assert problem_set(answer["problems"]) == problem_set(wanted["problems"]), line
        else:
            assert answer == wanted, line
            valid += 1
    return valid


def test_random_lines(node: Asker) -> None:
    random_numbers = random.Random(500)
    assert compare(node, [random_line(random_numbers) for _ in range(1500)]) > 300


def test_wrong_lines(node: Asker) -> None:
    random_numbers = random.Random(501)
    compare(node, [mutated(random_line(random_numbers), random_numbers) for _ in range(800)])
    long_line = "ssi:" + ",".join(f"a{index}=1" for index in range(400))
    compare(node, ["", ":", "ssi", "ssi,gray", "can:x=1", "x=1", " spi : a = 9 ", long_line, long_line[:400]])


def test_lines_at_the_limits(node: Asker) -> None:
    """The lowest and the highest clock, and the longest fields, names, numbers and lines."""
    clocks = ("0.5", "0.999999", "1", "0.001k", "0.0009k", "1000000000", "1000000000.4", "1000.000001M", "999999999999")
    lines = [f"ssi,clock={clock}:position=12" for clock in clocks]
    for interface in ("biss", "ssi", "spi", "rs485,low_byte_first", "rs485,high_byte_first"):
        lines += [f"{interface}:position={bits}" for bits in (1, 7, 8, 63, 64, 65)]
        lines += [f"{interface}:position=8,{'a' * length}=8" for length in (39, 40, 41)]
        lines += [
            f"{interface}:" + ",".join(f"a{index}={width}" for index in range(count))
            for count, width in ((64, 1), (65, 1), (16, 64), (17, 64))
        ]
        lines += [f"{interface}:position=8,crc={bits}:{1 << bits | 1:#x}:{(1 << bits) - 1}" for bits in (8, 31, 32, 33)]
    lines += [
        f"ssi,counts={counts},turns={turns}:position=64"
        for counts, turns in (
            (1 << 63, 1),
            ((1 << 63) - 1, 2),
            ((1 << 63) - 1, 3),
            (1 << 32, 1 << 32),
            (99999999999999999999, 1),
        )
    ]
    lines += [
        "ssi:head=64:0x1" + "0" * 15,
        "ssi:head=64:0x0" + "f" * 16,
        "ssi:head=64:0b" + "1" * 65,
        "ssi:x=64:0x" + "f" * 18,
    ]
    lines += [f"ssi,counts={counts}:position=20" for counts in (1, 3, 7, 15, 255, 4095, 4096)]
    lines += ["ssi,counts=4096,turns=4095:position=24"]
    lines += [f"rs485,request={'1A' * count}:position=8" for count in (1, 8, 9)]
    assert compare(node, lines) > 20


def test_a_line_decodes_in_place_of_a_label(node: Asker) -> None:
    # The labelled real capture of tests/vectors.json.
    line, text = "biss:position=22,error,warning,crc=6:0x43", "0b000010111011111100101011011100"
    (answer,) = node("values", [{"code": line, "sender": "encoder", "text": text}])
    assert (answer["fields"]["position"], answer["verdict"], answer["faults"]) == ("192458", "usable", [])
    (labels,) = node("labels", [{"texts": [line, "ssi:position"]}])
    assert labels[0][1] == line
    assert labels[1].startswith("column 5: 'position' has no width")
