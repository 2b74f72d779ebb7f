"""Mistakes with order codes that every compiler rejects, in C and in C++, without any option."""

from __future__ import annotations

import random
import re
import subprocess
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.c.files import generate
from exhaustive import mostly_exhaustive
from working_tools import require

pytestmark = pytest.mark.slow

COMPILERS = (
    "gcc -std=c99",
    "clang -std=c99",
    "g++ -x c++ -std=c++11",
    "clang++ -x c++ -std=c++11",
    "arm-none-eabi-gcc -std=c99",
    "avr-gcc -std=c99",
)
RIGHT = "LIKA_AMM5_BISS_RECEIVE(A17_1SC1, rx, &word) == CW_OK && lika_amm5_biss_decode(amm5, word, &frame) == CW_OK"
#: An expression for each mistake.
MISTAKES = {
    "order code of another interface": "lika_amm5_biss_decode(LIKA_AMM5_RS485_A21_65KJP1, word, &frame) == CW_OK",
    "order code of another encoder": "lika_asc85_biss_decode(amm5, my_zero_bit, word, &other) == CW_OK",
    "number without its length": "lika_amm5_biss_decode(amm5, 7U, &frame) == CW_OK",
    "order code of another interface, read": "LIKA_AMM5_BISS_READ(A21_65KJP1, rx, &position) != CW_NOT_USABLE",
    "choice that is no answer, read": "LIKA_ASC85_BISS_READ(24_SC1, 7, rx, &position) != CW_NOT_USABLE",
    "pointer instead of a buffer, read": "LIKA_AMM5_BISS_READ(A17_1SC1, pointer, &position) != CW_NOT_USABLE",
    "buffer of another order code, read": "LIKA_AMM5_BISS_READ(A23_65KSC1, rx, &position) != CW_NOT_USABLE",
    "buffer of one order code with the bits of another": "LIKA_AMM5_BISS_RECEIVE(A23_65KSC1, rx, &word) == CW_OK",
    # On a 32-bit processor the pointer has the size of this buffer.
    "pointer instead of a buffer": "LIKA_SMA21_SSI_RECEIVE(BG1_0010, pointer, &word) == CW_OK",
    "buffer of other elements": "LIKA_SMA21_SSI_RECEIVE(BG1_0010, halves, &word) == CW_OK",
    "initial value of another encoder": "copied(number) != 0",
}
PROGRAM = """#include "lika/amm5_biss.h"
#include "lika/amm5_rs485.h"
#include "lika/asc85_biss.h"
#include "lika/sma21_ssi.h"
int read_encoder(uint64_t number);
static int copied(uint64_t word)
{
    @type@ copy = LIKA_AMM5_BISS_A17_1SC1;
    (void)copy;
    return (int)word;
}
int read_encoder(uint64_t number)
{
    static uint8_t rx[LIKA_AMM5_BISS_A17_1SC1_RX_BYTES];
    const lika_amm5_biss amm5 = LIKA_AMM5_BISS_A17_1SC1;
    const lika_asc85_biss_zero_bit my_zero_bit = LIKA_ASC85_BISS_ZERO_BIT_AS_PRINTED;
    uint64_t position = 0U;
    cw_word word = { number, 25U };
    lika_amm5_biss_frame frame;
    lika_asc85_biss_frame other;
    static int16_t halves[2];
    uint8_t *pointer = rx;
    (void)rx;
    (void)word;
    (void)halves;
    (void)pointer;
    (void)amm5;
    (void)my_zero_bit;
    (void)frame;
    (void)other;
    (void)copied;
    @statement@
    return (int)position;
}
"""


def compiled(
    command: str, include: Path, tmp_path: Path, statement: str, kind: str = "lika_amm5_biss"
) -> tuple[int, str]:
    """Compile without any warning option, and return the exit code and the output of the compiler."""
    require(command.split())
    source = tmp_path / "program.c"
    source.write_text(PROGRAM.replace("@statement@", statement).replace("@type@", kind), encoding="utf-8")
    completed = subprocess.run(
        [*command.split(), f"-I{include}", "-c", str(source), "-o", str(tmp_path / "program.o")],
        capture_output=True,
        text=True,
    )
    return completed.returncode, completed.stderr


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, *COMPILERS[:3]))
def test_what_is_right_compiles_silently(command: str, include: Path, tmp_path: Path) -> None:
    assert compiled(command, include, tmp_path, f"if ({RIGHT}) {{ position = frame.position; }}") == (0, "")


@pytest.mark.parametrize("mistake", MISTAKES)
@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, *COMPILERS[:3]))
def test_a_mistake_does_not_compile(command: str, mistake: str, include: Path, tmp_path: Path) -> None:
    kind = "lika_asc85_biss" if mistake.startswith("initial") else "lika_amm5_biss"
    status, output = compiled(command, include, tmp_path, f"if ({MISTAKES[mistake]}) {{ position = number; }}", kind)
    assert status != 0
    assert "error:" in output


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, *COMPILERS[:3]))
def test_a_verdict_that_is_not_looked_at_is_a_warning(command: str, include: Path, tmp_path: Path) -> None:
    """The short way returns the verdict and stores the position. The long way has its own function for the verdict."""
    for statement in (
        "lika_amm5_biss_position(amm5, word, &position);",
        "(void)lika_amm5_biss_decode(amm5, word, &frame);",
        f"if ({RIGHT}) {{ lika_amm5_biss_verdict(amm5, &frame); }}",
    ):
        status, output = compiled(command, include, tmp_path, statement)
        assert status == 0
        # With clang a cast to void is enough, as in C++.
        assert "warning:" in output or ("clang" in command and statement.startswith("(void)"))


