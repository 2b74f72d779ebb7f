"""Every problem of a line is reported in one run, with its column, the mistake, and what would be right.

A line is untrusted text: any text leads to a message and the exit code 2, and never to a traceback.
"""

from __future__ import annotations

import random
import string

import pytest
from codewheel.commands.cli import main
from codewheel.one_line.line import LineError
from codewheel.one_line.parse import LONGEST, is_line, parse_line
from codewheel.one_line.spec import device_of_line

#: Lines with the columns and messages of their problems.
WRONG = {
    "position=32,error": [
        (1, "the line does not begin with its interface; write biss:, ssi:, spi: or rs485: in front")
    ],
    "bis:position=32": [(1, "'bis' is not an interface; did you mean 'biss'?")],
    "can:position=32": [(1, "'can' is not an interface; write one of: biss, ssi, spi, rs485")],
    "ssi,gray": [
        (9, "there is no colon after 'ssi' and its options; write INTERFACE:FIELD,FIELD, such as biss:position=32"),
    ],
    "ssi:": [(5, "the line has no fields; write INTERFACE:FIELD,FIELD, such as")],
    "ssi:position=32;x": [(16, "';' is not a character of a line; write INTERFACE:FIELD,FIELD, such as")],
    "ssi:position=12,,zero=1": [(17, "a field is missing between two commas; remove one of them")],
    "ssi:9=3": [(5, "'9' is not a name; use letters, digits and underscores, such as position=32")],
    "ssi:positon": [(5, "'positon' has no width; write NAME=BITS for a number, NAME=low or NAME=high for a flag; did")],
    "ssi:position=65": [(14, "'65' is not a width of 'position'; write 1 to 64")],
    "ssi:position=twelve": [(14, "'twelve' is not a width of 'position'; write 1 to 64")],
    "ssi:position=12:unsigned": [
        (17, "'unsigned' does not fit after a width; write signed, or the value of a constant")
    ],
    "ssi:head=4:0x1f": [(12, "0x1f does not fit into 4 bits; write at most 0xf")],
    "ssi:position=4:3": [(16, "'position' is not a constant; give the constant bits another name")],
    "ssi:position=12,error": [(17, "'error' has no active level; write error=low or error=high")],
    "biss:position=12,error=2": [(24, "'error' is one bit; write error=low or error=high")],
    "ssi:position=12,ocf=low:alarm": [(25, "'alarm' is not an effect of a flag; write error, warning or status")],
    "ssi:position=12,zero": [(17, "'zero' takes only a width; write zero=2 for two bits")],
    "ssi:position=12,parity": [(17, "a parity bit is even or odd; write parity=even or parity=odd")],
    "ssi:parity=even,zero=1,head=2:3": [(5, "a parity bit needs other fields that change; add them")],
    "biss:position=12,crc=6": [(18, "a CRC needs its width and polynomial; write crc=BITS:POLYNOMIAL, such as crc=6")],
    "biss:position=12,crc=6:0x44": [
        (24, "'0x44' is not a polynomial of 6 bits; write an odd number of at most 0x7f, with or without its top bit")
    ],
    "biss:position=12,crc=6:0x43:0x40": [(29, "'0x40' is not a start value; write at most 0x3f")],
    "biss:position=12,crc=6:0x43:0:0": [
        (24, "write crc=BITS:POLYNOMIAL:START, and after it :inverted, :plain, :reflected, :low_byte_first or")
    ],
    "ssi:position=12,crc=8:0x107:reflected": [
        (17, "'reflected' is only for a CRC over RS-485, which consists of bytes; remove it")
    ],
    "spi:position=16,crc=16:0x8005:low_byte_first": [
        (17, "'low_byte_first' is only for a CRC over RS-485, which consists of bytes; remove it")
    ],
    "rs485:position=8,crc=8:0x107:0:low_byte_first": [
        (18, "the CRC is one byte, so it has no byte order; remove 'low_byte_first'")
    ],
    "biss:position=12,crc=6:0x43:plain:plain": [(18, "'plain' is written twice; remove one of them")],
    "biss:position=12,crc=6:0x43:plain:inverted": [
        (18, "'inverted' and 'plain' exclude each other; remove one of them")
    ],
    "rs485:position=8,crc=16:0x8005:low_byte_first:high_byte_first": [
        (18, "'low_byte_first' and 'high_byte_first' exclude each other; remove one of them")
    ],
    "biss:crc=6:0x43,position=12": [(6, "the CRC must be the last field; move it to the end")],
    "ssi:a=3,position=4,a=1": [(20, "a second field has the name 'a'; rename one of them")],
    "ssi:position=4,singleturn=3": [
        (5, "'position' is the whole position; write either it, or multiturn and singleturn")
    ],
    "ssi:multiturn=4": [(5, "'multiturn' needs 'singleturn'; add singleturn=BITS")],
    "ssi:singleturn=4,multiturn=4": [(18, "'multiturn' must be before 'singleturn'; swap the two, or write position=")],
    "ssi:position=40,other=30": [(5, "the fields have 70 bits; write 1 to 64")],
    "spi:position=7": [(5, "the fields have 7 bits; write 8 to 64")],
    "rs485:position=8,status=3": [(7, "the fields have 11 bits; over RS-485, write whole bytes")],
    "rs485:n=7,crc=1:1": [(11, "the CRC has 1 bits; over RS-485, write whole bytes")],
    "rs485:position=16": [
        (7, "the byte order of 'position' is not known; write rs485,low_byte_first: or high_byte_first")
    ],
    "ssi,gry:position=12": [(5, "'gry' is not an option; write gray, binary, left, right, low_byte_first,")],
    "ssi,clok=1MHz:position=12": [
        (5, "'clok' is not an option; did you mean 'clock'? (a field belongs after the colon)")
    ],
    "ssi,mode=1:position=12": [(5, "'mode' is not an option of ssi, only of spi; remove it")],
    "ssi,gray=1:position=12": [(9, "'gray' has no value; write only gray")],
    "ssi,clock=fast:position=12": [(11, "'fast' is not a value of 'clock'; write it like clock=1MHz")],
    "spi,mode=4:position=12": [(10, "'4' is not a value of 'mode'; write it like mode=1")],
    "rs485,request=1:position=8": [(15, "'1' is not a value of 'request'; write it like request=1A")],
    "ssi,gray:temperature=12": [(5, "'gray' needs a position; add position=BITS, or remove gray")],
    "ssi,gray:multiturn=4,x=1,singleturn=4": [
        (26, "with gray, 'singleturn' must follow 'multiturn' directly; move the fields between them")
    ],
    "ssi,gray:position=1": [(10, "'position' has one bit, which is the same in Gray code; remove gray")],
    "ssi,gray:position=9:signed": [(10, "'position' is signed, and Gray code is not; remove one of the two")],
    "ssi,gray,counts=360:position=9": [(10, "Gray code with 360 counts (Gray excess) is not supported; remove gray")],
    "ssi,counts=1000:singleturn=12": [(5, "'counts' and 'turns' need a field 'position'; singleturn and multiturn")],
    "ssi,turns=4:position=12": [(5, "'turns' needs the counts per revolution; add counts=NUMBER")],
    "ssi,counts=1000,turns=5:position=12": [
        (5, "1000 counts × 5 turns do not fit into 12 bits; write at most 4096 counts in all")
    ],
    "ssi,counts=1000:position=12:signed": [(5, "a signed position has no counts in a line; remove counts, and add")],
    "spi,low_byte_first:zero=4,position=12": [
        (27, "'position' is not whole bytes, so low_byte_first cannot apply; add zero or unused bits")
    ],
    "spi,low_byte_first:position=16:signed": [
        (20, "'position' is signed or a constant, and cannot be sent low byte first; write its bytes")
    ],
}


