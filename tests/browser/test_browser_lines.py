"""Frames as people paste them: the page and the command line read the same lines, and give the same results."""

from __future__ import annotations

import io
import random
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from browser_harness import Asker, Case
from codewheel.commands.decode.frames import FrameTextError, decode_register_text, decode_text, frame_lines
from codewheel.commands.decode.several_frames import frame_sizes, separate_frames
from codewheel.commands.find_encoder import find_among
from codewheel.order_codes.parameters import RegisterError
from codewheel.targets import Library
from working_tools import require

Ask = Callable[[Library, str], Asker]
ROOT = Path(__file__).resolve().parents[2]
BISS, RS485, SSI, SPI = "AMM5A21/65KSC1", "AMM5A23/65KJP1", "AMM5A21/65KBG1", "AS5047P"
#: Order code, register or nothing, and text.
TEXTS = (
    (BISS, "", "0F 42 43 D3"),
    (BISS, "", "0F:42:43:D3"),
    (BISS, "", "0f-42-43-d3"),
    (BISS, "", "[0x0F, 0x42, 0x43, 0xD3]"),
    (BISS, "", r'"\x0F\x42\x43\xD3"'),
    (BISS, "", r"b'\x0f\x42\x43\xd3'"),
    (BISS, "", "{0x0F, 0x42, 0x43, 0xD3};"),
    (BISS, "", "F4243D3h"),
    (BISS, "", "0xF4243D3"),
    (BISS, "", "0xF4243D3ULL"),
    (BISS, "", "0b" + f"{0xF4243D3:045b}"),
    (BISS, "", "0b" + f"{0xF4243D3:046b}"),
    (BISS, "", "0F4243D3"),
    (BISS, "", "F 42 43 D3"),
    (BISS, "", "0F42 43D3"),
    (SSI, "", "15 66 67 211 1"),
    (SSI, "", "15 66 67 211"),
    (SSI, "", "255 255 255 211 1"),
    (RS485, "", "2 32 199 209 106 94"),
    (RS485, "", "2 32 299 209 106 94"),
    (BISS, "", "0x0F42 0x43D3"),
    (BISS, "", " ".join(f"{0xF4243D3:045b}")),
    (BISS, "", f"{0xF4243D3:045b}"),
    (BISS, "", "0 0 0 0 0 0 0 1"),
    (BISS, "", "0 1 0 1"),
    (BISS, "", "1111 1000010 1000011 11010011"),
    (BISS, "", "0000 1111 0100 0010 0100 0011 1101 0011"),
    (BISS, "", "10 0 11"),
    (BISS, "", "b0101"),
    (BISS, "", "101"),
    (BISS, "", "256000979"),
    (BISS, "", "00256000979"),
    (BISS, "", str(1 << 45)),
    (BISS, "", "9" * 40),
    (BISS, "", "0"),
    (BISS, "", "1" * 41),
    (SSI, "", "256000979"),
    (SSI, "", "9999999999"),
    (BISS, "", "10 11"),
    (BISS, "", "0F 42 4"),
    (BISS, "", "[15, 66, 67, 211]"),
    (BISS, "", "{15, 66, 67, 11}"),
    (BISS, "", "15 66 67 211"),
    (BISS, "", "rx: [15, 66, 67, 11]"),
    (BISS, "", "[0F, 42, 43, D3]"),
    (BISS, "", "[02, 42, 43, 11]"),
    (BISS, "", "[1, 0, 1, 1]"),
    (RS485, "", "[2, 0, 199, 209, 106, 126]"),
    (RS485, "", "(2, 0, 19, 20, 10, 12)"),
    (RS485, "", "2 0 199 209 106 126"),
    (BISS, "", "0F 42 zz"),
    (BISS, "", "0xF4243D2"),
    (BISS, "", "0x1" + "0" * 12),
    (BISS, "", "z" * 100),
    (RS485, "", "02 00 C7 D1 6A 7E"),
    (RS485, "", "02:00:C7:D1:6A:7E"),
    (RS485, "", "02-00-C7-D1-6A-7E"),
    (RS485, "", "02h 00h C7h D1h 6Ah 7Eh"),
    (RS485, "", "[2, 0, 199]"),
    (RS485, "", r"\x02\x00\xC7\xD1\x6A\x7E"),
    (RS485, "", "0x2 0x0 0xC7 0xD1 0x6A 0x7E"),
    (RS485, "", "02 20C"),
    (RS485, "", "022 0C7D16A5E"),
    (RS485, "", "2 20 C7 D1 6A 5E"),
    (RS485, "", "02 20 C7 D1 6A 5"),
    (RS485, "", "2 3 4"),
    (RS485, "", "10 100000 11000111 11010001 1101010 1011110"),
    (RS485, "", "00000010 00100000 11000111 11010001 01101010 01011110"),
    (RS485, "", "0b010111100110101011010001110001110010000000000010"),
    (RS485, "", "10111100110101011010001110001110010000000000010"),
    (RS485, "", "0b0101"),
    (RS485, "", "0b00000010 0b00100000 0b11000111 0b11010001 0b01101010 0b01011110"),
    (RS485, "", "0b10 0b100000 0b11000111 0b11010001 0b1101010 0b1011110"),
    (RS485, "", "0b0101 0b1010"),
    (BISS, "", "0b00001111 0b01000010 0b01000011 0b11010011"),
    (BISS, "", "0b0101 0b1010"),
    (BISS, "", "0b000000000000001111010000100100001111010011 0b0000"),
    (BISS, "", "0000 0000"),
    (BISS, "", "1234 5678 9012 3456"),
    (SSI, "", "12345 6789"),
    (RS485, "", "1 10"),
    (SSI, "", "7FFE"),
    (SSI, "", "8021 97CA FEC5"),
    (RS485, "", ","),
    (RS485, "", "()"),
    (RS485, "", "02 00 C7"),
    (SSI, "", "0x1234"),
    (BISS, "command", "01"),
    (BISS, "command", "01 02"),
    (BISS, "preset", "{0x00, 0x30, 0x24, 0xf4, 0x00, 0x00, 0x00}"),
    (BISS, "preset", "00 30"),
    (BISS, "", "18,52,86,12"),
    (BISS, "", "15,00,43,11"),
    (RS485, "", "2, 16, 19, 20, 10, 12"),
    (RS485, "", "02,10,19,20,10,12"),
    (SSI, "", "18,52,86"),
    (SSI, "", "0,1,2"),
    (SSI, "", "[0, 1, 1]"),
    (RS485, "", "[2, 0, 7, 9, 6, 5]"),
    (RS485, "", "2, 300, 19, 20, 10, 12"),
    (RS485, "", "02 300 1A"),
    (SSI, "", "12 34 56 78 9A"),
    (SSI, "", "00 00 12 34 56"),
    (
        RS485,
        "",
        """\
# captured on the bench

0.000125  02 00 C7 D1 6A 7E
0.000250, 02:20:C7:D1:6A:5E   # an error is active
[12:30:01.5] [0x02, 0x20, 0xC7, 0xD1, 0x6A, 0x5F]
2026-11-25T12:30:02Z;02 00 C7 D1 6A 7E
250 µs\t0200C7D16A7E
3.5 ms zz
10:42:43 02
""",
    ),
    (BISS, "", "0F:42:43:D3\r\n12:00:01 0F:42:43:D3\r\n"),
    (BISS, "", "0x" + "F" * 5000),
)
#: Texts for an encoder whose frames are words of 16 bits.
SPI_TEXTS = (
    "\n".join(("1" * 16, "1" * 15, "1" + "0" * 14)),
    "\n".join(("1" * 15, "1" * 14)),
    "\n".join(("1" * 16, "0" + "1" * 14)),
    "\n".join(("0.1 " + "1" * 16, "0.2 " + "1" * 15, "0.3 zz")),
    "0x7FFE 0x3FFF",
    "{0x7FFEu, 0x3FFF};",
    '["7FFE", "3fff", "FFFF"]',
    "7FFE 3FFF\n0x0123, 0xFFFF # the next access",
    "7F FE",
    "0x7FFE 0x3FF",
    "0x7FFE3FFF",
    "8021 9712",
    "1111111111111111 111111111111101 100000000000001",
    "111111111111110 111111111111101",
    "MISO: 0x7AB3",
    "18:36:58.979 -> 0xC000",
    "7FFE 0x3FFF",
    "0b0111111111111110 0b0011111111111111",
    "0b0111111111111110 0b001111111111111",
    "0b0111_1111_1111_1110 0b001111111111111",
    "0111 1110",
    "1234 5678",
    "32766 16383 65535",
    "1,32766,16383",
    "32766\n16383\n65535",
    "3276\n1638\n6553",
    "3276\n1638\n6553\n3277\n1639\n6554",
    "time,raw\n0.1,32766\n0.2,16383",
    "line;raw\n1;32766\n2;16383\n3;1638\n",
    "1,0x7FFE\n2,0x3FFF\n3,0x3FFF",
    "1,0x7FFE\n2,0x3FFF",
    "1,7F\n2,3F\n3,FF",
    "100\n101\n110\n1010\n1000\n1111\n1000\n1001",
    "time,raw\n7FFE\n3FFF",
    *(
        "\n".join(f"{number * 131}" for number in range(3, 60)),
        "\n".join(f"{number},{number * 131}" for number in range(60)),
    ),
)


