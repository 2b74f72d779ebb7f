"""Mistakes with order codes that every compiler rejects, in C and in C++, without any option."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
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
    "buffer of one order code with the bits of another": "LIKA_AMM5_BISS_RECEIVE(A23_65KSC1, rx, &word) == CW_OK",
    # On a 32-bit processor the pointer has the size of this buffer.
    "pointer instead of a buffer": "LIKA_SMA21_SSI_RECEIVE(BG1_0010, pointer, &word) == CW_OK",
    "buffer of other elements": "LIKA_SMA21_SSI_RECEIVE(BG1_0010, halves, &word) == CW_OK",
    "initial value of another encoder": "copied(word) != 0",
}
PROGRAM = """#include "lika/amm5_biss.h"
#include "lika/amm5_rs485.h"
#include "lika/asc85_biss.h"
#include "lika/sma21_ssi.h"
int read_encoder(uint64_t word);
static int copied(uint64_t word)
{
    @type@ copy = LIKA_AMM5_BISS_A17_1SC1;
    (void)copy;
    return (int)word;
}
int read_encoder(uint64_t word)
{
    static uint8_t rx[LIKA_AMM5_BISS_A17_1SC1_RX_BYTES];
    const lika_amm5_biss amm5 = LIKA_AMM5_BISS_A17_1SC1;
    const lika_asc85_biss_zero_bit my_zero_bit = LIKA_ASC85_BISS_ZERO_BIT_AS_PRINTED;
    uint64_t position = 0U;
    lika_amm5_biss_frame frame;
    lika_asc85_biss_frame other;
    static int16_t halves[2];
    uint8_t *pointer = rx;
    (void)rx;
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
    status, output = compiled(command, include, tmp_path, f"if ({MISTAKES[mistake]}) {{ position = word; }}", kind)
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
def test_a_program_with_such_pointers_of_its_own_can_still_be_compiled(
    command: str, include: Path, tmp_path: Path
) -> None:
    statement = f"if ({MISTAKES['order code of another encoder']}) {{ position = word; }}"
    status, output = compiled(f"{command} -DCW_POINTERS_UNCHECKED", include, tmp_path, statement)
    assert status == 0
    assert "warning:" in output