@pytest.mark.parametrize("command", [compiler for compiler in COMPILERS if "++" not in compiler])
def test_headers_do_not_turn_warnings_of_a_program_into_errors(command: str, include: Path, tmp_path: Path) -> None:
    require(command.split())
    headers = sorted(path.relative_to(include).as_posix() for path in include.rglob("*.h"))
    text = "".join(f'#include "{header}"\n' for header in headers)
    text += "void fill(unsigned char *value);\nvoid use(void);\nvoid use(void) { int v = 0; long *p = &v; (void)p; }\n"
    (tmp_path / "program.c").write_text(text, encoding="ascii")
    program = [*command.split(), f"-I{include}", "-c", str(tmp_path / "program.c"), "-o", str(tmp_path / "program.o")]
    completed = subprocess.run(program, capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr
    assert "warning:" in completed.stderr


#: Frames with random positions of one order code, received and decoded with the codes of the arguments.
MIXED = """#include <stdio.h>
@headers@
static uint32_t state = 2463534242U;
static uint32_t random_number(void)
{
    state ^= state << 13U;
    state ^= state >> 17U;
    state ^= state << 5U;
    return state;
}
int main(void)
{
    unsigned long refused = 0U;
    unsigned long number;
    unsigned long more = 0U;
@pairs@    printf("%lu %lu\\n", refused, more);
    return 0;
}
"""
MIXED_PAIR = """    for (number = 0U; number < @frames@U; number++) {
        const uint64_t bits = ((uint64_t)random_number() << 32U) | random_number();
        const cw_word word = cw_word_of(bits & cw_mask(@from@_BITS), @from@_BITS);
        @type@_frame frame;
        const cw_result result = @type@_decode(@to@, word, &frame);
        refused += (result == CW_FAULT_LENGTH) ? 1U : 0U;
        more++;
    }
"""


def test_a_word_of_another_length_is_refused(include: Path, tmp_path: Path) -> None:
    """100 random pairs of order codes whose lengths differ, with 1,000 random words each: none is decoded."""
    random_ = random.Random("mix")
    kinds = ("amm5_biss", "amm5_ssi", "am36_biss", "asc85_ssi", "sma21_ssi")
    pairs = []
    for kind in kinds:
        text = (include / "lika" / f"{kind}.h").read_text(encoding="ascii")
        lengths = dict(re.findall(rf"#define (LIKA_{kind.upper()}_\w+)_BITS (\d+)U /\*\*< number of bits in its", text))
        differing = [(one, other) for one in lengths for other in lengths if lengths[one] != lengths[other]]
        pairs += [(f"lika_{kind}", *random_.choice(differing)) for _ in range(25) if differing]
    pairs = pairs[:100]
    assert len(pairs) >= 75
    loops = ""
    for kind, one, other in pairs:
        loops += (
            MIXED_PAIR.replace("@frames@", "1000").replace("@from@", one).replace("@to@", other).replace("@type@", kind)
        )
    headers = "".join(f'#include "lika/{kind}.h"\n' for kind in kinds)
    (tmp_path / "mixed.c").write_text(MIXED.replace("@headers@", headers).replace("@pairs@", loops), encoding="ascii")
    require(["gcc"])
    subprocess.run(["gcc", "-std=c99", f"-I{include}", "mixed.c", "-o", "mixed"], cwd=tmp_path, check=True)
    output = subprocess.run([str(tmp_path / "mixed")], capture_output=True, text=True, check=True).stdout
    assert output == f"{1000 * len(pairs)} {1000 * len(pairs)}\n"


def test_a_choice_that_is_no_answer_is_out_of_range(include: Path, tmp_path: Path) -> None:
    text = """#include <stdio.h>
#include "lika/asc85_biss.h"
int main(void)
{
    lika_asc85_biss_frame frame;
    const cw_word word = cw_word_of(0U, 32U);
    printf("%d", (int)lika_asc85_biss_decode(LIKA_ASC85_BISS_24_SC1, (lika_asc85_biss_zero_bit)7, word, &frame));
    return 0;
}
"""
    require(["gcc"])
    (tmp_path / "choice.c").write_text(text, encoding="ascii")
    subprocess.run(["gcc", "-std=c99", f"-I{include}", "choice.c", "-o", "choice"], cwd=tmp_path, check=True)
    assert subprocess.run([str(tmp_path / "choice")], capture_output=True, text=True, check=True).stdout == "4"


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, *COMPILERS[:3]))
def test_a_buffer_of_another_size_than_an_spi_word_does_not_compile(command: str, tmp_path: Path) -> None:
    require(command.split())
    (as5047p,) = (device for device in load_library()[0] if device.name == "as5047p")
    for path, text in generate(Library((as5047p,))).items():
        if path.startswith("c/include/"):
            target = tmp_path / path.removeprefix("c/include/")
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="ascii")
    statuses = []
    for size in (2, 3):
        program = f"""#include "ams/as5047p_spi.h"
int read_encoder(uint16_t *position);
int read_encoder(uint16_t *position)
{{
    static uint8_t rx[{size}];
    return AMS_AS5047P_SPI_READ(AS5047P, rx, position) != CW_NOT_USABLE;
}}
"""
        (tmp_path / "program.c").write_text(program, encoding="ascii")
        arguments = [*command.split(), f"-I{tmp_path}", "-fsyntax-only", str(tmp_path / "program.c")]
        statuses.append(subprocess.run(arguments, capture_output=True, text=True).returncode)
    assert statuses[0] == 0
    assert statuses[1] != 0
