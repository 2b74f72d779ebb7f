"""BiSS and SSI frames of more than 64 bits in C, from the bits on the line to the values.

The lines are drawn here bit by bit, as in the protocol description of BiSS C (p. 3), and the CRC is a long division.
"""

from __future__ import annotations

import random
import shutil
import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
from c_harness import SANITIZED, SPECS, WARNINGS, devices_of, write
from exhaustive import mostly_exhaustive
from working_tools import require

pytestmark = pytest.mark.slow

#: Fields of each order code with their widths, most significant first, and the interface.
FIELDS = {
    "WB": ("biss", {"multiturn": 32, "singleturn": 32, "error": 1, "warning": 1, "life": 6}),
    "LB": ("biss", {"multiturn": 32, "singleturn": 32, "error": 1, "warning": 1, "life": 3}),
    "WS": ("ssi", {"multiturn": 32, "singleturn": 32, "first": 7, "speed": 33, "life": 8}),
    "LS": ("ssi", {"multiturn": 32, "singleturn": 32, "status": 6}),
    "CB": ("biss", {"multiturn": 32, "singleturn": 32, "error": 1, "warning": 1}),
    "CS": ("ssi", {"multiturn": 32, "singleturn": 32, "status": 3}),
}
BITS = {"WB": 88, "LB": 85, "WS": 128, "LS": 70, "CB": 72, "CS": 79}
#: Polynomial of each CRC with its top bit, and what its bits are XORed with.
CRCS = {**dict.fromkeys(("WB", "LB", "WS"), (0x190D9, 0xFFFF)), "CB": (0x43, 0x3F), "CS": (0x180F, 0)}
FAMILIES = ("wide", "long", "long_crc")
#: The macro of the bytes in a frame.
LENGTHS = {
    "WB": "TEST_WIDE_BISS_WORD_LENGTH",
    "LB": "TEST_LONG_BISS_SINGLE_CYCLE_DATA_LENGTH",
    "WS": "TEST_WIDE_SSI_SSI_WORD_LENGTH",
    "LS": "TEST_LONG_SSI_SSI_WORD_LENGTH",
    "CB": "TEST_LONG_CRC_BISS_SINGLE_CYCLE_DATA_LENGTH",
    "CS": "TEST_LONG_CRC_SSI_SSI_WORD_LENGTH",
}
LINE_HIGH, LINE_LOW, NO_START = 8, 9, 10
OK, LENGTH, CRC, CONSTANT = range(4)

#: Receive one buffer for each line of input, and print the results and the numbers of the frame.
PROGRAM = """
#include <stdio.h>
{includes}
static int read_bytes(uint8_t *rx, size_t size)
{{
    size_t at;
    for (at = 0U; at < size; at++) {{
        unsigned int byte;
        if (scanf("%2x", &byte) != 1) {{
            return 0;
        }}
        rx[at] = (uint8_t)byte;
    }}
    return 1;
}}

int main(void)
{{
    char code[3];
    while (scanf("%2s", code) == 1) {{
{cases}    }}
    return 0;
}}
"""
CASE = """        if ((code[0] == '{first}') && (code[1] == '{second}')) {{
            uint8_t rx[{stem}_RX_BYTES];
            uint8_t bytes[{length}];
            {name}_frame frame;
            uint64_t position = 0U;
            cw_result result = CW_FAULT_RANGE;
            if (read_bytes(rx, sizeof(rx)) == 0) {{
                return 1;
            }}
            result = {upper}_RECEIVE({code}, rx, bytes);
            printf("%d", (int)result);
            if (result == CW_OK) {{
                result = {name}_decode({stem}, bytes, sizeof(bytes), &frame);
                printf(" %d", (int)result);
            }}
            if (result == CW_OK) {{
                const cw_verdict verdict = {name}_position({stem}, bytes, sizeof(bytes), &position);
                printf(" %d %llu {forms}", (int)verdict, (unsigned long long)position, {members});
            }}
            printf("\\n");
        }}
"""


def with_crc(code: str, word: int) -> int:
    """Append the CRC, if there is one, by long division."""
    polynomial, inverted = CRCS.get(code, (1, 0))
    width = polynomial.bit_length() - 1
    remainder = word << width
    while width and remainder >> width:
        remainder ^= polynomial << (remainder.bit_length() - 1 - width)
    return word << width | (remainder ^ inverted if width else 0)


def bits_of(number: int, width: int) -> list[int]:
    return [number >> place & 1 for place in range(width - 1, -1, -1)]