def problems(line: str) -> list[tuple[int, str]]:
    with pytest.raises(LineError) as caught:
        device_of_line(line)
    return [(problem.column, problem.message) for problem in caught.value.problems]


@pytest.mark.parametrize("line", WRONG)
def test_problem(line: str) -> None:
    reported = problems(line)
    assert [column for column, _ in reported] == [column for column, _ in WRONG[line]]
    for (_, message), (_, expected) in zip(reported, WRONG[line], strict=True):
        assert message.startswith(expected)


def test_all_problems_in_one_run(capsys: pytest.CaptureFixture[str]) -> None:
    line = "bis,gry:positon,error=3,zero=3:4,crc=3:0x43,parity=1"
    assert main(["decode", line, "0x1"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    places = [text.partition(":")[0] for text in err.splitlines() if text.startswith("column")]
    assert places == [f"column {column}" for column in (1, 5, 9, 23, 25, 40, 45)]
    assert f"column 23: 'error' is one bit; write error=low or error=high\n    {line}\n{' ' * 26}^\n" in err
    assert err.endswith("codewheel: 7 problems in the line\n")


@pytest.mark.parametrize("command", ["decode", "master", "show", "simulate", "new"])
def test_every_command_ends_with_2(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = {"decode": ["x=1", "0x1"], "new": ["my_encoder", "--line", "x=1", "-o", "-"]}.get(command, ["x=1"])
    assert main([command, *arguments]) == 2
    assert "line" in capsys.readouterr().err


def test_a_line_and_an_example(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "my_encoder", "--line", "ssi:position=13", "--like", "ssi", "-o", "-"]) == 2
    assert "--line and --like describe two encoders; leave one of them out" in capsys.readouterr().err


def test_what_is_a_line() -> None:
    assert all(map(is_line, ("biss:position=3", "position=3", " SPI,gray:x", "ssi:")))
    assert not any(map(is_line, ("AMM5A21/65KSC1", "amm5", "KCD-BC03B-1617", "spi", "SSI-13", "ssi13")))


def test_a_long_line() -> None:
    line = "ssi:" + ",".join(f"a{index}=1" for index in range(400))
    assert problems(line) == [(1, f"the line is longer than {LONGEST} characters; shorten it")]
    line = "ssi:" + ",".join(f"a{index}=1" for index in range(66))
    assert (len(line) - len(",a65=1,a64=1") + 1 + len(","), "write at most 64 fields") in problems(line)


def test_hostile_lines() -> None:
    random_numbers = random.Random(3)
    pieces = [*"=:,. _-\0\x1b\u202e\n\t'\"{}[]#&*!|>%@`\\²", "biss", "ssi:", "crc=", "0x", "9" * 30, "low", "signed"]
    pieces += ["position=", "gray", "clock=", *string.ascii_letters[::5], *string.digits]
    for _ in range(3000):
        line = "".join(random_numbers.choices(pieces, k=random_numbers.randrange(1, 30)))
        try:
            parse_line(line)
        except LineError as error:
            assert error.problems
            assert all(1 <= problem.column <= len(error.text) + 1 for problem in error.problems)


def test_valid_lines_with_one_wrong_character() -> None:
    random_numbers = random.Random(5)
    lines = ["biss:position=12,error,warning,crc=6:0x43", "ssi,gray,left:multiturn=4,singleturn=9,error=low"]
    lines += ["spi,mode=1,low_byte_first:position=16,parity=odd,zero=7", "rs485,request=1A:head=8:0x1A,position=8"]
    for _ in range(150):
        line = random_numbers.choice(lines)
        place = random_numbers.randrange(len(line))
        line = line[:place] + random_numbers.choice(string.printable) + line[place + random_numbers.randrange(2) :]
        try:
            device_of_line(line)
        except LineError as error:
            assert error.problems
