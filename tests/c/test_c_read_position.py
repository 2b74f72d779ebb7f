"""The way from a buffer to a position in one call, for BiSS and SSI, and what it refuses.

Frames are made here bit by bit: position, error and warning (low when active), CRC-6 with x^6 + x + 1, sent inverted
(AM36 6.2, AMM5 6.2, ASC85 6.2, SMA21 6.1), on a line with rest, acknowledge, start, CDS and stop bit (PROT p. 3).
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest
from c_harness import GCC, SANITIZED, MadeOnce, Run, compile_c, runner

pytestmark = pytest.mark.slow

NOT_USABLE, UNKNOWN, WITH_WARNING, USABLE = range(4)
OK, LENGTH, _, _, RANGE = range(5)
LINE_HIGH, NO_START = 8, 10

HEAD = r"""
#include "lika/@stem@.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fill(uint8_t *bytes, size_t size, const char *digits)
{
    size_t index;
    for (index = 0U; index < size; index++) {
        const char two[3] = { digits[2U * index], digits[2U * index + 1U], '\0' };
        bytes[index] = (uint8_t)strtoul(two, NULL, 16);
    }
}

int main(void)
{
    static char text[512];
    while (fgets(text, sizeof text, stdin) != NULL) {
        uint8_t rx[@prefix@_@code@@answer@_RX_BYTES];
        uint8_t second[@prefix@_@code@@answer@_RX_BYTES];
        cw_word word = { 0U, 0U };
        @position@ position = 77U;
        @position@ from_bytes = 77U;
        const char *const first_digits = strtok(text, " \n");
        const char *const second_digits = strtok(NULL, " \n");
        const cw_verdict verdict = (fill(rx, sizeof rx, first_digits),
            @prefix@_READ(@code@@choice@, rx, &position));
        const cw_verdict again = @prefix@_READ_BYTES(@code@@choice@, rx, sizeof rx, &from_bytes);
        const cw_result received = @prefix@_RECEIVE(@code@@choice@, rx, &word);
        if (second_digits != NULL) {
            fill(second, sizeof second, second_digits);
        }
        (void)second;
        printf("%d %llu %d %d", (int)verdict, (unsigned long long)position,
            (int)(verdict == again && position == from_bytes), (int)received);
        @twice@
        printf("\n");
    }
    return 0;
}
"""
TWICE = """if (second_digits != NULL) {
            @position@ agreed = 77U;
            const cw_verdict both = @prefix@_READ_TWICE(@code@, rx, second, 3U, &agreed);
            printf(" %d %llu", (int)both, (unsigned long long)agreed);
        }"""


#: Interfaces with positions of more than 32 bits in some order codes.
LONG = ("amm5_ssi", "amm5_biss", "am36_biss")


@dataclass(frozen=True)
class Interface:
    """An order code of an interface: the bits of its position, and constant bits above and below it."""

    stem: str
    code: str
    position_bits: int
    zeros_above: int = 0
    zeros_below: int = 0
    choice: str = ""
    verdict_with_warning: int = NOT_USABLE
    has_error_bit: bool = True

    def program(self) -> str:
        prefix = f"LIKA_{self.stem.upper()}"
        text = HEAD.replace("@twice@", TWICE if self.stem.endswith("_ssi") else "")
        return (
            text.replace("@answer@", f"_{self.choice}" if self.choice else "")
            .replace("@choice@", f", {self.choice}" if self.choice else "")
            .replace("@stem@", self.stem)
            .replace("@prefix@", prefix)
            .replace("@code@", self.code)
            .replace("@position@", "uint64_t" if self.stem in LONG else "uint32_t")
        )


#: AMM5 6.2: positions of 37 and of 17 bits. AM36 has no use for its status bits. ASC85 has the open question of a zero
#: bit below the position. SMA21 at 50 um: 20 bits of position below 4 zeros.
BISS = (
    Interface("amm5_biss", "A21_65KSC1", 37),
    Interface("amm5_biss", "A17_1SC1", 17, verdict_with_warning=WITH_WARNING),
    Interface("asc85_biss", "25_SC1", 25, zeros_below=1, choice="AS_PRINTED", verdict_with_warning=WITH_WARNING),
    Interface("asc85_biss", "25_SC1", 25, choice="LEFT_OUT", verdict_with_warning=WITH_WARNING),
    Interface("sma21_biss", "SC1_0050", 20, zeros_above=4, verdict_with_warning=WITH_WARNING),
    Interface("am36_biss", "AM3616_4096_I7", 36, has_error_bit=False),
)
#: Binary words: AMM5 23 and 16 bits, AM36 19 and 12, ASC85 25, SMA21 25 bits and an error bit.
SSI = (
    Interface("amm5_ssi", "A23_65KBG1", 39, has_error_bit=False),
    Interface("am36_ssi", "AM3619_4096_BG", 31, has_error_bit=False),
    Interface("asc85_ssi", "25_BG1", 25, has_error_bit=False),
    Interface("sma21_ssi", "BG1_0001", 25),
)


def run_of(interface: Interface, include: Path, made_once: MadeOnce) -> Run:
    name = f"read_{interface.stem}_{interface.code}_{interface.choice}"

    def build(folder: Path) -> None:
        compile_c([*GCC, "-O1", *SANITIZED], interface.program(), folder, include)

    return runner(made_once(name, build) / "program")


def bits_of(number: int, width: int) -> list[int]:
    return [number >> place & 1 for place in range(width - 1, -1, -1)]


def crc6(bits: Sequence[int]) -> int:
    """Return the remainder of a division by x^6 + x + 1, from zero, inverted."""
    register = 0
    for bit in bits:
        feedback = (register >> 5) ^ bit
        register = (register << 1 & 0x3F) ^ (0x03 if feedback else 0)
    return register ^ 0x3F


def in_bytes(bits: Sequence[int], size: int) -> str:
    """Return a line as hexadecimal bytes, high after its last bit."""
    padded = [*bits, *[1] * (8 * size - len(bits))]
    return "".join(f"{int(''.join(map(str, padded[at : at + 8])), 2):02X}" for at in range(0, 8 * size, 8))


def rx_bytes(interface: Interface, include: Path) -> int:
    """Return the size of the buffer, as the header states it."""
    name = (
        f"LIKA_{interface.stem.upper()}_{interface.code}{'_' + interface.choice if interface.choice else ''}_RX_BYTES"
    )
    (line,) = (
        line
        for line in (include / "lika" / f"{interface.stem}.h").read_text(encoding="ascii").splitlines()
        if line.startswith(f"#define {name} ")
    )
    return int(line.split()[2].rstrip("U"))


def biss_line(interface: Interface, position: int, error: int = 1, warning: int = 1, wrong: int = 0) -> list[int]:
    """Return the line with a frame. ``wrong`` changes bits of the CRC."""
    data = [*[0] * interface.zeros_above, *bits_of(position, interface.position_bits)]
    data += [*[0] * interface.zeros_below, error, warning]
    return [1, 1, 0, 0, 1, 0, *data, *bits_of(crc6(data) ^ wrong, 6), 0]


@pytest.mark.parametrize("interface", BISS, ids=lambda interface: f"{interface.code}-{interface.choice}")
def test_a_biss_buffer_gives_a_position_and_its_verdict(
    interface: Interface, include: Path, made_once: MadeOnce
) -> None:
    run, size = run_of(interface, include, made_once), rx_bytes(interface, include)
    chance = random.Random(interface.code)
    lines, expected = [], []

    def add(line: Sequence[int], verdict: int, position: int, received: int = OK) -> None:
        lines.append(in_bytes(line, size))
        expected.append(f"{verdict} {77 if verdict == NOT_USABLE else position} 1 {received}")

    for _ in range(200):
        position = chance.getrandbits(interface.position_bits)
        add(biss_line(interface, position), USABLE if interface.has_error_bit else UNKNOWN, position)
        add(biss_line(interface, position, wrong=chance.randint(1, 63)), NOT_USABLE, position)
        if interface.has_error_bit:
            add(biss_line(interface, position, error=0), NOT_USABLE, position)
            add(biss_line(interface, position, warning=0), interface.verdict_with_warning, position)
    add([1], NOT_USABLE, 0, LINE_HIGH)
    assert run(lines) == expected


@pytest.mark.one_in(2, "exhaustive")
@pytest.mark.parametrize("interface", SSI, ids=lambda interface: interface.code)
def test_ssi_buffers_give_a_position_and_two_of_them_must_agree(
    interface: Interface, include: Path, made_once: MadeOnce
) -> None:
    run, size = run_of(interface, include, made_once), rx_bytes(interface, include)
    chance = random.Random(interface.code)
    highest = (1 << interface.position_bits) - 4
    verdict = USABLE if interface.has_error_bit else UNKNOWN

    def line(position: int, no_error: int = 1) -> str:
        status = [no_error] if interface.has_error_bit else []
        return in_bytes([1, *bits_of(position, interface.position_bits), *status, *[0] * 8][: 8 * size], size)

    for _ in range(200):
        position = chance.randrange(highest)
        assert run([
            f"{line(position)} {line(position + 3)}",
            f"{line(position)} {line((position + 4) % highest)}",
        ]) == [
            f"{verdict} {position} 1 {OK} {verdict} {position + 3}",
            f"{verdict} {position} 1 {OK} {NOT_USABLE} 77",
        ]  # fmt: skip
    assert run([f"{'FF' * size} {'FF' * size}"]) == [f"{NOT_USABLE} 77 1 {LINE_HIGH} {NOT_USABLE} 77"]
    assert run([f"{line(5)} {'FF' * size}"]) == [f"{verdict} 5 1 {OK} {NOT_USABLE} 77"]
    if interface.has_error_bit:
        assert run([f"{line(5, 0)} {line(5)}", f"{line(5)} {line(5, 0)}"]) == [
            f"{NOT_USABLE} 77 1 {OK} {NOT_USABLE} 77",
            f"{verdict} 5 1 {OK} {NOT_USABLE} 77",
        ]


#: Calls with an invalid answer to an open question, and with a word of another length.
REFUSED = """#include "ichaus/icmu_biss.h"
#include "lika/amm5_rs485.h"
#include "lika/amm5_rs485_simulate.h"
#include "lika/asc85_biss.h"
#include "lika/asc85_biss_simulate.h"
#include <stdio.h>
#include <string.h>