def family(code: str) -> str:
    return {"W": "wide", "L": "long", "C": "long_crc"}[code[0]]


def case(code: str) -> str:
    interface, fields = FIELDS[code]
    name = f"test_{family(code)}_{interface}"
    return CASE.format(
        first=code[0],
        second=code[1],
        code=code,
        name=name,
        upper=name.upper(),
        stem=f"{name.upper()}_{code}",
        length=LENGTHS[code],
        forms=" ".join(["%lld"] * len(fields)),
        members=", ".join(f"(long long)frame.{field}" for field in fields),
    )


def size_of(code: str) -> int:
    """Return the bytes of a buffer: the bits of the frame and those around it."""
    return (BITS[code] + (2 + 40 + 3 if FIELDS[code][0] == "biss" else 2) + 7) // 8


def hexadecimal(code: str, line: list[int]) -> str:
    """Return a buffer whose last bits are 1, as after the timeout."""
    whole = [*line, *[1] * (8 * size_of(code))][: 8 * size_of(code)]
    return f"{code} {int(''.join(map(str, whole)), 2):0{2 * size_of(code)}X}"


def line_bits(code: str, frame: list[int], rest_bits: int = 3, acknowledge: int = 7, after: int = 0) -> list[int]:
    """Return the data line: high, then for BiSS the acknowledge, start bit and CDS, then the frame and a 0."""
    if FIELDS[code][0] == "ssi":
        return [1, *frame, after]
    return [*[1] * rest_bits, *[0] * acknowledge, 1, 0, *frame, after]


def frames_of(code: str, count: int) -> Iterator[tuple[dict[str, int], list[int]]]:
    """Yield the raw fields of a frame, and its bits in the order sent."""
    chance = random.Random(code)
    for turn in range(count):
        word, raw = 0, {}
        for name, width in FIELDS[code][1].items():
            raw[name] = (0, (1 << width) - 1)[turn] if turn < 2 else chance.getrandbits(width)
            word = word << width | raw[name]
        yield raw, bits_of(with_crc(code, word), BITS[code])


@pytest.fixture(scope="module")
def include(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("long"), devices_of(*(SPECS / f"{family}.yaml" for family in FAMILIES)))