def lines_of_command(library: Library, code: str, register: str, text: str) -> list[Any]:
    """Return the results of the command line for the lines of a text."""
    device, match = find_among(library.devices, code)
    case = Case(device, match.variant, None)  # type: ignore[arg-type]

    def one(text: str) -> str:
        try:
            return case.result_text(
                decode_register_text(device, match.variant, register, text)
                if register
                else decode_text(device, match.variant, "encoder", text)
            )
        except (FrameTextError, RegisterError) as error:
            return str(error)

    lines = list(frame_lines(io.StringIO(text, newline=None)))
    sizes = () if register else frame_sizes(device, match.variant, "encoder")
    frames = list(separate_frames(lines, sizes))
    if len(lines) == 1 and len(frames) > 1:
        frames = [frame._replace(number=index) for index, frame in enumerate(frames, 1)]
    return [[frame.number, frame.time, one(frame.text)] for frame in frames]


@pytest.mark.slow
def test_page_and_command_line_say_the_same(node: Asker, library: Library) -> None:
    items = [{"code": code, "register": register, "text": text} for code, register, text in TEXTS]
    for question, answer in zip(items, node("lines", items), strict=True):
        assert answer == lines_of_command(library, question["code"], question["register"], question["text"]), question


@pytest.mark.slow
def test_page_and_command_line_split_the_same_words(ask: Ask, every_encoder: Library) -> None:
    library = Library(tuple(device for device in every_encoder.devices if device.name == "as5047p"))
    items = [{"code": SPI, "register": "", "text": text} for text in SPI_TEXTS]
    answers = ask(library, "node")("lines", items)
    for text, answer in zip(SPI_TEXTS, answers, strict=True):
        assert answer == lines_of_command(library, SPI, "", text), text
    assert [len(answer) for answer in answers] == [
        3,
        2,
        2,
        3,
        2,
        2,
        3,
        4,
        1,
        2,
        1,
        1,
        3,
        1,
        1,
        1,
        *(2, 2, 2, 2, 1, 1, 3, 1, 3, 3, 6, 2, 3, 3, 2, 3, 8, 3, 57, 60),
    ]