int main(void)
{
    uint8_t bytes[4] = { 0U, 0U, 0U, 0U };
    uint64_t bits = 0U;
    lika_asc85_biss_frame asc85;
    ichaus_icmu_biss_frame icmu;
    /* A line without a start bit, and a frame of zeros after rest, acknowledge, start bit and CDS. */
    const uint8_t low[16] = { 0xC0U };
    const uint8_t zeros[16] = { 0xC8U };
    cw_word word = { 0U, 0U };
    const lika_asc85_biss_zero_bit no_answer = (lika_asc85_biss_zero_bit)7;
    memset(&asc85, 0, sizeof asc85);
@calls@
    printf("%d\\n", (int)lika_asc85_biss_decode(LIKA_ASC85_BISS_25_SC1, no_answer, cw_word_of(0U, 34U), &asc85));
    printf("%d\\n", (int)lika_asc85_biss_encode(LIKA_ASC85_BISS_25_SC1, no_answer, &asc85, &bits));
    printf("%d\\n", (int)ichaus_icmu_biss_decode(ICHAUS_ICMU_BISS_IC_MU_16_0, cw_word_of(0U, 3U), &icmu));
    printf("%d\\n", (int)ichaus_icmu_biss_receive(ICHAUS_ICMU_BISS_IC_MU_16_0, low, sizeof low, &word));
    printf("%d\\n", (int)ichaus_icmu_biss_receive(ICHAUS_ICMU_BISS_IC_MU_16_0, zeros, sizeof zeros, &word));
    printf("%d\\n", (int)ICHAUS_ICMU_BISS_READ_BYTES(IC_MU_16_0, low, sizeof low, &bits));
    printf("%d\\n", (int)ICHAUS_ICMU_BISS_READ_BYTES(IC_MU_16_0, zeros, sizeof zeros, &bits));
    printf("%d\\n", (int)cw_with_field(5U, 64U, 3U, 7U));
    /* Arguments that no spec leads to: a field that is too long, no digits, and too many of them. */
    printf("%d\\n", (int)cw_from_digits(5U, 0U, 65U, 4U, 10U, 0U));
    printf("%d\\n", (int)cw_to_digits(5U, 0U, 8U, 0U, 10U, 0U));
    printf("%d\\n", (int)cw_to_digits(5U, 0U, 8U, 4U, 0U, 0U));
    printf("%d\\n", (int)cw_digit(5U, 4U, 17U, 0U));
    return 0;
}
"""
#: What is encoded and what is decoded with the place of an address in the EEPROM, which the manual leaves open.
ENCODED = ("eeprom_write_request", "eeprom_read_request", "eeprom_write_reply", "eeprom_read_reply")
ANSWER = "LIKA_AMM5_RS485_A23_65KJP1, (lika_amm5_rs485_adf_layout)7"


def test_no_answer_to_an_open_question_and_no_other_length_is_taken(include: Path, tmp_path: Path) -> None:
    calls = "".join(
        f"    {{ lika_amm5_rs485_{name} value; memset(&value, 0, sizeof value);\n"
        f'    printf("%d\\n", (int)lika_amm5_rs485_{name}_encode({ANSWER}, &value, bytes, sizeof bytes));\n'
        f'    printf("%d\\n", (int)lika_amm5_rs485_{name}_decode({ANSWER}, bytes, sizeof bytes, &value)); }}\n'
        for name in ENCODED
    )
    program = compile_c([*GCC, "-O1", *SANITIZED], REFUSED.replace("@calls@", calls), tmp_path, include)
    assert runner(program)([]) == [str(RANGE)] * (2 * len(ENCODED) + 2) + [
        *(str(LENGTH), str(NO_START), str(OK)),
        *(str(NOT_USABLE), str(NOT_USABLE), "5", "5", "5", "5", "17"),
    ]