@pytest.fixture(
    scope="module",
    params=mostly_exhaustive(
        ["gcc -std=c99", "clang -std=c99", "g++ -x c++ -std=c++11", "clang++ -x c++ -std=c++17"], "gcc -std=c99"
    ),
)
def program(request: pytest.FixtureRequest, include: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("program")
    headers = "".join(f'#include "test/{family}_{kind}.h"\n' for family in FAMILIES for kind in ("biss", "ssi"))
    source = folder / "program.c"
    source.write_text(PROGRAM.format(includes=headers, cases="".join(map(case, FIELDS))))
    executable = folder / "program"
    command = [*request.param.split(), "-O1", *WARNINGS, *SANITIZED, f"-I{include}", str(source), "-o", str(executable)]
    require(command)
    subprocess.run(command, check=True)
    return executable


def answers(program: Path, lines: list[str]) -> list[list[int]]:
    completed = subprocess.run([str(program)], input="\n".join(lines), capture_output=True, text=True, check=True)
    return [[*map(int, line.split())] for line in completed.stdout.splitlines()]


def _expected_verdict(values: Mapping[str, int]) -> int:
    if "error" not in values:
        return 1
    if values["error"]:
        return 0
    return 2 if values["warning"] else 3


@pytest.mark.parametrize("code", FIELDS)
def test_a_frame_from_the_line(code: str, program: Path) -> None:
    chance = random.Random(code)
    frames = list(frames_of(code, 200))
    received_lines = []
    for _, frame_bits in frames:
        levels = line_bits(code, frame_bits, chance.randint(1, 5), chance.randint(1, 37))
        received_lines.append(hexadecimal(code, levels))
    for (sent_values, _), answer in zip(frames, answers(program, received_lines), strict=True):
        expected_values = dict(sent_values)
        if "error" in expected_values:
            expected_values |= {"error": 1 - sent_values["error"], "warning": 1 - sent_values["warning"]}
        if "speed" in expected_values:
            expected_values["speed"] -= (sent_values["speed"] >> 32) << 33
        verdict = _expected_verdict(expected_values)
        position = 0 if verdict == 0 else sent_values["multiturn"] << 32 | sent_values["singleturn"]
        assert answer == [OK, OK, verdict, position, *expected_values.values()]


@pytest.mark.parametrize("code", FIELDS)
def test_each_fault_of_a_line(code: str, program: Path) -> None:
    (*_, (_, frame_bits)) = frames_of(code, 5)
    faulty_lines_by_result = {
        LINE_HIGH: [[1] * 8 * size_of(code)],
        LINE_LOW: [[0, *line_bits(code, frame_bits)[:-1]]],
        CONSTANT: [line_bits(code, frame_bits, after=1)],
    }
    if FIELDS[code][0] == "biss":
        faulty_lines_by_result[NO_START] = [[1, *[0] * 8 * size_of(code)]]
        faulty_lines_by_result[LENGTH] = [line_bits(code, frame_bits, 1, 8 * size_of(code) - BITS[code] - 2)]
    expected_and_line = []
    for result, faulty_lines in faulty_lines_by_result.items():
        expected_and_line += [(result, hexadecimal(code, line)) for line in faulty_lines]
    assert answers(program, [text for _, text in expected_and_line]) == [[result] for result, _ in expected_and_line]


@pytest.mark.parametrize("code", CRCS)
def test_each_wrong_bit_is_a_wrong_crc(code: str, program: Path) -> None:
    (*_, (_, frame_bits)) = frames_of(code, 5)
    wrong_lines = []
    for wrong_bit in range(BITS[code]):
        wrong_frame_bits = [bit ^ (wrong_bit == bit_index) for bit_index, bit in enumerate(frame_bits)]
        wrong_lines.append(hexadecimal(code, line_bits(code, wrong_frame_bits)))
    assert answers(program, wrong_lines) == [[OK, CRC]] * BITS[code]


@pytest.mark.parametrize("code", FIELDS)
def test_an_array_of_another_size_does_not_compile(code: str, include: Path, tmp_path: Path) -> None:
    name = f"test_{family(code)}_{FIELDS[code][0]}"
    stem = f"{name.upper()}_{code}"
    for arrays, sound in [
        (f"uint8_t rx[{stem}_RX_BYTES]; uint8_t bytes[{LENGTHS[code]}];", True),
        (f"uint8_t rx[{stem}_RX_BYTES]; uint8_t bytes[{LENGTHS[code]} - 1U];", False),
        (f"uint8_t rx[{stem}_RX_BYTES - 1U]; uint8_t bytes[{LENGTHS[code]}];", False),
    ]:
        text = f'#include "test/{family(code)}_{FIELDS[code][0]}.h"\n'
        text += f"int main(void) {{ {arrays} rx[0] = 0U; return (int){name.upper()}_RECEIVE({code}, rx, bytes); }}\n"
        (tmp_path / "text.c").write_text(text)
        command = ["gcc", "-std=c99", "-Werror", "-fsyntax-only", f"-I{include}", str(tmp_path / "text.c")]
        assert (subprocess.run(command, capture_output=True).returncode == 0) is sound, arrays


def test_the_example_of_an_interface_with_words_and_bytes(tmp_path: Path) -> None:
    """The program shows the first frame, which is a word. The bytes of the second one have the macro of a length."""
    shutil.copy(SPECS / "manufacturer.yaml", tmp_path)
    text = (SPECS / "long.yaml").read_text(encoding="utf-8")
    at = text.index("      - name: ssi_word\n")
    short = (
        text[at : text.index("measurement:")]
        .replace("ssi_word", "ssi_short")
        .replace("          - {name: status, bits: 6}\n", "")
    )
    short = short.replace("        carried_as: bytes\n        byte_order: high_byte_first\n", "")
    long = text[at:].replace("ssi_word\n", "ssi_word\n        note: The master sends more clocks for it.\n", 1)
    (tmp_path / "long.yaml").write_text(text[:at] + short + long, encoding="utf-8")
    include = write(tmp_path, devices_of(tmp_path))
    header = " ".join((include / "test" / "long_ssi.h").read_text(encoding="ascii").replace("\n * ", " ").split())
    assert "Lengths for receive.h and receive_frame.h by order code: bits in ssi_short, ssi_word" in header
    assert "If your SSI master gives you a number, call test_long_ssi_ssi_short_position." in header
    for program in sorted((tmp_path / "c" / "examples").glob("*.c")):
        command = ["gcc", "-std=c99", *WARNINGS, "-Werror", f"-I{include}", str(program), "-o", str(tmp_path / "made")]
        subprocess.run(command, check=True)
        assert subprocess.run([tmp_path / "made"], capture_output=True).returncode == 0