@pytest.mark.slow
def test_page_and_command_line_read_the_same_digits(node: Asker, library: Library) -> None:
    """Pieces of digits without a prefix, with other lengths in each text, half of them only of zeros and ones."""
    source = random.Random(48)
    items = []
    for _ in range(600):
        alphabet = source.choice(("01", "01", "0123456789", "0123456789ABCDEF"))
        longest = source.choice((1, 2, 4, 8, 40))
        lengths = [source.randint(1, longest) for _ in range(source.choice((1, 1, 2, 3, 6, 37, 45)))]
        text = " ".join("".join(source.choices(alphabet, k=length)) for length in lengths)
        prefix = source.choice(("", "", "", "0b", "0x"))
        items.append({"code": source.choice((BISS, RS485, SSI)), "register": "", "text": prefix + text})
    for question, answer in zip(items, node("lines", items), strict=True):
        assert answer == lines_of_command(library, question["code"], "", question["text"]), question


@pytest.mark.slow
def test_odd_blanks_and_invisible_characters_are_read_alike(node: Asker, library: Library) -> None:
    """A byte order mark counts as a blank, and messages show invisible characters as escapes."""
    source = random.Random(49)
    frames = ("0F4243D3", "02 20 C7 D1 6A 5E", "0.125 0F 42 43 D3", "256000979", "0x" + "F" * 60, "0F42 43D3 # echo")
    characters = "\ufeff\u00a0\x0c\x0b\x1c\x1f\x85\u2028\u3000\u200b\u00ad\uff10\U0001f600\x00\x1b\t\r\n"
    items = []
    for _ in range(400):
        text = source.choice(frames)
        for _ in range(source.randint(1, 3)):
            place = source.choice((0, len(text), source.randrange(len(text))))
            text = text[:place] + source.choice(characters) + text[place:]
        items.append({"code": source.choice((BISS, RS485, SSI)), "register": "", "text": text})
    for question, answer in zip(items, node("lines", items), strict=True):
        assert answer == lines_of_command(library, question["code"], "", question["text"]), question


