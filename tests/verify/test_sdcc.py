"""Small C compiler SDCC: the code that reads a position compiles for MCS-51 and STM8, and is right in simulators."""

from __future__ import annotations

import random
import re
import subprocess
from pathlib import Path

import pytest
from codewheel.targets import Library
from codewheel.targets.c.files import generate
from tools import tool
from tree import library

#: SDCC passes arguments of functions that call each other in fixed places, unless they are on a stack.
PROCESSORS = {"mcs51": ["-mmcs51", "--model-large", "--stack-auto"], "stm8": ["-mstm8"]}
#: SDCC inlines every function that may be, so that the code of the receivers would be repeated.
NOT_INLINED = "-Dinline="
#: The simulator of each, what places a variable, and the memory that it is in.
SIMULATORS = {"mcs51": ("s51", "__xdata __at", "xram"), "stm8": ("sstm8", "__at", "rom")}
COUNT = 24
#: The word of AMM5A21/65KSC1 and a buffer.
BITS, SIZE = 45, 12
PROGRAM = """
#include "lika/amm5_biss.h"
/* Functions of 64 bits that SDCC calls for _turns, _modulus and _degrees, and that its library lacks. */
float __ulonglong2fs(unsigned long long value)
{
    return (float)(unsigned long)value;
}
#ifdef __SDCC_mcs51
unsigned long long _modulonglong(unsigned long long a, unsigned long long b)
{
    return (unsigned long)a % (unsigned long)b;
}
long long _mullonglong(long long a, long long b)
{
    return (unsigned long)a * (unsigned long)b;
}
#endif
@at@(0x0300) uint8_t results[@count@ * 10];
@at@(0x02F0) volatile uint8_t done;
static const uint8_t buffers[@count@][@size@] = {
@buffers@
};
void main(void)
{
    uint8_t *at = results;
    uint8_t index;
    for (index = 0U; index < @count@U; index++) {
        uint64_t position = 0U;
        uint8_t byte;
        cw_word word;
        at[0] = (uint8_t)lika_amm5_biss_receive(&LIKA_AMM5_BISS_A21_65KSC1, buffers[index], @size@U, &word);
        at[1] = (uint8_t)LIKA_AMM5_BISS_READ_BYTES(A21_65KSC1, buffers[index], @size@U, &position);
        for (byte = 2U; byte < 10U; byte++) {
            at[byte] = (uint8_t)position;
            position >>= 8U;
        }
        at += 10;
    }
    done = 0x55U;
    for (;;) {
    }
}
"""


@pytest.fixture(scope="module")
def include(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the include folder of headers whose functions take structures by address, since SDCC has no other way."""
    folder = tmp_path_factory.mktemp("sdcc")
    for name, text in generate(Library(tuple(library().values())), {"passing": "address"}).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder / "c" / "include"


def compiled(processor: str, text: str, include: Path, tmp_path: Path, *more: str) -> None:
    (tmp_path / "unit.c").write_text(text, encoding="ascii")
    command = [tool("sdcc"), "--std-c99", *PROCESSORS[processor], NOT_INLINED, f"-I{include}", "unit.c", *more]
    completed = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert completed.returncode == 0, completed.stderr[-3000:]


@pytest.mark.parametrize(
    ("interface", "processor"), [("biss", "mcs51"), ("ssi", "mcs51"), ("rs485", "mcs51"), ("biss", "stm8")]
)
def test_headers_compile(interface: str, processor: str, include: Path, tmp_path: Path) -> None:
    headers = (f"lika/amm5_{interface}", "codewheel/receive", "codewheel/tracker")
    text = "".join(f'#include "{name}.h"\n' for name in headers) + "void main(void)\n{\n}\n"
    compiled(processor, text, include, tmp_path, "-c", "-o", "unit.rel")
    assert (tmp_path / "unit.rel").is_file()


def crc_of(data: int, bits: int) -> int:
    """Return the CRC x^6 + x + 1, sent inverted, bit by bit."""
    crc = 0
    for bit in range(bits - 1, -1, -1):
        crc ^= (data >> bit & 1) << 5
        crc = (crc << 1 ^ (0x03 if crc & 0x20 else 0)) & 0x3F
    return crc ^ 0x3F


def received(random_: random.Random) -> tuple[bytes, list[int]]:
    """Return a buffer with a frame after a random delay, and the expected output: results, verdict and position."""
    position, crc_error = random_.getrandbits(BITS - 8), random_.random() < 0.2
    data = position << 2 | 3
    word = data << 6 | crc_of(data, BITS - 6) ^ crc_error
    line = "1" * random_.randint(1, 10) + "0" * random_.randint(1, 20) + "1" + random_.choice("01")
    bits = f"{line}{word:0{BITS}b}0".ljust(8 * SIZE, random_.choice("01"))
    expected = [0, 0, *bytes(8)] if crc_error else [0, 3, *position.to_bytes(8, "little")]
    return int(bits, 2).to_bytes(SIZE, "big"), expected


@pytest.mark.parametrize("processor", SIMULATORS)
def test_results_in_the_simulator(processor: str, include: Path, tmp_path: Path) -> None:
    """SDCC 4.2 for STM8 has errors with ``~`` and ``<<= 8`` of 32 bits, which the headers must avoid."""
    simulator, at, memory = SIMULATORS[processor]
    random_ = random.Random("sdcc")
    pairs = [received(random_) for _ in range(COUNT)]
    values = {
        "at": at,
        "count": COUNT,
        "size": SIZE,
        "buffers": ",\n".join(f"{{ {', '.join(map(str, buffer))} }}" for buffer, _ in pairs),
    }
    text = re.sub(r"@(\w+)@", lambda match: str(values[match[1]]), PROGRAM)
    compiled(processor, text, include, tmp_path, "-o", "unit.ihx")
    last = 0x300 + 10 * COUNT - 1
    output = subprocess.run(
        [tool(simulator), *(["-t", "8052"] if processor == "mcs51" else []), "unit.ihx"],
        input=f"step 6000000\ndump {memory} 0x2f0 0x2f0\ndump {memory} 0x300 {last:#x}\nquit\n",
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    ).stdout
    rows = re.findall(r"^0x0*[23][0-9a-f]{2}\s+((?:[0-9a-f]{2} )+)", output, re.MULTILINE)
    dumped = [int(byte, 16) for row in rows for byte in row.split()]
    assert dumped[0] == 0x55, output[-2000:]
    assert len(dumped) == 1 + 10 * COUNT
    assert [dumped[start : start + 10] for start in range(1, len(dumped), 10)] == [expected for _, expected in pairs]