@pytest.mark.slow
def test_digits_without_a_prefix_have_each_meaning_that_fits(node: Asker, library: Library) -> None:
    """A debugger prints 0xF4243D3 as 256000979, which is also hex. 9999999999 as hex has more than 37 bits."""
    assert int("256000979") == 0xF4243D3
    both_meanings = "Write 0xF4243D3 if it is decimal, 0x256000979 if it is hex"
    assert (
        lines_of_command(library, BISS, "", "256000979")[0][2]
        == f"'256000979' is not a frame of 45 bits. {both_meanings}"
    )
    assert (
        lines_of_command(library, SSI, "", "256000979")[0][2]
        == f"'256000979' is not a frame of 37 bits. {both_meanings}"
    )
    decimal, hexadecimal = (lines_of_command(library, SSI, "", text)[0][2] for text in ("9999999999", "0x2540BE3FF"))
    assert decimal == hexadecimal
    assert node("unread", [{"text": "256000979"}]) == [f"'256000979' is not a frame. {both_meanings}"]


@pytest.mark.slow
def test_without_an_order_code_a_text_that_is_no_frame_has_the_help(node: Asker) -> None:
    anything = "Write 0b and all bits in the order sent, 0x and hex digits, or the bytes like 02 00 12 34 00 24"
    invalid = "this frame is not valid for any order code"
    digits = "Write 0x9187 if it is decimal, 0x37255 if it is hex"
    expected = {
        "zz": f"'zz' is not a frame. {anything}",
        "0F 42 zz": f"'0F 42 zz' is not a frame. {anything}",
        "37255": f"'37255' is not a frame. {digits}",
        "02 00 C7 D1 6A 7F": invalid,
        "0xF4243D2": invalid,
        "0200": invalid,
        ",": "the frame is empty",
    }
    assert int("37255") == 0x9187
    assert node("unread", [{"text": text} for text in expected]) == list(expected.values())


def test_all_spellings_of_one_frame_are_the_same(library: Library) -> None:
    first = lines_of_command(library, *TEXTS[0])
    assert "verdict\tusable" in first[0][2]
    assert all(lines_of_command(library, *case) == first for case in TEXTS[1:11])


def test_times_are_not_part_of_the_frame(library: Library) -> None:
    lines = lines_of_command(library, *TEXTS[-3])
    times = ["0.000125", "0.000250", "12:30:01.5", "2026-11-25T12:30:02Z", "250 µs", "3.5 ms", "10:42:43"]
    assert [line[1] for line in lines] == times
    assert [line[0] for line in lines] == [3, 4, 5, 6, 7, 8, 9]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("position", "expected_text"), [(-1000, "316.05° of revolution -1"), (-8192, "0.00° of revolution -1")]
)
def test_a_negative_position_has_an_angle_of_its_revolution(position: int, expected_text: str) -> None:
    """-1000 of 8,192 counts is 360° - 43.95° of the revolution before the first one."""
    node = require(["node"])
    text = (ROOT / "runtime" / "browser" / "result.js").read_text(encoding="utf-8")
    functions = text[text.index("function findMeasuredField(") : text.index("/** Create the line about the CRC")]
    frame_result = f'{{ verdict: "usable", placedLayout: {{}}, fields: [{{ name: "position", value: {position}n }}] }}'
    call = f'describeMeasurement({frame_result}, {{ of: "position", counts_per_turn: 8192n, turns: 4096n }})'
    script = f"const ONE = 1n, evaluateExpression = (item) => item;\n{functions}\nconsole.log({call});"
    completed = subprocess.run([node, "-e", script], capture_output=True, text=True, check=True)
    assert completed.stdout == f"position: {expected_text}\n"
